"""The vectorised environment as Stable-Baselines3 wants it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np
from gymnasium.spaces import Box, Space
from numpy.typing import NDArray
from stable_baselines3.common.vec_env import VecEnv

from arena_gym.batch import Step
from arena_gym.episodes import EpisodeKey
from arena_gym.reports import final_report
from arena_gym.training.ground_truth import GroundTruth
from arena_gym.training.running_episodes import ActionLog, RunningEpisodes
from arena_gym.vector_environment import NavigationVectorEnv

SEEDS_APART = 2**16  # between those of two trainings: no two worlds meet the same episodes


class Sb3VecEnv(VecEnv):
    """N worlds of one vectorised environment; begins with the episodes of ``seed``.

    The last columns of observations are the truth, where the critic sees it. The info of an ended episode has
    ``terminal_observation``, ``TimeLimit.truncated``, ``is_success`` (the goal without a collision), ``stage`` (its
    level or None) and ``episode`` (return ``r``, length ``l``, collisions ``c``, outcome ``o``).
    """

    def __init__(self, env: NavigationVectorEnv, seed: int, truth: GroundTruth | None = None) -> None:
        self.env = env  # ahead of the base class, which asks it for its render mode
        self._batch, self._truth, self._all = env.batch, truth, np.arange(env.num_envs)
        super().__init__(env.num_envs, _with_truth(env.single_observation_space, truth), env.single_action_space)
        self._of_worlds = [seed * SEEDS_APART + k for k in range(env.num_envs)]
        self._actions: NDArray[Any] = np.zeros((env.num_envs, 1))
        self._returns = np.zeros(env.num_envs)
        self._log = ActionLog(env.num_envs)

    def state(self) -> dict[str, Any]:
        """Return what a checkpoint keeps of the running episodes: numbers and arrays."""
        running = self._log.running_episodes(self._batch.keys)
        keys = [[key.seed, key.number, -1 if key.stage is None else key.stage] for key in running.keys]
        return {"keys": keys, "actions": running.actions, "lengths": running.lengths, "returns": self._returns.copy()}

    def restore(self, state: Mapping[str, Any]) -> tuple[NDArray[np.float32], NDArray[np.bool_]]:
        """Drive the episodes of a checkpoint to where they were; return observations
        and who is at the beginning of one.
        """
        keys = [
            EpisodeKey(int(seed), int(number), None if stage < 0 else int(stage))
            for seed, number, stage in state["keys"]
        ]
        running = RunningEpisodes(keys, np.asarray(state["actions"]), np.asarray(state["lengths"]))
        observations = running.replay_actions(self._batch)
        self._log.restore(running)
        self._returns = np.array(state["returns"], np.float64)
        return self._beside_truth(observations, self._all), running.lengths == 0

    def reset(self) -> NDArray[np.float32]:
        """Begin all episodes again."""
        self._returns[:] = 0.0
        return self._beside_truth(self._batch.reset(self._of_worlds), self._all)

    def lead_by_real_parts(self) -> NDArray[np.float32]:
        """Let the real parts of guides lead all robots from now on, in the next episodes, which all begin; return the
        observations.
        """
        self._batch.lead_by_real_parts()
        self._returns[:] = 0.0
        self._log = ActionLog(self.num_envs)
        return self._beside_truth(self._batch.restart(self._all), self._all)

    def step_async(self, actions: NDArray[Any]) -> None:
        """Take the actions of the next step."""
        self._actions = actions

    def step_wait(self) -> tuple[Any, ...]:
        """Step all worlds; those whose episodes end begin the next ones."""
        step = self._batch.step(self._actions)
        self._returns += step.rewards
        dones = step.terminated | step.truncated
        self._log.add(self._actions, dones)
        observations = self._beside_truth(step.observations, self._all)
        infos: list[dict[str, Any]] = [{} for _ in range(self.num_envs)]
        slots = np.flatnonzero(dones)
        for slot in slots.tolist():
            infos[slot] = self._final_info(step, slot, observations[slot].copy())
        if len(slots):
            observations[slots] = self._beside_truth(self._batch.restart(slots), slots)
            self._returns[slots] = 0.0
        return observations, step.rewards.astype(np.float32), dones, infos

    def _final_info(self, step: Step, slot: int, last: NDArray[np.float32]) -> dict[str, Any]:
        final = final_report(self._batch, step, slot)
        collisions = int(final["collisions"])
        episode = {
            "r": float(self._returns[slot]),
            "l": int(final["steps"]),
            "c": collisions,
            "o": str(final["outcome"]),
        }
        return {
            "terminal_observation": last,
            "TimeLimit.truncated": bool(step.truncated[slot]),
            "is_success": bool(final["success"]) and collisions == 0,
            "episode": episode,
            "stage": final.get("stage"),
        }

    def _beside_truth(self, observations: NDArray[np.float32], slots: NDArray[np.int64]) -> NDArray[np.float32]:
        """Return observations (K, D) of these slots with the truth behind them, where the critic sees it."""
        if self._truth is None:
            return observations
        return np.hstack((observations, self._truth.truth_columns(self._batch.snapshot, slots)))

    def close(self) -> None:
        """Close the environment."""
        self.env.close()

    def get_attr(self, attr_name: str, indices: Any = None) -> list[Any]:
        """Return an attribute of the environment, once for each world."""
        return [getattr(self.env, attr_name, None)] * len(self._slot_indices(indices))

    def set_attr(self, attr_name: str, value: Any, indices: Any = None) -> None:
        """Refuse: worlds have no attributes of their own."""
        raise NotImplementedError("the worlds of a vectorised environment have no attributes of their own")

    def env_method(self, method_name: str, *method_args: Any, indices: Any = None, **method_kwargs: Any) -> list[Any]:
        """Refuse: worlds have no methods of their own."""
        raise NotImplementedError("the worlds of a vectorised environment have no methods of their own")

    def env_is_wrapped(self, wrapper_class: type, indices: Any = None) -> list[bool]:
        """Say that no world is wrapped."""
        return [False] * len(self._slot_indices(indices))

    def _slot_indices(self, indices: Iterable[int] | int | None) -> Sequence[int]:
        if indices is None:
            return range(self.num_envs)
        return [indices] if isinstance(indices, int) else list(indices)


def _with_truth(space: Space[Any], truth: GroundTruth | None) -> Space[Any]:
    """Return the space of observations with the truth behind them."""
    if truth is None:
        return space
    assert isinstance(space, Box)
    beside = np.full(truth.size, np.inf, np.float32)
    return Box(np.concatenate((space.low, -beside)), np.concatenate((space.high, beside)), dtype=np.float32)
