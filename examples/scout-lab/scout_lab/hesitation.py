"""Metrics of a robot that does not make up its mind: it stops on its way, or turns from one side to the other."""

from __future__ import annotations

import numpy as np

from arena_core import EpisodeRecord, Metric, MetricPack
from arena_core.parameters import Positive


class HesitationMetrics(MetricPack):
    """Stops, their share of the time, and changes of the side that the robot turns to."""

    def __init__(self, standing: Positive, turning: Positive) -> None:
        self.standing, self.turning = standing, turning

    def metrics(self) -> list[Metric]:
        """Return the metrics in the order of their columns."""
        slow = f"below {self.standing:g} m/s"
        return [
            Metric("stops", "1", "lower", f"stands ({slow}) that begin after the robot has moved", self.stops),
            Metric(
                "standing_share",
                "-",
                "lower",
                "share of the control steps after its first move in which it stands",
                self.share,
            ),
            Metric(
                "changes_of_side",
                "1/m",
                "lower",
                "how often the robot turns to the other side, by the way driven",
                self.changes,
            ),
        ]

    def stops(self, record: EpisodeRecord) -> float:
        """Return how many stands begin after the robot has first moved."""
        stands = self._stands(record)
        return float(np.count_nonzero(stands[1:] & ~stands[:-1]))

    def share(self, record: EpisodeRecord) -> float:
        """Return the share of steps that it stands, NaN if it never moves."""
        stands = self._stands(record)
        return float(stands.mean()) if len(stands) else float("nan")

    def changes(self, record: EpisodeRecord) -> float:
        """Return the changes from turning left to turning right and back, a metre; NaN if it never moves."""
        turns = record["twist"][:, 2]
        sides = np.sign(turns[np.abs(turns) >= self.turning])
        way = float(np.hypot(*np.diff(record["pose"][:, :2], axis=0).T).sum())
        return float(np.count_nonzero(np.diff(sides))) / way if way > 0.0 else float("nan")

    def _stands(self, record: EpisodeRecord) -> np.ndarray:
        speeds = np.hypot(record["twist"][:, 0], record["twist"][:, 1])
        moving = np.flatnonzero(speeds >= self.standing)
        return speeds[moving[0] :] < self.standing if len(moving) else np.zeros(0, bool)
