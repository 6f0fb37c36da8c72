"""What states turned out to be worth."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]


def lambda_returns(
    rewards: Floats,
    values: Floats,
    last_values: Floats,
    ended: Flags,
    cut: Flags,
    chance: Flags,
    discount: float,
    trace: float,
) -> Floats:
    """Return lambda-returns (T, N) of rewards (T, N), from values (T, N) of the states before them and (N,) of those
    after the last.

    An episode ``ended`` (T, N) after a step is worth nothing from there on; where it was ``cut`` for time, what it was
    worth counts as unchanged. A step of ``chance`` tells nothing of what the best actions earn: returns stop at it
    (Watkins 1989).
    """
    returns = np.empty_like(rewards)
    following = last_values
    for t in range(len(rewards) - 1, -1, -1):
        after = np.where(ended[t], 0.0, following)
        returns[t] = np.where(cut[t], values[t], rewards[t] + discount * after)
        share = np.where(chance[t], 0.0, trace)
        following = (1.0 - share) * values[t] + share * returns[t]
    return returns
