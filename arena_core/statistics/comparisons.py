"""Two planners on the same problems: the mean difference, how sure it is, whether chance explains it, and
how many more would tell.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from arena_core.statistics.clusters import MOST_RESAMPLED, Clusters
from arena_core.statistics.intervals import (
    LEAST_PROBLEMS,
    Estimate,
    FloatArray,
    Kind,
    Labels,
    bootstrap_interval,
    defined_values,
    design_effect,
    no_scatter,
    pivot_quantile,
)

ALPHA = 0.05  # false alarms among the comparisons of one family
POWER = 0.8  # with which the episodes asked for would show a difference (Cohen 1988, section 2.4)
# root of the squares of two events that no one saw, one on each side, as Bonett and Price add for proportions
UNSEEN = math.sqrt(2.0)
WORTH = 0.1  # difference of proportions that one wants to see


@dataclass(frozen=True, slots=True)
class Comparison:
    """A mean difference over pairs, its ``p`` alone and among its family after Holm, and how large it is.

    ``effect``: of figures the mean difference over its standard deviation (Cohen's d of pairs), of proportions Cohen's
    g, the share of decided pairs that was won, less a half. ``more``: how many of ``unit`` would show a difference of
    WORTH; NaN but for proportions.
    """

    difference: Estimate
    p: float
    holm: float
    effect: float
    higher: int
    lower: int
    more: float
    unit: str

    @property
    def told_apart(self) -> bool:
        """Return whether chance does not explain the difference."""
        return self.holm <= ALPHA


def compare(
    values: ArrayLike,
    baseline: ArrayLike,
    kind: Kind | bool = "figure",
    problems: Labels | None = None,
    worlds: Labels | None = None,
) -> Comparison:
    """Compare over the pairs in which both are defined; ``problems`` and ``worlds`` are the pairs' labels
    (``intervals.estimate``).
    """
    pairs = np.asarray(values, dtype=np.float64) - np.asarray(baseline, dtype=np.float64)
    kept, sample = defined_values(pairs, problems, worlds)
    higher, lower = int((kept > 0.0).sum()), int((kept < 0.0).sum())
    unit = "problems" if sample.repeated else "episodes"
    if sample.problems < LEAST_PROBLEMS:
        mean = float(kept.mean()) if len(kept) else math.nan
        nothing = Estimate(mean, math.nan, math.nan, len(kept), "none", sample.problems)
        return Comparison(nothing, math.nan, math.nan, math.nan, higher, lower, math.nan, unit)
    if kind is True or kind == "proportion":
        p = _sign_flips(sample) if sample.repeated else _mcnemar_p(higher, lower)
        found = _with_zero(_bonett_price(kept, sample), p)
        effect = higher / (higher + lower) - 0.5 if higher + lower else 0.0
        return Comparison(found, p, p, effect, higher, lower, _more_needed(kept, sample), unit)
    error = sample.error() if kind != "count" else math.hypot(sample.error(), UNSEEN / sample.problems)
    found, p = bootstrap_interval(sample, len(kept), error), _p_value(sample, error)
    scatter = float(kept.std(ddof=1))
    effect = found.mean / scatter if scatter > 0.0 else math.nan
    return Comparison(found, p, p, effect, higher, lower, math.nan, unit)


def estimate_difference(
    values: ArrayLike,
    baseline: ArrayLike,
    problems: Labels | None = None,
    worlds: Labels | None = None,
    *,
    proportion: bool = False,
) -> Estimate:
    """Estimate the mean of ``values - baseline`` over the pairs in which both are defined."""
    return compare(values, baseline, "proportion" if proportion else "figure", problems, worlds).difference


def after_holm(family: Sequence[Comparison]) -> list[Comparison]:
    """Return the comparisons of one family with p after Holm (1979); those without p are no part of it."""
    known = sorted((i for i, one in enumerate(family) if math.isfinite(one.p)), key=lambda i: family[i].p)
    times = np.arange(len(known), 0, -1)
    adjusted = np.minimum(1.0, np.maximum.accumulate(times * [family[i].p for i in known])) if known else ()
    told = list(family)
    for i, holm in zip(known, adjusted, strict=True):
        told[i] = replace(family[i], holm=float(holm))
    return told


def _mcnemar_p(higher: int, lower: int) -> float:
    """Return p of McNemar's exact test (1947): of the pairs that differ, either planner wins half."""
    from scipy.special import bdtr

    return min(1.0, 2.0 * float(bdtr(min(higher, lower), higher + lower, 0.5))) if higher + lower else 1.0


def _sign_flips(sample: Clusters) -> float:
    """Return p of the exact test that changes the planners round in whole problems; McNemar's,
    where each problem was run once.
    """
    steps = np.abs(sample.sums).round().astype(np.int64)
    total = int(steps.sum())
    chance = np.zeros(2 * total + 1)
    chance[total] = 1.0
    for step in steps[steps > 0]:
        chance = 0.5 * (np.roll(chance, step) + np.roll(chance, -step))
    far = np.abs(np.arange(-total, total + 1)) >= abs(round(sample.sums.sum()))
    return float(min(1.0, chance[far].sum()))


def _bonett_price(pairs: FloatArray, sample: Clusters) -> Estimate:
    """Return the interval of a difference of paired proportions (Bonett and Price 2012): one pair is added to each kind
    that differs.

    Unlike a bootstrap it is no point when all pairs are alike. Repeated problems count as in ``intervals``.
    """
    share = 1.0 / design_effect(pairs, sample)
    n, z = len(pairs) * share + 2.0, pivot_quantile(sample)
    won, lost = ((share * (side > 0.0).sum() + 1.0) / n for side in (pairs, -pairs))
    half = z * math.sqrt((won + lost - (won - lost) ** 2) / n)
    low, high = max(-1.0, won - lost - half), min(1.0, won - lost + half)
    return Estimate(float(pairs.mean()), float(low), float(high), len(pairs), "Bonett-Price", sample.problems)


def _with_zero(found: Estimate, p: float) -> Estimate:
    """Let the interval reach to 0 where the exact test does not exclude it, so that both say the same."""
    return replace(found, low=min(found.low, 0.0), high=max(found.high, 0.0)) if p > ALPHA else found


def _p_value(sample: Clusters, error: float) -> float:
    """Return p of a mean difference, by the same pivots as its interval: the greater of
    Student's and the studentised bootstrap's.
    """
    from scipy.special import stdtr

    mean, least = sample.mean, 2.0 ** (1 - sample.problems)  # what flipping signs could give at best
    if no_scatter(sample, error):
        return 1.0 if mean == 0.0 else least
    p = 2.0 * float(stdtr(sample.freedom, -abs(mean) / error))
    if sample.problems > MOST_RESAMPLED or sample.error() == 0.0:
        return p
    beyond = np.sign(mean) * sample.pivots() >= abs(mean) / sample.error()
    return float(min(1.0, max(p, 2.0 * (beyond.sum() + 1) / (len(beyond) + 1))))


def _more_needed(pairs: FloatArray, sample: Clusters) -> float:
    """Return how many more episodes, or problems where these were repeated, would show a
    difference of WORTH (Miettinen 1968).
    """
    from scipy.special import ndtri

    n, differing = len(pairs), float((pairs != 0.0).sum())
    # Laplace's estimate: the share of pairs that differ is not sure to be 0
    decided = max((differing + 1.0) / (n + 2.0), WORTH)
    z = -float(ndtri(ALPHA / 2.0)) * math.sqrt(decided) + float(ndtri(POWER)) * math.sqrt(decided - WORTH**2)
    needed = design_effect(pairs, sample) * (z / WORTH) ** 2
    return max(0.0, needed / n - 1.0) * sample.problems
