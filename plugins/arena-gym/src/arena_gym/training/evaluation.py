"""How good a policy is, on problems that it never trained on."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, dataclass

import numpy as np
from numpy.typing import NDArray

from arena_gym.vector_environment import NavigationVectorEnv

Act = Callable[[NDArray[np.float32]], NDArray[np.floating]]


@dataclass(frozen=True, slots=True)
class Score:
    """Shares of ``episodes``: ``success`` without any collision, ``collision``, ``time_out``."""

    episodes: int
    success: float
    collision: float
    time_out: float

    def as_row(self) -> dict[str, float]:
        """Return the score as plain numbers."""
        return asdict(self)


def evaluate(env: NavigationVectorEnv, act: Act, episodes: int, seed: int) -> Score:
    """Drive the first episodes of each world until there are ``episodes`` of them; a collision ends an episode.

    Each world contributes its first episodes, however long they take: the fastest to end would be the easy ones.
    """
    quota = np.full(env.num_envs, episodes // env.num_envs)
    quota[: episodes % env.num_envs] += 1
    done = np.zeros(env.num_envs, np.int64)
    outcomes = {"goal_reached": 0, "collision": 0, "time_out": 0}
    observations = env.reset(seed=seed)[0]
    while (done < quota).any():
        observations, _, terminated, truncated, ends = env.step(act(observations))
        for slot in np.flatnonzero((terminated | truncated) & (done < quota)).tolist():
            outcomes[str(ends["final_info"]["outcome"][slot])] += 1
            done[slot] += 1
    total = sum(outcomes.values())
    return Score(total, outcomes["goal_reached"] / total, outcomes["collision"] / total, outcomes["time_out"] / total)
