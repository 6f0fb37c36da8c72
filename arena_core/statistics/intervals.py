"""How sure a mean is: 95 % intervals over problems, with methods that keep their word with few episodes (docs/report.md
says why these).

Figures: the studentised bootstrap of problems. Proportions: Agresti and Coull. Numbers of events: exact after Garwood.
"""

from __future__ import annotations

import math
from collections.abc import Hashable, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from arena_core.statistics.clusters import MOST_RESAMPLED, Clusters, make_clusters

FloatArray = NDArray[np.float64]
Labels = Sequence[Hashable]
Kind = Literal["figure", "proportion", "count"]
Method = Literal[
    "studentised bootstrap", "Student's t", "Agresti-Coull", "Garwood", "Bonett-Price", "stratified bootstrap", "none"
]

LEAST_PROBLEMS = 5  # with fewer, no interval and no test: their scatter says next to nothing
TAIL = 0.025  # beyond each end of an interval


@dataclass(frozen=True, slots=True)
class Estimate:
    """A mean over ``n`` episodes of ``problems`` problems with its 95 % interval; ``low`` and
    ``high`` are NaN where there is none.
    """

    mean: float
    low: float
    high: float
    n: int
    method: Method
    problems: int

    @property
    def has_interval(self) -> bool:
        """Return whether there is an interval."""
        return self.method != "none"

    def within(self, least: float, most: float) -> Estimate:
        """Return the estimate with an interval that stays where the figure can lie: what is cut off held no truth."""
        if not self.has_interval:
            return self
        return replace(self, low=min(max(self.low, least), most), high=max(min(self.high, most), least))


def estimate(
    values: ArrayLike, kind: Kind | bool = "figure", problems: Labels | None = None, worlds: Labels | None = None
) -> Estimate:
    """Estimate a mean over the episodes in which it is defined (not NaN).

    ``kind`` may be True for a proportion. ``problems`` and ``worlds`` are labels of the values: without them each is a
    problem of its own, in one world.
    """
    kept, sample = defined_values(values, problems, worlds)
    n = len(kept)
    if n == 0 or sample.problems < LEAST_PROBLEMS:
        return Estimate(float(kept.mean()) if n else math.nan, math.nan, math.nan, n, "none", sample.problems)
    if kind is True or kind == "proportion":
        return _agresti_coull(kept, sample)
    return _garwood_interval(kept, sample) if kind == "count" else bootstrap_interval(sample, n, sample.error())


def defined_values(values: ArrayLike, problems: Labels | None, worlds: Labels | None) -> tuple[FloatArray, Clusters]:
    """Return the values that are numbers, and these by problem."""
    every = np.asarray(values, dtype=np.float64)
    there = np.flatnonzero(np.isfinite(every))
    labels = (None if of is None else [of[int(i)] for i in there] for of in (problems, worlds))
    return every[there], make_clusters(every[there], *labels)


def design_effect(values: FloatArray, sample: Clusters) -> float:
    """Return how many times the variance of a mean exceeds that of as many independent episodes: Kish's design effect,
    at least 1.

    Where all values are alike it cannot be known; then each problem counts once.
    """
    n = len(values)
    if not sample.repeated:
        return 1.0
    alone = float(values.var(ddof=1)) / n
    return max(1.0, sample.error() ** 2 / alone) if alone > 0.0 else n / sample.problems


def pivot_quantile(sample: Clusters) -> float:
    """Return the quantile of 0.975 of a pivot: normal for single episodes, of Student's t for
    problems that were repeated.
    """
    from scipy.special import ndtri, stdtrit

    return float(stdtrit(sample.freedom, 1.0 - TAIL) if sample.repeated else ndtri(1.0 - TAIL))


def _agresti_coull(values: FloatArray, sample: Clusters) -> Estimate:
    """Return the interval of a proportion after Agresti and Coull (1998), about Wilson's centre and never narrower than
    his.

    Repeated problems count as the number of independent episodes that would be as sure (Korn and Graubard 1998).
    """
    n, z = len(values) / design_effect(values, sample), pivot_quantile(sample)
    mean, wider = float(values.mean()), n + z**2
    centre = (mean * n + z**2 / 2.0) / wider
    half = z * math.sqrt(centre * (1.0 - centre) / wider)
    return Estimate(
        mean, max(0.0, centre - half), min(1.0, centre + half), len(values), "Agresti-Coull", sample.problems
    )


def _garwood_interval(values: FloatArray, sample: Clusters) -> Estimate:
    """Return the exact interval of a Poisson mean (Garwood 1936), for the number of events that would be as sure if
    they came singly.

    Events that come in bunches, in an episode or a problem, count as fewer: divided by their variance over their mean,
    where that is more than 1, which is itself an estimate (Student's t). Unlike a bootstrap it says something when
    there was no event at all.
    """
    from scipy.special import ndtri, stdtrit
    from scipy.stats import chi2

    n, mean = len(values), float(values.mean())
    bunched = max(1.0, float(values.var(ddof=1)) / mean if mean > 0.0 else 1.0) * design_effect(values, sample)
    if bunched > 1.0:
        bunched *= (stdtrit(sample.freedom, TAIL) / ndtri(TAIL)) ** 2
    events, per_event = n * mean / bunched, bunched / n
    low = 0.5 * float(chi2.ppf(TAIL, 2.0 * events)) if events > 0.0 else 0.0
    high = 0.5 * float(chi2.ppf(1.0 - TAIL, 2.0 * (events + 1.0)))
    return Estimate(mean, per_event * low, per_event * high, n, "Garwood", sample.problems)


def bootstrap_interval(sample: Clusters, n: int, error: float) -> Estimate:
    """Return the studentised bootstrap interval of a mean (Hall 1988), on each side at least as wide as Student's t
    makes it.

    ``error`` is the sample's own, or a greater one that Student's t then goes by.
    """
    from scipy.special import stdtrit

    mean, half = sample.mean, float(stdtrit(sample.freedom, 1.0 - TAIL)) * error
    if sample.problems > MOST_RESAMPLED or no_scatter(sample, sample.error()):
        return Estimate(mean, mean - half, mean + half, n, "Student's t", sample.problems)
    under, over = np.quantile(sample.pivots(), (TAIL, 1.0 - TAIL)) * sample.error()
    return Estimate(
        mean,
        mean - max(float(over), half),
        mean + max(-float(under), half),
        n,
        "studentised bootstrap",
        sample.problems,
    )


def no_scatter(sample: Clusters, error: float) -> bool:
    """Return whether all problems have the same figure, but for rounding."""
    return error <= 1e-12 * abs(sample.mean)
