"""Patience: a robot that has got nowhere for long contents itself with less room than it would like."""

from __future__ import annotations

import math

from arena_core import Pose
from arena_kernels.stuck_timer import StuckTimer

LEAST = 0.05  # part of the wish for room that always stays
LONGEST = 1.0 - math.log(LEAST)  # patiences; standing beyond that changes nothing


class StuckDetector:
    """Counts the time in which the robot has stood, or shuffled about one place."""

    def __init__(self, lasts: float | None) -> None:
        self._lasts = lasts
        self._stood = StuckTimer(LONGEST * (lasts or 0.0))

    def clear(self) -> None:
        """Begin as patient as can be."""
        self._stood.clear()

    def clearance_scale(self, pose: Pose, stamp: float) -> float:
        """Return how much of the wish for room is left, 1 at first; it falls to 1/e in every ``lasts`` s
        beyond the first so many.
        """
        if self._lasts is None:
            return 1.0
        beyond = max(0.0, self._stood.update(pose.x, pose.y, stamp) - self._lasts)
        return max(LEAST, math.exp(-beyond / self._lasts))
