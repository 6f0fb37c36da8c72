"""The pack ``human``: a robot beside the recorded person whose place it took."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arena_core import EpisodeRecord, Metric, MetricPack
from arena_core.parameters import Positive
from arena_metrics.packs.bounds import with_bounds

Floats = NDArray[np.float64]


class Walk(NamedTuple):
    """Where the person was: ``places`` (K, 2) m at ``stamps`` (K,) s."""

    stamps: Floats
    places: Floats


class HumanMetrics(MetricPack):
    """Differences between a robot and the person whom it replaced; empty in other tasks.

    ``near`` m is the distance between two centres below which one intrudes on the other.
    """

    def __init__(self, near: Positive) -> None:
        self._near = near

    def metrics(self) -> Sequence[Metric]:
        """Return displacement errors, and what was more than the person's own."""
        metrics = [
            Metric("ade", "m", "lower", "mean distance from the person, over the person's time", self.ade),
            Metric("fde", "m", "lower", "distance from where the person was when they vanished, then", self.fde),
            Metric("extra_time", "s", "lower", "the robot's time to the goal less the person's", self.extra_time),
            Metric("extra_path", "m", "lower", "the robot's way less the person's", self.extra_path),
            Metric(
                "extra_intrusion", "m s", "lower", "intrusion on the others, less the person's", self.extra_intrusion
            ),
        ]
        return with_bounds(metrics, signed=("extra_time", "extra_path", "extra_intrusion"))

    def ade(self, record: EpisodeRecord) -> float:
        """Return the mean distance between robot and person in the person's time; a robot that has ended stays."""
        return _with_walk(record, lambda walk: float(_distances(record, walk).mean()))

    def fde(self, record: EpisodeRecord) -> float:
        """Return how far the robot was, when the person vanished, from where that was."""
        return _with_walk(record, lambda walk: float(_distances(record, walk)[-1]))

    def extra_time(self, record: EpisodeRecord) -> float:
        """Return how much longer than the person a robot took that arrived; NaN for others."""
        if record.meta["outcome"] != "goal_reached":
            return math.nan
        return _with_walk(record, lambda walk: float(record["stamp"][-1] - walk.stamps[-1]))

    def extra_path(self, record: EpisodeRecord) -> float:
        """Return how much longer than the person's way the robot's was."""
        return _with_walk(record, lambda walk: _length(record["pose"][:, :2]) - _length(walk.places))

    def extra_intrusion(self, record: EpisodeRecord) -> float:
        """Return the integral of the sum of ``near`` less distance over the others who are nearer, less that of the
        person, each over its own time.

        The others of the person's time are those of the record, as far as that lasts.
        """
        stamps = record["stamp"]

        def intrusion(places: Floats, rows: NDArray[np.bool_]) -> float:
            away = np.hypot(*(record["pedestrian_positions"][rows] - places[:, None]).transpose(2, 0, 1))
            return float(np.trapezoid(np.nansum(np.clip(self._near - away, 0.0, None), axis=1), stamps[rows]))

        def extra(walk: Walk) -> float:
            there = stamps <= walk.stamps[-1]
            return intrusion(record["pose"][:, :2], np.ones_like(there)) - intrusion(_at(walk, stamps[there]), there)

        return _with_walk(record, extra)


def _with_walk(record: EpisodeRecord, value: Callable[[Walk], float]) -> float:
    """Return a value of the person's walk, NaN where the robot replaced nobody."""
    said = record.meta["scenario"].get("replaces")
    return math.nan if said is None else value(Walk(np.array(said["stamps"]), np.array(said["positions"])))


def _distances(record: EpisodeRecord, walk: Walk) -> Floats:
    """Return the distance between robot and person at the person's stamps, (K,) m."""
    robot = np.stack([np.interp(walk.stamps, record["stamp"], record["pose"][:, axis]) for axis in (0, 1)], axis=1)
    return np.asarray(np.hypot(*(robot - walk.places).T))


def _at(walk: Walk, stamps: Floats) -> Floats:
    return np.stack([np.interp(stamps, walk.stamps, walk.places[:, axis]) for axis in (0, 1)], axis=1)


def _length(places: Floats) -> float:
    return float(np.hypot(*np.diff(places, axis=0).T).sum())
