"""Where tracked obstacles will be: what a predictor says, at any time ahead."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from arena_core.values.geometry import FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class Predictions:
    """Where each of K tracks is expected, in ``map``, in their order; between two times in a straight line.

    ``times`` (H,), s from now, rise from 0. ``means`` (K, H, 2) m are the most probable places and ``covariances`` (K,
    H, 2, 2) m^2 how sure they are. After the last time each goes on at its ``velocities`` (K, 2) m/s; ``spreads`` (K,
    4, 4) are covariances over x, y, vx, vy then. A model with several hypotheses has them as ``alternatives`` (M, K, H,
    2) with their ``weights`` (M, K), which add up to 1 for each track; M is 0 where there are none.
    """

    times: FloatArray
    means: FloatArray
    covariances: FloatArray
    velocities: FloatArray
    spreads: FloatArray
    alternatives: FloatArray
    weights: FloatArray

    @classmethod
    def straight(cls, positions: FloatArray, velocities: FloatArray, covariances: FloatArray) -> Predictions:
        """Return what is expected of those who keep their velocity; covariances (K, 4, 4) as those of tracks."""
        count = len(positions)
        return cls(
            np.zeros(1),
            positions[:, None],
            covariances[:, None, :2, :2],
            velocities,
            covariances,
            np.empty((0, count, 1, 2)),
            np.empty((0, count)),
        )

    @classmethod
    def of(
        cls,
        times: FloatArray,
        means: FloatArray,
        covariances: FloatArray,
        velocities: FloatArray | None = None,
        several: tuple[FloatArray, FloatArray] | None = None,
    ) -> Predictions:
        """Return predictions at H > 1 times, after which each goes on at ``velocities``, those of the last leg where
        they are not given, as unsure as it then is; ``several`` are alternatives and their weights.
        """
        count, steps = means.shape[:2]
        spreads = np.zeros((count, 4, 4))
        spreads[:, :2, :2] = covariances[:, -1]
        onwards = (means[:, -1] - means[:, -2]) / (times[-1] - times[-2]) if velocities is None else velocities
        alternatives, weights = several or (np.empty((0, count, steps, 2)), np.empty((0, count)))
        return cls(times, means, covariances, onwards, spreads, alternatives, weights)

    def legs(self) -> FloatArray:
        """Return the velocity from each time to the next one, the last for good, (K, H, 2) m/s."""
        if len(self.times) == 1:
            return self.velocities[:, None]
        between = np.diff(self.means, axis=1) / np.diff(self.times)[:, None]
        return np.concatenate((between, self.velocities[:, None]), axis=1)

    def at(self, times: ArrayLike) -> FloatArray:
        """Return the places at ``times`` (T,), s from now, (K, T, 2) m."""
        asked = np.asarray(times, np.float64)
        leg = self._leg(asked)
        since: FloatArray = (asked - self.times[leg])[:, None]
        places: FloatArray = self.means[:, leg] + self.legs()[:, leg] * since
        return places

    def deviations(self, times: ArrayLike) -> FloatArray:
        """Return how unsure the places at ``times`` (T,) are, standard deviations along an axis, (K, T) m."""
        asked = np.asarray(times, np.float64)
        after = np.maximum(asked - self.times[-1], 0.0)
        place, both, speed = (_half_trace(self.spreads[:, i : i + 2, j : j + 2]) for i, j in ((0, 0), (0, 2), (2, 2)))
        later = place[:, None] + 2.0 * after * both[:, None] + after**2 * speed[:, None]
        if len(self.times) > 1:
            known = _half_trace(self.covariances)
            before = np.array([np.interp(asked, self.times, row) for row in known]).reshape(len(known), len(asked))
            later = np.where(asked > self.times[-1], later, before)
        return np.asarray(np.sqrt(np.maximum(later, 0.0)))

    def mean_velocities(self, times: FloatArray) -> FloatArray:
        """Return with which velocity each comes to where it is expected in ``times`` (K,) s, > 0: (K, 2) m/s."""
        if len(self.times) == 1:
            return self.velocities
        each = np.arange(len(times))
        way: FloatArray = (self.at(times)[each, each] - self.means[:, 0]) / times[:, None]
        return way

    def top_speeds(self) -> FloatArray:
        """Return how fast each is expected to be at most, (K,) m/s."""
        legs = self.legs()
        return np.asarray(np.hypot(legs[..., 0], legs[..., 1]).max(axis=1))

    def take(self, rows: NDArray[np.int64] | NDArray[np.bool_]) -> Predictions:
        """Return the predictions of these tracks."""
        first = ("alternatives", "weights")
        own = {f.name: getattr(self, f.name) for f in fields(self) if f.name != "times"}
        return replace(self, **{name: each[:, rows] if name in first else each[rows] for name, each in own.items()})

    def seen_from(self, x: float, y: float) -> Predictions:
        """Return them with places counted from (x, y)."""
        here = (x, y)
        return replace(self, means=self.means - here, alternatives=self.alternatives - here)

    def _leg(self, times: FloatArray) -> NDArray[np.intp]:
        """Return which leg each time falls into."""
        return np.maximum(np.searchsorted(self.times, times, "right") - 1, 0)


def _half_trace(covariances: FloatArray) -> FloatArray:
    """Return the mean variance of (..., 2, 2) along an axis."""
    return np.asarray(np.trace(covariances, axis1=-2, axis2=-1) / 2.0)
