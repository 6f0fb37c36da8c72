"""The pack ``barn``: success, time and score of the BARN challenge, judged on the truth as its
run.py does (docs/barn.md).
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from arena_core import ConfigurationError, EpisodeRecord, Metric, MetricPack
from arena_core.parameters import Positive
from arena_metrics.packs.bounds import with_bounds


class BarnMetrics(MetricPack):
    """BARN's figures. The optimal time is the reference path's, or the straight line's where the scenario has none."""

    def __init__(
        self, moved: Positive, arrival: Positive, reference_speed: Positive, fastest: Positive, slowest: Positive
    ) -> None:
        if fastest > slowest:
            raise ConfigurationError(f"metrics.barn.fastest is {fastest:g}; allowed: up to slowest, {slowest:g}")
        self._moved, self._arrival = moved, arrival
        self._reference_speed = reference_speed
        self._fastest, self._slowest = fastest, slowest

    def metrics(self) -> Sequence[Metric]:
        """Return success, score and the times they come from."""
        metrics = [
            Metric("success", "0/1", "higher", "goal truly reached in time, before any contact", self.success),
            Metric("score", "-", "higher", "success x optimal time / time within 2 to 8 optimal times", self.score),
            Metric("time", "s", "lower", "from the first 0.1 m to the arrival", self.time),
            Metric("optimal_time", "s", "neither", "reference path at full speed", self.optimal_time),
        ]
        return with_bounds(metrics, shares=("score",))

    def success(self, record: EpisodeRecord) -> float:
        """Return 1 for an arrival in time and before any contact, else 0."""
        return float(math.isfinite(self.time(record)))

    def score(self, record: EpisodeRecord) -> float:
        """Return the score of one run, 0 for a failure."""
        time = self.time(record)
        return float(
            barn_score(time, self.optimal_time(record), self._fastest, self._slowest, success=math.isfinite(time))
        )

    def time(self, record: EpisodeRecord) -> float:
        """Return the time from the first ``moved`` m to the arrival, s; NaN unless that was in
        time and before any contact.
        """
        scenario, stamps = record.meta["scenario"], record["stamp"]
        moving = _first_row(_place_distances(record, scenario["start"]) >= self._moved)
        arrived = _first_row(_place_distances(record, scenario["goal"]) <= self._arrival)
        if moving is None or arrived is None:
            return math.nan
        contacts = record["contact_stamp"]
        time = float(stamps[arrived] - stamps[moving])
        touched = len(contacts) > 0 and contacts.min() <= stamps[arrived]
        return math.nan if touched or time >= scenario["time_limit"] else time

    def optimal_time(self, record: EpisodeRecord) -> float:
        """Return the time that the reference path takes at ``reference_speed``, s."""
        scenario = record.meta["scenario"]
        length = scenario.get("reference_length")
        if length is None:
            length = math.dist(scenario["start"][:2], scenario["goal"][:2])
        return float(length) / self._reference_speed


def barn_score(time: float, optimal_time: float, fastest: float, slowest: float, *, success: bool) -> float:
    """Return success x optimal time / time, the time held within ``fastest`` .. ``slowest`` optimal times."""
    if not success:
        return 0.0
    return optimal_time / min(max(time, fastest * optimal_time), slowest * optimal_time)


def _place_distances(record: EpisodeRecord, place: Sequence[float]) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    """Return the true distance to a place in every row, (T,), m."""
    return np.hypot(record["pose"][:, 0] - place[0], record["pose"][:, 1] - place[1])


def _first_row(rows: np.ndarray[tuple[int], np.dtype[np.bool_]]) -> int | None:
    return int(np.argmax(rows)) if rows.any() else None
