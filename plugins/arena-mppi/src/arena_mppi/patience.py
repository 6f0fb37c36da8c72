"""Patience: a robot that has stood for long contents itself with less room than it would like."""

from __future__ import annotations

import math

from arena_core import Pose

STIRRED = 0.3  # m; less is standing
LEAST = 0.05  # part of the wish for room that always stays


class Patience:
    """Remembers since when the robot has stood."""

    def __init__(self, lasts: float | None) -> None:
        self._lasts = lasts
        self.clear()

    def clear(self) -> None:
        """Begin as patient as can be."""
        self._place: Pose | None = None
        self._since = 0.0

    def left(self, pose: Pose, stamp: float) -> float:
        """Return how much of the wish for room is left, 1 at first; it falls to 1/e in every ``lasts`` s beyond the first so many."""
        if self._lasts is None:
            return 1.0
        if self._place is None or pose.distance(self._place) > STIRRED:
            self._place, self._since = pose, stamp
        beyond = max(0.0, stamp - self._since - self._lasts)
        return max(LEAST, math.exp(-beyond / self._lasts))
