"""Whether a robot has got nowhere for too long."""

from __future__ import annotations

from arena_core import Pose
from arena_kernels.stuck_timer import StuckTimer

LONGEST = 3.0  # patiences; no longer wait is remembered


class StuckDetector:
    """Counts the time in which a robot stands or shuffles about one place."""

    def __init__(self, patience: float | None) -> None:
        self._patience = patience
        self._stood = StuckTimer(LONGEST * (patience or 0.0))

    def clear(self) -> None:
        """Begin again."""
        self._stood.clear()

    def is_stuck(self, pose: Pose, stamp: float) -> bool:
        """Take in where the robot is at ``stamp`` (s) and return whether its patience (s; None: endless) is over."""
        return self._patience is not None and self._stood.update(pose.x, pose.y, stamp) > self._patience
