"""The single environment."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import gymnasium
import numpy as np
from numpy.typing import NDArray

from arena_gym.building import build_parts, compose_environment
from arena_gym.rendering import Metadata, Renderer
from arena_gym.reports import final_report, start_report
from arena_gym.spaces import action_space, observation_space
from arena_gym.switched_batch import make_batch

Observation = NDArray[np.float32]
SEEDS = 2**31


class NavigationEnv(gymnasium.Env[Observation, NDArray[np.float32]]):
    """Drive a robot to its goal among people: ``gymnasium.make("arena/Navigation-v0", robot="jackal", ...)``.

    Names choose components, null leaves the configuration's own; ``overrides`` are those of ``arena run``.
    ``render_mode`` is ``rgb_array``, ``human`` or none (arena-gym[render]).
    """

    metadata = Metadata()

    def __init__(
        self,
        robot: str | None = None,
        world: str | None = None,
        task: str | None = None,
        reward: str | None = None,
        observation: str | None = None,
        overrides: Sequence[str] = (),
        render_mode: str | None = None,
    ) -> None:
        config = compose_environment(
            overrides, robot=robot, world=world, task=task, reward=reward, observation_encoder=observation
        )
        self.batch = make_batch(build_parts(config), 1)
        self.observation_space: Any = observation_space(self.batch.parts.encoder)
        self.action_space: Any = action_space(self.batch.parts)
        self._begun = False
        self.render_mode = render_mode
        self._renderer = Renderer(self.batch, render_mode) if render_mode is not None else None

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        """Begin the first episode of ``seed``; without one, the next episode of the seed before."""
        super().reset(seed=seed)
        if seed is not None or not self._begun:
            chosen = int(self.np_random.integers(SEEDS)) if seed is None else seed
            observations = self.batch.reset([chosen])
        else:
            observations = self.batch.restart(np.zeros(1, np.int64))
        self._begun = True
        self._show_frame()
        return observations[0], start_report(self.batch, 0)

    def set_stage(self, stage: int) -> None:
        """Let episodes that begin from now on be of this level of the task; raise
        ConfigurationError where there is none.
        """
        self.batch.set_stage(stage)

    def step(self, action: NDArray[np.float32]) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        """Drive for one control period."""
        step = self.batch.step(np.asarray(action)[None])
        self._show_frame()
        ended = bool(step.terminated[0] or step.truncated[0])
        info = final_report(self.batch, step, 0) if ended else {}
        return step.observations[0], float(step.rewards[0]), bool(step.terminated[0]), bool(step.truncated[0]), info

    def render(self) -> Any:
        """Return the picture of now, (H, W, 3) bytes, in mode ``rgb_array``; in mode ``human`` every step is shown, and
        None returned.

        Raises gymnasium's ResetNeeded ahead of the first reset.
        """
        if not self._begun:
            raise gymnasium.error.ResetNeeded("Cannot render before calling env.reset()")
        if self._renderer is None:
            gymnasium.logger.warn(
                'render() was called without a render mode; allowed: gymnasium.make(..., render_mode="rgb_array")'
            )
            return None
        return self._renderer.frame(0) if self.render_mode == "rgb_array" else None

    def close(self) -> None:
        """Close the window, if there is one."""
        if self._renderer is not None:
            self._renderer.close()

    def _show_frame(self) -> None:
        if self._renderer is not None:
            self._renderer.show()
