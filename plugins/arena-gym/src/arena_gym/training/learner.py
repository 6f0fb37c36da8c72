"""Stable-Baselines3's PPO, which can go on where an earlier process stopped."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from stable_baselines3 import PPO
from stable_baselines3.common.buffers import RolloutBuffer
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.vec_env import VecEnv


class Learner(PPO):
    """PPO that tells and takes what ``learn`` goes on from, and ends after ``last_step`` steps, within a decision of
    all worlds.
    """

    last_step: int | None = None

    def collect_rollouts(
        self, env: VecEnv, callback: BaseCallback, rollout_buffer: RolloutBuffer, n_rollout_steps: int
    ) -> bool:
        """Drive all worlds for so many decisions, the last time for those that are left."""
        if self.last_step is not None:
            left = -(-(self.last_step - self.num_timesteps) // env.num_envs)
            if left < rollout_buffer.buffer_size:
                rollout_buffer.buffer_size = n_rollout_steps = left
                rollout_buffer.reset()
        return super().collect_rollouts(env, callback, rollout_buffer, n_rollout_steps)

    @property
    def updates(self) -> int:
        """Return how many passes over a roll-out have been made."""
        return int(self._n_updates)

    @property
    def observations(self) -> NDArray[np.float32]:
        """Return what was observed last, (N, D)."""
        return np.asarray(self._last_obs)

    def restore_counts(self, updates: int, steps: int) -> None:
        """Count on from what was done before."""
        self._n_updates, self.num_timesteps = updates, steps

    def restore_observations(self, observations: Any, begun: Any) -> None:
        """Go on from what was last observed, and which worlds began an episode with it."""
        self._last_obs, self._last_episode_starts = observations, begun
