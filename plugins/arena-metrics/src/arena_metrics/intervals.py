"""How sure a mean is: 95 % intervals, bootstrapped (BCa) for figures and after Wilson for proportions."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from arena_core import generator

FloatArray = NDArray[np.float64]
Method = Literal["BCa bootstrap", "Wilson", "Agresti-Min", "none"]

RESAMPLES = 5000  # Efron and Tibshirani 1993, section 14.3, ask for 1000 or more
Z95 = 1.959963984540054  # standard normal quantile of 0.975


@dataclass(frozen=True, slots=True)
class Estimate:
    """A mean over ``n`` episodes with its 95 % interval; ``low`` and ``high`` are NaN where there is none."""

    mean: float
    low: float
    high: float
    n: int
    method: Method

    @property
    def has_interval(self) -> bool:
        """Tell whether there is an interval."""
        return self.method != "none"


def estimates(columns: Sequence[ArrayLike], proportions: Sequence[bool]) -> list[Estimate]:
    """Estimate the mean of each column over the episodes in which it is defined (not NaN)."""
    values = [_defined(column) for column in columns]
    found: list[Estimate | None] = [_wilson(v) if share else None for v, share in zip(values, proportions, strict=True)]
    open_by_length: dict[int, list[int]] = {}
    for i, v in enumerate(values):
        if found[i] is None:
            open_by_length.setdefault(len(v), []).append(i)
    for length, indices in open_by_length.items():
        for i, estimate in zip(indices, _bootstrapped([values[i] for i in indices], length), strict=True):
            found[i] = estimate
    return [estimate for estimate in found if estimate is not None]


def estimate(values: ArrayLike, proportion: bool = False) -> Estimate:
    """Estimate one mean."""
    return estimates([values], [proportion])[0]


def difference(values: ArrayLike, baseline: ArrayLike, proportion: bool = False) -> Estimate:
    """Estimate the mean of ``values - baseline`` over the pairs in which both are defined."""
    differences = _defined(np.asarray(values, dtype=np.float64) - np.asarray(baseline, dtype=np.float64))
    if len(differences) < 2:
        return estimate(differences)
    return _agresti_min(differences) if proportion else estimate(differences)


def _agresti_min(differences: FloatArray) -> Estimate:
    """Return the interval of a difference of paired proportions (Agresti and Min 2005): half a pair is added to each kind.

    Unlike a bootstrap it is no point when all pairs are alike.
    """
    n = len(differences)
    won, lost = (differences > 0.0).sum() + 0.5, (differences < 0.0).sum() + 0.5
    centre = (won - lost) / (n + 2)
    half = Z95 * math.sqrt(won + lost - (won - lost) ** 2 / (n + 2)) / (n + 2)
    return Estimate(float(differences.mean()), max(-1.0, float(centre - half)), min(1.0, float(centre + half)), n, "Agresti-Min")


def _defined(column: ArrayLike) -> FloatArray:
    values = np.asarray(column, dtype=np.float64)
    return values[np.isfinite(values)]


def _wilson(values: FloatArray) -> Estimate:
    """Return the score interval of a proportion (Wilson 1927), which stays inside 0 .. 1 and is no point at 0 or 1."""
    n = len(values)
    if n == 0:
        return Estimate(math.nan, math.nan, math.nan, 0, "none")
    p = float(values.mean())
    if n == 1:
        return Estimate(p, math.nan, math.nan, 1, "none")
    spread = 1.0 + Z95**2 / n
    centre = (p + Z95**2 / (2 * n)) / spread
    half = Z95 * math.sqrt(p * (1.0 - p) / n + Z95**2 / (4 * n**2)) / spread
    return Estimate(p, max(0.0, centre - half), min(1.0, centre + half), n, "Wilson")


def _bootstrapped(columns: list[FloatArray], n: int) -> list[Estimate]:
    """Estimate columns of equal length ``n`` together."""
    if n < 2:
        return [Estimate(float(v[0]) if n else math.nan, math.nan, math.nan, n, "none") for v in columns]
    samples = np.stack(columns, axis=1)
    low, high = bca(samples)
    means = samples.mean(axis=0)
    return [Estimate(float(m), float(a), float(b), n, "BCa bootstrap") for m, a, b in zip(means, low, high, strict=True)]


def bca(samples: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the bias-corrected and accelerated 95 % interval of the mean of each column of (n, M) samples.

    Efron 1987. Every call with the same n draws the same resamples (a stream of its own), so results do not depend on the order of calls.
    """
    from scipy.special import ndtr, ndtri

    means = samples.mean(axis=0)
    centred = samples - means
    resampled = np.sort(resample_weights(len(samples)) @ centred, axis=0)
    tolerance = 1e-9 * np.abs(centred).max(axis=0)
    below = (resampled < -tolerance).sum(axis=0) + 0.5 * (np.abs(resampled) <= tolerance).sum(axis=0)
    bias = ndtri(np.clip(below / RESAMPLES, 1.0 / RESAMPLES, 1.0 - 1.0 / RESAMPLES))
    squares = (centred**2).sum(axis=0)
    acceleration = np.divide((centred**3).sum(axis=0), 6.0 * squares**1.5, out=np.zeros_like(squares), where=squares > 0.0)
    low, high = (means + _quantiles(resampled, ndtr(bias + (bias + z) / (1.0 - acceleration * (bias + z)))) for z in (-Z95, Z95))
    return low, high


@lru_cache(maxsize=16)
def resample_weights(n: int) -> FloatArray:
    """Return the shares that each of ``n`` episodes has in each resample, shape (RESAMPLES, n)."""
    drawn = generator(n, "report", "bootstrap").multinomial(n, np.full(n, 1.0 / n), size=RESAMPLES)
    weights: FloatArray = drawn / n
    weights.flags.writeable = False
    return weights


def _quantiles(sorted_columns: FloatArray, shares: FloatArray) -> FloatArray:
    """Return a quantile of its own for each sorted column, interpolated."""
    position = np.clip(shares, 0.0, 1.0) * (len(sorted_columns) - 1)
    under = np.floor(position).astype(np.int64)
    over = np.minimum(under + 1, len(sorted_columns) - 1)
    columns = np.arange(sorted_columns.shape[1])
    lower, upper = sorted_columns[under, columns], sorted_columns[over, columns]
    quantiles: FloatArray = lower + (position - under) * (upper - lower)
    return quantiles
