"""Patience: a robot that has got nowhere for long contents itself with less room than it would like."""

from __future__ import annotations

import math

from arena_core import Pose

STIRRED = 0.3  # m; who stays within is standing
GIVEN_BACK = 4.0  # s of standing that every such move makes up for: who only shuffles to and fro goes on losing patience
LEAST = 0.05  # part of the wish for room that always stays
LONGEST = 1.0 - math.log(LEAST)  # patiences; standing beyond that changes nothing


class Patience:
    """Counts the time in which the robot has stood, or shuffled about one place."""

    def __init__(self, lasts: float | None) -> None:
        self._lasts = lasts
        self.clear()

    def clear(self) -> None:
        """Begin as patient as can be."""
        self._place: Pose | None = None
        self._stamp = self._stood = 0.0

    def left(self, pose: Pose, stamp: float) -> float:
        """Return how much of the wish for room is left, 1 at first; it falls to 1/e in every ``lasts`` s beyond the first so many."""
        if self._lasts is None:
            return 1.0
        if self._place is None:
            self._place, self._stamp = pose, stamp
        self._stood, self._stamp = self._stood + stamp - self._stamp, stamp
        if pose.distance(self._place) > STIRRED:
            self._place, self._stood = pose, self._stood - GIVEN_BACK
        self._stood = min(max(self._stood, 0.0), LONGEST * self._lasts)
        beyond = max(0.0, self._stood - self._lasts)
        return max(LEAST, math.exp(-beyond / self._lasts))
