"""The vectorised environment as Stable-Baselines3 wants it."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from stable_baselines3.common.vec_env import VecEnv

from arena_gym.vector_environment import NavigationVectorEnv


class WorldsInStep(VecEnv):
    """N worlds of one vectorised environment; begins with the episodes of ``seed``.

    The info of an ended episode has ``terminal_observation``, ``TimeLimit.truncated``, ``is_success`` (the goal without a collision) and
    ``episode`` (return ``r``, length ``l``, collisions ``c``, outcome ``o``).
    """

    def __init__(self, env: NavigationVectorEnv, seed: int) -> None:
        self.env = env  # ahead of the base class, which asks it for its render mode
        super().__init__(env.num_envs, env.single_observation_space, env.single_action_space)
        self._seed = seed
        self._actions: NDArray[Any] = np.zeros((env.num_envs, 1))
        self._returns = np.zeros(env.num_envs)

    def resume(self, steps: int) -> None:
        """Go on with episodes that the first ``steps`` steps did not meet."""
        self._seed += steps

    def reset(self) -> NDArray[np.float32]:
        """Begin all episodes anew."""
        self._returns[:] = 0.0
        return self.env.reset(seed=self._seed)[0]

    def step_async(self, actions: NDArray[Any]) -> None:
        """Take the actions of the next step."""
        self._actions = actions

    def step_wait(self) -> tuple[Any, ...]:
        """Step all worlds."""
        observations, rewards, terminated, truncated, ends = self.env.step(self._actions)
        self._returns += rewards
        dones = terminated | truncated
        infos: list[dict[str, Any]] = [{} for _ in range(self.num_envs)]
        for slot in np.flatnonzero(dones).tolist():
            infos[slot] = self._ended(ends, slot, bool(truncated[slot]))
            self._returns[slot] = 0.0
        return observations, rewards.astype(np.float32), dones, infos

    def _ended(self, ends: dict[str, Any], slot: int, truncated: bool) -> dict[str, Any]:
        final = ends["final_info"]
        collisions = int(final["collisions"][slot])
        episode = {"r": float(self._returns[slot]), "l": int(final["steps"][slot]), "c": collisions, "o": str(final["outcome"][slot])}
        return {
            "terminal_observation": ends["final_obs"][slot],
            "TimeLimit.truncated": truncated,
            "is_success": bool(final["success"][slot]) and collisions == 0,
            "episode": episode,
        }

    def close(self) -> None:
        """Close the environment."""
        self.env.close()

    def get_attr(self, attr_name: str, indices: Any = None) -> list[Any]:
        """Return an attribute of the environment, once for each world."""
        return [getattr(self.env, attr_name, None)] * len(self._slots(indices))

    def set_attr(self, attr_name: str, value: Any, indices: Any = None) -> None:
        """Refuse: worlds have no attributes of their own."""
        raise NotImplementedError("the worlds of a vectorised environment have no attributes of their own")

    def env_method(self, method_name: str, *method_args: Any, indices: Any = None, **method_kwargs: Any) -> list[Any]:
        """Refuse: worlds have no methods of their own."""
        raise NotImplementedError("the worlds of a vectorised environment have no methods of their own")

    def env_is_wrapped(self, wrapper_class: type, indices: Any = None) -> list[bool]:
        """Say that no world is wrapped."""
        return [False] * len(self._slots(indices))

    def _slots(self, indices: Iterable[int] | int | None) -> Sequence[int]:
        if indices is None:
            return range(self.num_envs)
        return [indices] if isinstance(indices, int) else list(indices)
