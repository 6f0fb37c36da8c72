"""How sure scores are: of one policy over test episodes, of a recipe over training seeds."""

from __future__ import annotations

import math
from collections.abc import Sequence
from statistics import NormalDist

import numpy as np

from arena_core.base.random_streams import random_generator
from arena_core.statistics.aggregates import middle_half

CONFIDENCE = 0.95
RESAMPLES = 5000
_Z = NormalDist().inv_cdf(0.5 + CONFIDENCE / 2.0)


def wilson(share: float, n: int) -> tuple[float, float]:
    """Return the 95 % interval of a proportion after Wilson (1927)."""
    wider = 1.0 + _Z**2 / n
    centre = (share + _Z**2 / (2.0 * n)) / wider
    half = _Z * math.sqrt(share * (1.0 - share) / n + _Z**2 / (4.0 * n**2)) / wider
    low, high = max(0.0, centre - half), min(1.0, centre + half)
    return (0.0 if share == 0.0 else low), (1.0 if share == 1.0 else high)


def over_seeds(groups: Sequence[Sequence[float]]) -> tuple[float, float, float]:
    """Return the interquartile mean of all scores with its 95 % interval over training seeds; NaN ends where a group
    has a single one.

    ``groups`` are the scores of one recipe each, one score a training seed. The interval is the percentile bootstrap
    that draws seeds again within each group (Agarwal et al. 2021). With three seeds it lies within least and greatest,
    and covers less than it says.
    """
    mean = float(middle_half(np.concatenate([np.asarray(group, np.float64) for group in groups])))
    if min(len(group) for group in groups) < 2:
        return mean, math.nan, math.nan
    random = random_generator(sum(map(len, groups)), "trainings", "bootstrap")
    parts = [np.asarray(group)[random.integers(len(group), size=(RESAMPLES, len(group)))] for group in groups]
    low, high = np.quantile(
        middle_half(np.concatenate(parts, axis=1)), (0.5 - CONFIDENCE / 2.0, 0.5 + CONFIDENCE / 2.0)
    )
    return mean, float(low), float(high)
