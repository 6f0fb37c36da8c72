"""The vectorised environment: N different worlds, one compiled call a step."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space
from numpy.typing import NDArray

from arena_gym.batch import Step
from arena_gym.building import Parts, build_parts, compose_environment
from arena_gym.environment import SEEDS
from arena_gym.rendering import MODES, Frame, Renderer
from arena_gym.reports import final_report, start_report
from arena_gym.spaces import action_space, observation_space
from arena_gym.switched_batch import make_batch

Observations = NDArray[np.float32]
Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]


class NavigationVectorEnv(VectorEnv[Observations, Observations, NDArray[Any]]):
    """N single environments in one; world k with seed s is the single one with seed s + k, bit for bit.

    An episode that ends is followed by the next one in the same step; ``infos["final_obs"]`` and
    ``infos["final_info"]`` tell of its end, and ``infos`` of the beginning of the next.
    """

    metadata = {  # noqa: RUF012 - gymnasium's own form
        "render_modes": list(MODES),
        "render_fps": 10,
        "autoreset_mode": AutoresetMode.SAME_STEP,
    }

    def __init__(
        self,
        num_envs: int = 1,
        robot: str | None = None,
        world: str | None = None,
        task: str | None = None,
        reward: str | None = None,
        observation: str | None = None,
        overrides: Sequence[str] = (),
        parts: Parts | None = None,
        render_mode: str | None = None,
    ) -> None:
        super().__init__()
        if parts is None:
            config = compose_environment(
                overrides, robot=robot, world=world, task=task, reward=reward, observation_encoder=observation
            )
            parts = build_parts(config)
        self.batch = make_batch(parts, num_envs)
        self.num_envs = num_envs
        self.render_mode = render_mode
        self._renderer = Renderer(self.batch, render_mode) if render_mode is not None else None
        self.single_observation_space = observation_space(self.batch.parts.encoder)
        self.single_action_space = action_space(self.batch.parts)
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)

    def reset(
        self, *, seed: int | list[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observations, dict[str, Any]]:
        """Begin the first episodes of the seeds ``seed``, ``seed + 1``, ... or of those listed."""
        super().reset(seed=seed if isinstance(seed, int) else None)
        observations = self.batch.reset(self._episode_seeds(seed))
        self._show_frame()
        return observations, self._start_infos(range(self.num_envs))

    def set_stage(self, stage: int) -> None:
        """Let episodes that begin from now on be of this level of the task; raise
        ConfigurationError where there is none.
        """
        self.batch.set_stage(stage)

    def step(self, actions: NDArray[Any]) -> tuple[Observations, Floats, Flags, Flags, dict[str, Any]]:
        """Drive all robots for one control period, or for one decision of a switch; worlds whose
        episodes end begin the next ones.
        """
        step = self.batch.step(actions)
        slots = np.flatnonzero(step.terminated | step.truncated)
        infos = self._begin_next(step, slots) if len(slots) else {}
        self._show_frame()
        return step.observations, step.rewards, step.terminated, step.truncated, infos

    def render(self) -> tuple[Frame, ...] | None:
        """Return a picture of each world, (H, W, 3) bytes, in mode ``rgb_array``; in mode ``human`` every
        step shows the first world.
        """
        if self._renderer is None or self.render_mode != "rgb_array":
            return None
        return tuple(self._renderer.frame(slot) for slot in range(self.num_envs))

    def close_extras(self, **kwargs: Any) -> None:
        """Close the window, if there is one."""
        if self._renderer is not None:
            self._renderer.close()

    def _show_frame(self) -> None:
        if self._renderer is not None:
            self._renderer.show()

    def _begin_next(self, step: Step, slots: NDArray[np.int64]) -> dict[str, Any]:
        """Begin the next episodes of these slots, in place in ``step.observations``; return the infos of both."""
        ends: dict[str, Any] = {}
        for slot in slots.tolist():
            end = {"final_obs": step.observations[slot].copy(), "final_info": final_report(self.batch, step, slot)}
            ends = self._add_info(ends, end, slot)
        step.observations[slots] = self.batch.restart(slots)
        return ends | self._start_infos(slots.tolist())

    def _start_infos(self, slots: Sequence[int]) -> dict[str, Any]:
        infos: dict[str, Any] = {}
        for slot in slots:
            infos = self._add_info(infos, start_report(self.batch, slot), slot)
        return infos

    def _episode_seeds(self, seed: int | list[int | None] | None) -> list[int]:
        if isinstance(seed, int):
            return [seed + k for k in range(self.num_envs)]
        given = [None] * self.num_envs if seed is None else seed
        return [int(self.np_random.integers(SEEDS)) if one is None else one for one in given]
