"""What a choice among members is worth on states of which every member's outcome is known."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
RESAMPLES = 2000  # of the blocks, for intervals


def score_choices(costs: Floats, answers: Floats, block: NDArray[np.int64], members: Sequence[str]) -> dict[str, Any]:
    """Return the mean cost, s, of each member alone, of one at random, of the best of each state (``oracle``, which
    knows what comes) and of the one that ``answers`` (N, K) prefer; what that one and the oracle cost more than the
    best member, with 95 % intervals over blocks; and how often each is chosen.
    """
    chosen = answers.argmax(axis=1)
    learned, oracle = costs[np.arange(len(costs)), chosen], costs.min(axis=1)
    best = int(costs.mean(axis=0).argmin())
    return {
        "states": len(costs),
        "alone": dict(zip(members, costs.mean(axis=0).round(4).tolist(), strict=True)),
        "random": round(float(costs.mean()), 4),
        "oracle": round(float(oracle.mean()), 4),
        "learned": round(float(learned.mean()), 4),
        "best": members[best],
        "learned_less_best": interval(learned - costs[:, best], block),
        "oracle_less_best": interval(oracle - costs[:, best], block),
        "chosen": {name: round(float((chosen == k).mean()), 4) for k, name in enumerate(members)},
    }


def interval(differences: Floats, block: NDArray[np.int64]) -> list[float]:
    """Return the mean of differences (N,), and the ends of its 95 % interval: a bootstrap of whole blocks."""
    _, of = np.unique(block, return_inverse=True)
    sums, counts = np.bincount(of, differences), np.bincount(of)
    drawn = np.random.default_rng(0).integers(len(sums), size=(RESAMPLES, len(sums)))
    means = sums[drawn].sum(axis=1) / counts[drawn].sum(axis=1)
    return [round(float(value), 4) for value in (differences.mean(), *np.quantile(means, (0.025, 0.975)))]


def describe_score(score: Mapping[str, Any]) -> str:
    """Return a score in one line."""
    alone = ", ".join(f"{name} {cost:.2f}" for name, cost in score["alone"].items())
    mean, low, high = score["learned_less_best"]
    return (
        f"cost of {score['states']} unseen states, s: {alone}, random {score['random']:.2f}, "
        f"learned {score['learned']:.2f}, oracle {score['oracle']:.2f}; "
        f"learned less {score['best']} {mean:+.2f} [{low:+.2f}, {high:+.2f}]"
    )
