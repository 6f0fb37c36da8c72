"""How alike paths are: the discrete Frechet distance between two, and the scatter of where several ended."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]


def discrete_frechet(first: FloatArray, second: FloatArray) -> float:
    """Return the discrete Frechet distance of two paths (N, 2) and (M, 2), m (Eiter and Mannila 1994).

    Two points go along the paths from begin to end, each on or not at every step, never back; it is the longest leash
    that they need at least. The table of all pairs of points is filled diagonal by diagonal, because each entry needs
    its three lower neighbours alone.
    """
    gaps = np.hypot(first[:, None, 0] - second[None, :, 0], first[:, None, 1] - second[None, :, 1])
    rows, columns = gaps.shape
    before = last = np.full(rows + 1, np.inf)  # entry i + 1 belongs to row i; the first one is a border
    for diagonal in range(rows + columns - 1):
        i = np.arange(max(0, diagonal - columns + 1), min(rows, diagonal + 1))
        reached = np.minimum(np.minimum(last[i], last[i + 1]), before[i]) if diagonal else np.array([-np.inf])
        leash = np.full(rows + 1, np.inf)
        leash[i + 1] = np.maximum(reached, gaps[i, diagonal - i])
        before, last = last, leash
    return float(last[rows])


def mean_frechet(paths: Sequence[FloatArray]) -> float:
    """Return the mean discrete Frechet distance over all pairs of these paths, m; NaN for fewer than two."""
    found = [discrete_frechet(a, b) for a, b in combinations(paths, 2)]
    return float(np.mean(found)) if found else math.nan


def standard_distance(positions: FloatArray) -> float:
    """Return the standard distance of positions (K, 2) from their mean, m: the root of the sum of both
    sample variances; NaN for one.
    """
    return float(np.sqrt(positions.var(axis=0, ddof=1).sum())) if len(positions) > 1 else math.nan
