"""How long a robot has got nowhere."""

from __future__ import annotations

import math

STIRRED = 0.3  # m; who stays within is standing
GIVEN_BACK = 4.0  # s of standing that every such move makes up for: who only shuffles to and fro goes on standing


class StuckTimer:
    """Counts the time in which a robot stands or shuffles about one place, up to ``longest`` s."""

    def __init__(self, longest: float) -> None:
        self._longest = longest
        self.clear()

    def clear(self) -> None:
        """Begin again."""
        self._place: tuple[float, float] | None = None
        self._stamp = self._stood = 0.0

    def update(self, x: float, y: float, stamp: float) -> float:
        """Take in where the robot is at ``stamp`` (s), m, and return how long it has stood, s."""
        if self._place is None:
            self._place, self._stamp = (x, y), stamp
        self._stood, self._stamp = self._stood + stamp - self._stamp, stamp
        if math.hypot(x - self._place[0], y - self._place[1]) > STIRRED:
            self._place, self._stood = (x, y), self._stood - GIVEN_BACK
        self._stood = min(max(self._stood, 0.0), self._longest)
        return self._stood
