"""All tracks at one instant, and how their number changes: birth, joining, leaving."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from arena_navigation.tracking.discs import Discs


class Belief(NamedTuple):
    """N tracks in ``map``: ids (N,), states (N, 4) x, y, vx, vy, covariances (N, 4, 4), radii and their variances (N,).

    ``hits`` counts the scans that showed it, ``misses`` those since the last hit that should have; ``born_at`` and ``seen_at`` are the
    stamps of the first and the last hit.
    """

    ids: NDArray[np.int32]
    states: NDArray[np.float64]
    covariances: NDArray[np.float64]
    radii: NDArray[np.float64]
    radius_variances: NDArray[np.float64]
    hits: NDArray[np.int64]
    misses: NDArray[np.int64]
    born_at: NDArray[np.float64]
    seen_at: NDArray[np.float64]

    @staticmethod
    def none() -> Belief:
        """Return no tracks."""
        none, whole = np.empty(0), np.empty(0, np.int64)
        return Belief(np.empty(0, np.int32), np.empty((0, 4)), np.empty((0, 4, 4)), none, none, whole, whole, none, none)

    def where(self, keep: NDArray[np.bool_]) -> Belief:
        """Return copies of some of the tracks."""
        return Belief._make(values[keep] for values in self)

    def with_born(self, discs: Discs, chosen: NDArray[np.int64], first_id: int, speed_stds: NDArray[np.float64], stamp: float) -> Belief:
        """Return all tracks and a new one for each of C chosen discs, resting but for ``speed_stds`` (C,) m/s."""
        count = len(chosen)
        if not count:
            return self
        states, covariances = np.zeros((count, 4)), np.zeros((count, 4, 4))
        states[:, :2] = discs.positions[chosen]
        covariances[:, :2, :2] = discs.covariances[chosen]
        covariances[:, 2, 2] = covariances[:, 3, 3] = speed_stds**2
        born = Belief(
            np.arange(first_id, first_id + count, dtype=np.int32),
            states,
            covariances,
            discs.radii[chosen],
            discs.radius_variances[chosen],
            np.ones(count, np.int64),
            np.zeros(count, np.int64),
            np.full(count, stamp),
            np.full(count, stamp),
        )
        return Belief._make(_joined(old, new) for old, new in zip(self, born, strict=True))


def _joined(old: Any, new: Any) -> NDArray[Any]:
    return np.concatenate((old, new))
