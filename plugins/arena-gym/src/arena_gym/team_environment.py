"""A team of robots as a parallel environment of PettingZoo."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from gymnasium.spaces import Box, Discrete
from gymnasium.utils.seeding import np_random
from numpy.typing import NDArray
from pettingzoo import ParallelEnv

from arena_core import ConfigurationError
from arena_gym.building import build_parts, compose_environment
from arena_gym.environment import SEEDS, Observation
from arena_gym.reports import final_report, start_report
from arena_gym.spaces import action_space, observation_space
from arena_gym.switched_batch import make_batch

Action = NDArray[np.float32]
Infos = dict[str, dict[str, Any]]
CHOICES = {"observation": "observation_encoder"}  # what choices are called, where a component is called otherwise
DEFAULTS = {"task": "antipodal", "world": "empty"}


class TeamEnv(ParallelEnv[str, Observation, Action]):  # type: ignore[misc]  # PettingZoo has no types
    """Drive the robots of one world, each to its own goal; what one sees, does and is paid is as in the single
    environment, and the others are bodies to it.

    ``robots`` is their number (None: as the task says), ``choices`` are the components, as of the single environment
    (robot, world, task, reward, observation). A robot whose episode has ended leaves ``agents``, and stands in the
    world as long as others drive.
    """

    metadata: dict[str, Any] = {"name": "arena_team_v0", "render_modes": []}  # noqa: RUF012 - PettingZoo's own form
    render_mode: str | None = None

    def __init__(self, robots: int | None, overrides: Sequence[str], choices: Mapping[str, str]) -> None:
        chosen = {CHOICES.get(kind, kind): name for kind, name in (DEFAULTS | dict(choices)).items()}
        size = [] if robots is None else [f"task.team={robots}"]
        parts = build_parts(compose_environment([*size, *overrides], **chosen))
        if parts.config["privileged"]:
            raise ConfigurationError("privileged is true; allowed: false in teams, whose parts see no truth")
        count = parts.pool.robots
        self.batch = make_batch(parts, 1, team=count)
        self.possible_agents = [f"robot{k}" for k in range(count)]
        self.agents: list[str] = []
        self.observation_spaces: dict[str, Any] = {
            agent: observation_space(parts.encoder) for agent in self.possible_agents
        }
        self.action_spaces: dict[str, Any] = {agent: action_space(parts) for agent in self.possible_agents}
        self._random = np_random()[0]
        self._begun = False

    def observation_space(self, agent: str) -> Box:
        """Return what a robot may see, always the same object."""
        space: Box = self.observation_spaces[agent]
        return space

    def action_space(self, agent: str) -> Box | Discrete:
        """Return what a robot may do, always the same object."""
        space: Box | Discrete = self.action_spaces[agent]
        return space

    def reset(
        self, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, Observation], Infos]:
        """Begin the first episode of ``seed``; without one, the next episode of the seed before."""
        if seed is not None or not self._begun:
            observations = self.batch.reset([int(self._random.integers(SEEDS)) if seed is None else seed])
        else:
            observations = self.batch.restart(np.zeros(1, np.int64))
        self._begun = True
        self.agents = list(self.possible_agents)
        return dict(zip(self.agents, observations, strict=True)), {
            agent: start_report(self.batch, row) for row, agent in enumerate(self.agents)
        }

    def step(
        self, actions: Mapping[str, Action]
    ) -> tuple[dict[str, Observation], dict[str, float], dict[str, bool], dict[str, bool], Infos]:
        """Drive for one control period, all ``agents`` by their ``actions``; raise ConfigurationError where one has
        none.
        """
        if missing := [agent for agent in self.agents if agent not in actions]:
            raise ConfigurationError(f"{missing[0]} has no action; allowed: one for each of {', '.join(self.agents)}")
        if not self.agents:
            return {}, {}, {}, {}, {}
        rows = {agent: row for row, agent in enumerate(self.possible_agents) if agent in self.agents}
        step = self.batch.step_some(self._joined(actions, rows), self._driving(rows))
        ended = step.terminated | step.truncated
        self.agents = [agent for agent, row in rows.items() if not ended[row]]
        return (
            {agent: step.observations[row] for agent, row in rows.items()},
            {agent: float(step.rewards[row]) for agent, row in rows.items()},
            {agent: bool(step.terminated[row]) for agent, row in rows.items()},
            {agent: bool(step.truncated[row]) for agent, row in rows.items()},
            {agent: final_report(self.batch, step, row) if ended[row] else {} for agent, row in rows.items()},
        )

    def _joined(self, actions: Mapping[str, Action], rows: Mapping[str, int]) -> NDArray[Any]:
        """Return the actions of all robots as the batch wants them, anything for those who stand."""
        space = self.action_spaces[self.possible_agents[0]]
        joined = np.zeros((len(self.possible_agents), *space.shape), space.dtype)
        for agent, row in rows.items():
            joined[row] = actions[agent]
        return joined

    def _driving(self, rows: Mapping[str, int]) -> NDArray[np.bool_]:
        driving = np.zeros(len(self.possible_agents), np.bool_)
        driving[list(rows.values())] = True
        return driving
