"""Interquartile means: what a planner does in the middle half of its problems, which a few disasters or easy ones do
not move.

Agarwal et al. 2021, "Deep reinforcement learning at the edge of the statistical precipice": of the mean, the median and
the interquartile mean the last one is robust and needs few runs; its interval resamples the problems of each condition
for themselves.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from arena_core.base.random_streams import random_generator
from arena_core.statistics.intervals import LEAST_PROBLEMS, TAIL, Estimate, FloatArray

RESAMPLES = 2000  # Agarwal et al. 2021
AT_ONCE = 4_000_000  # numbers that are sorted at once


def interquartile_mean(strata: Sequence[FloatArray]) -> Estimate:
    """Return the mean of the middle half of all figures, one array (P,) of each condition with a figure for each
    problem (NaN: undefined).

    A quarter is cut off on each side, rounded down, over all conditions together.
    """
    known = [kept for stratum in strata if len(kept := stratum[np.isfinite(stratum)])]
    n = sum(map(len, known))
    if n == 0:
        return Estimate(math.nan, math.nan, math.nan, 0, "none", 0)
    mean = float(middle_half(np.concatenate(known)))
    if n < LEAST_PROBLEMS:
        return Estimate(mean, math.nan, math.nan, n, "none", n)
    low, high = np.quantile(_resample_means(known, n), (TAIL, 1.0 - TAIL))
    return Estimate(mean, float(low), float(high), n, "stratified bootstrap", n)


def _resample_means(strata: Sequence[FloatArray], n: int) -> FloatArray:
    """Return the interquartile mean of each resample, (RESAMPLES,); a stream of its own for the
    same numbers of problems.
    """
    random = random_generator(n, "report", "interquartile mean " + " ".join(str(len(stratum)) for stratum in strata))
    found, rows = [], max(1, min(RESAMPLES, AT_ONCE // n))
    for first in range(0, RESAMPLES, rows):
        count = min(rows, RESAMPLES - first)
        drawn = [stratum[random.integers(len(stratum), size=(count, len(stratum)))] for stratum in strata]
        found.append(middle_half(np.concatenate(drawn, axis=1)))
    return np.concatenate(found)


def middle_half(scores: FloatArray) -> FloatArray:
    """Return the mean along the last axis without the lowest and the highest quarter, rounded down: of up
    to three scores their mean.
    """
    cut = scores.shape[-1] // 4
    kept: FloatArray = np.sort(scores, axis=-1)[..., cut : scores.shape[-1] - cut].mean(axis=-1)
    return kept
