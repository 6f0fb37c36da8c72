"""Episodes by problem: their sums, the error of their mean, and resamples that draw whole problems within their worlds.

Repeats of one problem are no independent trials, so what counts is the problem (Efron and Tibshirani 1993, section 8.6;
Cameron, Gelbach and Miller 2008). A mean over all episodes is a ratio, the sum of the problems' sums over that of their
episodes; its error is that of the linearised ratio (Cochran 1977, section 6.4).
"""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from arena_core.base.random_streams import random_generator

FloatArray = NDArray[np.float64]

RESAMPLES = 5000  # Efron and Tibshirani 1993, section 14.3, ask for 1000 or more
MOST_RESAMPLED = 200  # problems; with more of them Student's t covers as well (docs/report.md)
LEAST_ERROR = 0.35  # of the error of the sample, in a resample that drew next to no scatter


@dataclass(frozen=True, slots=True, eq=False)
class Clusters:
    """Sums of values and numbers of episodes of each problem, (P,); problems of one world stand together.

    ``worlds`` are the numbers of problems of each world. Worlds of a single problem count as one world together.
    """

    sums: FloatArray
    sizes: FloatArray
    worlds: tuple[int, ...]

    @property
    def mean(self) -> float:
        """Return the mean over all episodes."""
        return float(self.sums.sum() / self.sizes.sum())

    @property
    def problems(self) -> int:
        """Return the number of problems."""
        return len(self.sums)

    @property
    def freedom(self) -> int:
        """Return the degrees of freedom that the error of the mean has."""
        return self.problems - len(self.worlds)

    @property
    def repeated(self) -> bool:
        """Return whether some problem was run more than once."""
        return bool((self.sizes > 1.0).any())

    def error(self) -> float:
        """Return the standard error of the mean."""
        return float(_of_resamples(np.ones((1, self.problems)), self)[1][0])

    def pivots(self) -> FloatArray:
        """Return how far each resample's mean lies from the sample's, in its own standard errors, (RESAMPLES,)."""
        weights = resample_counts(self.worlds)
        means, errors = _of_resamples(weights, self)
        found: FloatArray = (means - self.mean) / np.maximum(errors, LEAST_ERROR * self.error())
        return found


def make_clusters(
    values: FloatArray, problems: Sequence[Hashable] | None, worlds: Sequence[Hashable] | None
) -> Clusters:
    """Sum values (N,) by problem; without ``problems`` each value is one of its own, without
    ``worlds`` all lie in one.
    """
    keys = list(range(len(values))) if problems is None else list(problems)
    within = [0] * len(values) if worlds is None else list(worlds)
    order: dict[Hashable, dict[Hashable, list[float]]] = {}
    for value, key, world in zip(values, keys, within, strict=True):
        order.setdefault(world, {}).setdefault(key, []).append(float(value))
    several = [list(found.values()) for found in order.values() if len(found) > 1]
    single = [group for found in order.values() if len(found) == 1 for group in found.values()]
    if len(single) == 1 and several:  # one alone has no scatter
        several[-1] += single
        single = []
    strata = [*several, *([single] if single else [])]
    groups = [group for stratum in strata for group in stratum]
    sums, sizes = np.array([sum(group) for group in groups]), np.array([float(len(group)) for group in groups])
    return Clusters(sums, sizes, tuple(len(stratum) for stratum in strata))


def _of_resamples(weights: FloatArray, sample: Clusters) -> tuple[FloatArray, FloatArray]:
    """Return mean and standard error of each resample, (R,), for its numbers of draws of every problem, (R, P)."""
    s, m = sample.sums - sample.mean * sample.sizes, sample.sizes  # centred, so that squares do not lose digits
    products = np.stack((s, m, s * s, s * m, m * m), axis=1)
    parts = [(part, weights[:, part] @ products[part]) for part in _world_slices(sample.worlds)]
    total: FloatArray = np.sum([of for _, of in parts], axis=0)
    shift = total[:, 0] / total[:, 1]
    variance = np.zeros(len(weights))
    for part, of in parts:
        n = part.stop - part.start
        squares = of[:, 2] - 2.0 * shift * of[:, 3] + shift**2 * of[:, 4]
        variance += n / max(n - 1, 1) * np.maximum(squares - (of[:, 0] - shift * of[:, 1]) ** 2 / n, 0.0)
    return sample.mean + shift, np.sqrt(variance) / total[:, 1]


def _world_slices(worlds: tuple[int, ...]) -> Iterator[slice]:
    first = 0
    for count in worlds:
        yield slice(first, first + count)
        first += count


@lru_cache(maxsize=16)
def resample_counts(worlds: tuple[int, ...]) -> FloatArray:
    """Return how often each resample draws every problem, (RESAMPLES, P); as many of each world as there are.

    A stream of its own for the same numbers of problems, so results do not depend on the order of calls.
    """
    random = random_generator(sum(worlds), "report", "bootstrap " + " ".join(map(str, worlds)))
    drawn = np.hstack([random.multinomial(n, np.full(n, 1.0 / n), size=RESAMPLES) for n in worlds]).astype(np.float64)
    drawn.flags.writeable = False
    return drawn
