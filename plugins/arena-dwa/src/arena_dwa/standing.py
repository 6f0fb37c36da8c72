"""How long a robot has got nowhere."""

from __future__ import annotations

from arena_core import Pose

STIRRED = 0.3  # m; who stays within is standing
GIVEN_BACK = 4.0  # s of waiting that every such move makes up for: who only shuffles to and fro goes on waiting
LONGEST = 3.0  # patiences; no longer wait is remembered


class Standing:
    """Counts the time in which a robot stands or shuffles about one place."""

    def __init__(self, patience: float | None) -> None:
        self._patience = patience
        self.clear()

    def clear(self) -> None:
        """Begin anew."""
        self._place: Pose | None = None
        self._stamp = self._waited = 0.0

    def too_long(self, pose: Pose, stamp: float) -> bool:
        """Take in where the robot is at ``stamp`` (s) and tell whether its patience (s; None: endless) is at an end."""
        if self._patience is None:
            return False
        if self._place is None:
            self._place, self._stamp = pose, stamp
        self._waited, self._stamp = self._waited + stamp - self._stamp, stamp
        if pose.distance(self._place) > STIRRED:
            self._place, self._waited = pose, self._waited - GIVEN_BACK
        self._waited = min(max(self._waited, 0.0), LONGEST * self._patience)
        return self._waited > self._patience
