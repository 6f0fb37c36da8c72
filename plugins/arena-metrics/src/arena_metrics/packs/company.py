"""The pack ``company``: how well a robot kept with the person whom it was to follow, accompany or lead."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from arena_core import EpisodeRecord, Metric, MetricPack
from arena_core.parameters import Positive
from arena_metrics.packs.bounds import with_bounds

Rows = NDArray[np.float64]


class CompanyMetrics(MetricPack):
    """Distances and times between a robot and its person, from the truth; empty where the task has no such person.

    ``side`` rad is how far from straight beside the person a robot may be that goes at its side; a person slower than
    ``slow`` m/s has no side.
    """

    def __init__(self, side: Positive, slow: Positive) -> None:
        self._side, self._slow = side, slow

    def metrics(self) -> Sequence[Metric]:
        """Return what was kept, how far the two were apart, and for how long."""
        metrics = [
            Metric("kept", "-", "higher", "share of the time together: nearest .. farthest m apart", self.kept),
            Metric("distance", "m", "neither", "mean distance between the centres", self.distance),
            Metric("apart", "s", "lower", "longest time farther apart than farthest", self.apart),
            Metric("too_near", "s", "lower", "time nearer than nearest", self.too_near),
            Metric(
                "beside", "-", "higher", "accompany: share of the person's walk with the robot at its side", self.beside
            ),
        ]
        return with_bounds(metrics, shares=("kept", "beside"))

    def kept(self, record: EpisodeRecord) -> float:
        """Return the share of the time for which robot and person were together."""
        return _of_distances(record, lambda away, near, far: _share(record, (away >= near) & (away <= far)))

    def distance(self, record: EpisodeRecord) -> float:
        """Return the mean distance between their centres, m."""
        return _of_distances(record, lambda away, near, far: float(np.nanmean(away)))

    def apart(self, record: EpisodeRecord) -> float:
        """Return the longest time for which they were farther apart than together, s."""
        return _of_distances(record, lambda away, near, far: _longest(record["stamp"], away > far))

    def too_near(self, record: EpisodeRecord) -> float:
        """Return the time for which they were nearer than together, s."""
        return _of_distances(
            record, lambda away, near, far: _share(record, away < near) * float(np.ptp(record["stamp"]))
        )

    def beside(self, record: EpisodeRecord) -> float:
        """Return the share of the person's walk for which the robot was at its side; NaN unless it accompanies."""
        slot = _slot(record)
        if slot is None or record.meta["scenario"]["company"]["manner"] != "accompany":
            return math.nan
        velocity = record["pedestrian_velocities"][:, slot]
        offset = record["pose"][:, :2] - record["pedestrian_positions"][:, slot]
        walks = np.hypot(*velocity.T) >= self._slow
        across = np.abs(velocity[:, 0] * offset[:, 1] - velocity[:, 1] * offset[:, 0])
        along = np.abs((velocity * offset).sum(axis=1))
        return float((np.arctan2(along, across) <= self._side)[walks].mean()) if walks.any() else math.nan


def _of_distances(record: EpisodeRecord, value: Callable[[Rows, float, float], float]) -> float:
    """Return a value of the distances (T,) between robot and person, and of those within which they are together; NaN
    without a person to keep with, or one who was never there.
    """
    slot = _slot(record)
    if slot is None:
        return math.nan
    away = np.hypot(*(record["pedestrian_positions"][:, slot] - record["pose"][:, :2]).T)
    company = record.meta["scenario"]["company"]
    return value(away, company["nearest"], company["farthest"]) if np.isfinite(away).any() else math.nan


def _slot(record: EpisodeRecord) -> int | None:
    company = record.meta["scenario"].get("company")
    slots = np.flatnonzero(record["pedestrian_ids"] == company["person"]).tolist() if company else []
    return int(slots[0]) if slots else None


def _share(record: EpisodeRecord, held: NDArray[np.bool_]) -> float:
    """Return the share of the time for which something held (trapezoidal over the control steps)."""
    stamps, whole = record["stamp"], float(np.ptp(record["stamp"]))
    return float(np.trapezoid(held.astype(np.float64), stamps)) / whole if whole > 0.0 else float(held.mean())


def _longest(stamps: Rows, held: NDArray[np.bool_]) -> float:
    """Return the longest time from a row at which something held to the last one in a row, s."""
    edges = np.diff(np.concatenate(((0,), held.astype(np.int8), (0,))))
    first, last = np.flatnonzero(edges == 1), np.flatnonzero(edges == -1) - 1
    return float((stamps[last] - stamps[first]).max(initial=0.0))
