"""Teams as Stable-Baselines3 wants them: all robots are driven by one policy."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from stable_baselines3.common.vec_env import VecEnv

from arena_gym.team_environment import TeamEnv
from arena_gym.training.sb3_vec_env import SEEDS_APART


class TeamVecEnv(VecEnv):
    """The robots of some teams, all of one configuration, one after another; team k begins with the episodes of a seed
    of its own.

    A team begins its next episode once all of its robots have ended theirs. One that waits for the others sees zeros,
    is paid nothing, and ends with them. The info of an ended episode has ``terminal_observation``,
    ``TimeLimit.truncated``, ``episode`` (return ``r``, length ``l``) and what the environment says of it.
    """

    def __init__(self, teams: Sequence[TeamEnv], seed: int) -> None:
        self.teams = list(teams)  # ahead of the base class, which asks for their render mode
        self._places = [(team, agent) for team in self.teams for agent in team.possible_agents]
        first = self.teams[0].possible_agents[0]
        spaces = self.teams[0].observation_space(first), self.teams[0].action_space(first)
        super().__init__(len(self._places), *spaces)
        self._first_seeds: list[int | None] = [seed * SEEDS_APART + k for k in range(len(self.teams))]
        self._actions: NDArray[Any] = np.zeros((self.num_envs, 1))
        self._returns, self._lengths = np.zeros(self.num_envs), np.zeros(self.num_envs, np.int64)

    def reset(self) -> NDArray[np.float32]:
        """Begin the first episodes of all teams, the next ones when asked again."""
        self._returns[:], self._lengths[:] = 0.0, 0
        begun = [team.reset(seed=seed)[0] for team, seed in zip(self.teams, self._first_seeds, strict=True)]
        self._first_seeds = [None] * len(self.teams)
        return np.array([seen for team in begun for seen in team.values()], np.float32)

    def step_async(self, actions: NDArray[Any]) -> None:
        """Take the actions of the next step."""
        self._actions = actions

    def step_wait(self) -> tuple[Any, ...]:
        """Step all teams; those whose last robots end begin their next episodes."""
        observations = np.zeros((self.num_envs, *self._shape), np.float32)
        rewards, dones = np.zeros(self.num_envs, np.float32), np.zeros(self.num_envs, np.bool_)
        infos: list[dict[str, Any]] = [{} for _ in range(self.num_envs)]
        first = 0
        for team in self.teams:
            rows = {agent: first + place for place, agent in enumerate(team.possible_agents)}
            self._step_team(team, rows, observations, (rewards, dones, infos))
            first += len(rows)
        return observations, rewards, dones, infos

    @property
    def _shape(self) -> tuple[int, ...]:
        shape = self.observation_space.shape
        assert shape is not None
        return shape

    def _step_team(
        self,
        team: TeamEnv,
        rows: dict[str, int],
        observations: NDArray[np.float32],
        out: tuple[NDArray[np.float32], NDArray[np.bool_], list[dict[str, Any]]],
    ) -> None:
        """Step one team, whose agents have these ``rows`` of what is written to."""
        rewards, dones, infos = out
        actions = {agent: self._actions[rows[agent]] for agent in team.agents}
        seen, paid, terminated, truncated, said = team.step(actions)
        for agent, observation in seen.items():
            row = rows[agent]
            observations[row], rewards[row] = observation, paid[agent]
            self._returns[row] += paid[agent]
            self._lengths[row] += 1
            dones[row] = terminated[agent] or truncated[agent]
            if dones[row]:
                infos[row] = {**said[agent], **self._final_info(row, observation)}
                infos[row]["TimeLimit.truncated"] = truncated[agent] and not terminated[agent]
                observations[row] = 0.0
        if not team.agents:
            self._begin_next(team, rows, observations, (dones, infos))

    def _begin_next(
        self,
        team: TeamEnv,
        rows: dict[str, int],
        observations: NDArray[np.float32],
        out: tuple[NDArray[np.bool_], list[dict[str, Any]]],
    ) -> None:
        """Begin the next episode of a team, which ends those of the robots that have waited."""
        dones, infos = out
        for agent, observation in team.reset()[0].items():
            row = rows[agent]
            if not dones[row]:
                infos[row] = {"terminal_observation": observations[row].copy()}
            observations[row], dones[row] = observation, True
            self._returns[row], self._lengths[row] = 0.0, 0

    def _final_info(self, row: int, last: NDArray[np.float32]) -> dict[str, Any]:
        episode = {"r": float(self._returns[row]), "l": int(self._lengths[row])}
        return {"terminal_observation": last, "episode": episode}

    def close(self) -> None:
        """Close all teams."""
        for team in self.teams:
            team.close()

    def get_attr(self, attr_name: str, indices: Any = None) -> list[Any]:
        """Return an attribute of the team of each robot."""
        return [getattr(self._places[row][0], attr_name, None) for row in self._rows_of(indices)]

    def set_attr(self, attr_name: str, value: Any, indices: Any = None) -> None:
        """Refuse: robots have no attributes of their own."""
        raise NotImplementedError("the robots of a team have no attributes of their own")

    def env_method(self, method_name: str, *method_args: Any, indices: Any = None, **method_kwargs: Any) -> list[Any]:
        """Refuse: robots have no methods of their own."""
        raise NotImplementedError("the robots of a team have no methods of their own")

    def env_is_wrapped(self, wrapper_class: type, indices: Any = None) -> list[bool]:
        """Say that no robot is wrapped."""
        return [False] * len(self._rows_of(indices))

    def _rows_of(self, indices: Iterable[int] | int | None) -> Sequence[int]:
        if indices is None:
            return range(self.num_envs)
        return [indices] if isinstance(indices, int) else list(indices)
