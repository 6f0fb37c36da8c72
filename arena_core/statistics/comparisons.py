"""Two planners on the same problems: the mean difference, how sure it is, whether chance explains it, and
how many more would tell.
"""

from __future__ import annotations

import math
from bisect import bisect_left
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
COUNTED = 25  # resamples in a tail that are enough to count: their number is off by a fifth


@dataclass(frozen=True, slots=True)
class Comparison:
    """A mean difference over pairs, its ``p`` alone and among its family after Holm, and how large it is.

    ``effect``: of figures the mean difference over its standard deviation (Cohen's d of pairs), of proportions Cohen's
    g, the share of decided pairs that was won, less a half. ``more``: how many of ``unit`` would show a difference of
    WORTH; NaN but for proportions. ``smallest``: the least difference that as many as there are would probably show.
    """

    difference: Estimate
    p: float
    holm: float
    effect: float
    higher: int
    lower: int
    more: float
    unit: str
    smallest: float = math.nan

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
        more, smallest = _more_needed(kept, sample), _smallest_shown(kept, sample)
        return Comparison(found, p, p, effect, higher, lower, more, unit, smallest)
    error = sample.error() if kind != "count" else math.hypot(sample.error(), UNSEEN / sample.problems)
    found, p = bootstrap_interval(sample, len(kept), error), _p_value(sample, error)
    scatter = float(kept.std(ddof=1))
    effect = found.mean / scatter if scatter > 0.0 else math.nan
    return Comparison(found, p, p, effect, higher, lower, math.nan, unit, _power_quantile(sample) * error)


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
    """Return p of McNemar's mid-p test (Fagerland et al. 2013): of the pairs that differ, either planner wins half.

    Half of the chance of what was seen counts: the exact test finds chance differences in 1 % of the tables, not in 5.
    """
    from scipy.special import bdtr

    fewer, differing = min(higher, lower), higher + lower
    if fewer == 0:
        return 0.5**differing  # twice half of the chance of this one; without any pair 1
    return float(bdtr(fewer, differing, 0.5) + bdtr(fewer - 1, differing, 0.5))


def _sign_flips(sample: Clusters) -> float:
    """Return mid-p of the exact test that changes the planners round in whole problems; McNemar's,
    where each problem was run once.
    """
    steps = np.abs(sample.sums).round().astype(np.int64)
    total = int(steps.sum())
    chance = np.zeros(2 * total + 1)
    chance[total] = 1.0
    for step in steps[steps > 0]:
        chance = 0.5 * (np.roll(chance, step) + np.roll(chance, -step))
    seen = total - abs(round(sample.sums.sum()))
    return float(2.0 * chance[:seen].sum() + chance[seen])


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
    return float(min(1.0, max(p, _resampled_p(np.sign(mean) * sample.pivots(), abs(mean) / sample.error(), sample))))


def _resampled_p(pivots: FloatArray, seen: float, sample: Clusters) -> float:
    """Return p of the studentised bootstrap; where next to no resample lies beyond, that of Student's t, as wide as the
    last ``COUNTED`` resamples are.

    So the number of resamples sets no floor, which a family of more than a hundred comparisons would run into.
    """
    from scipy.special import stdtr, stdtrit

    beyond = int((pivots >= seen).sum())
    if beyond >= COUNTED:
        return 2.0 * (beyond + 1) / (len(pivots) + 1)
    last = float(np.partition(pivots, -COUNTED)[-COUNTED])
    wider = last / float(stdtrit(sample.freedom, 1.0 - (COUNTED + 1) / (len(pivots) + 1)))
    return 2.0 * float(stdtr(sample.freedom, -seen / wider)) if wider > 0.0 else 0.0


def _more_needed(pairs: FloatArray, sample: Clusters) -> float:
    """Return how many more episodes, or problems where these were repeated, would show a
    difference of WORTH (Miettinen 1968).
    """
    needed = design_effect(pairs, sample) * _pairs_needed(WORTH, _decided_share(pairs))
    return max(0.0, needed / len(pairs) - 1.0) * sample.problems


def _smallest_shown(pairs: FloatArray, sample: Clusters) -> float:
    """Return the least difference of proportions for which as many pairs as there are suffice; 1 where none does."""
    n, decided = len(pairs) / design_effect(pairs, sample), _decided_share(pairs)
    return (1 + bisect_left(range(1, 1000), -n, key=lambda tried: -_pairs_needed(tried / 1000.0, decided))) / 1000.0


def _pairs_needed(effect: float, decided: float) -> float:
    """Return how many pairs, of which this share differs, show a difference of proportions (Miettinen 1968)."""
    from scipy.special import ndtri

    share = max(decided, effect)
    z = -float(ndtri(ALPHA / 2.0)) * math.sqrt(share) + float(ndtri(POWER)) * math.sqrt(share - effect**2)
    return (z / effect) ** 2


def _decided_share(pairs: FloatArray) -> float:
    """Return Laplace's estimate of the share of pairs that differ, which is not sure to be 0."""
    return (float((pairs != 0.0).sum()) + 1.0) / (len(pairs) + 2.0)


def _power_quantile(sample: Clusters) -> float:
    """Return how many standard errors a difference has to be off so that it probably shows."""
    from scipy.special import ndtri, stdtrit

    return float(stdtrit(sample.freedom, 1.0 - ALPHA / 2.0) + ndtri(POWER))
