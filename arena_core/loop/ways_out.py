"""Which behaviours bring a robot off what it leans on, one after another."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

Behaviour = Literal["clear", "clear_far", "detour", "wait", "turn", "back_up", "drive_on"]
Way = tuple[Behaviour, bool]  # a behaviour, and whether it is to free the robot from what it does not see
MOVING = ("back_up", "drive_on", "turn")  # behaviours that bring a robot off what it leans on
_AGAIN = 1.0  # s after which all that have failed are tried again; each further time twice as long


class WaysOut:
    """Keeps which behaviours have failed where the robot leans, and returns the next one.

    ``possible`` are those that the robot's rules list and it can do.
    """

    def __init__(self, possible: Sequence[Behaviour]) -> None:
        self.listed = [behaviour for behaviour in possible if behaviour in MOVING]
        self._leaned = 0
        self.restart()

    def restart(self) -> None:
        """Take in that the robot has got away: nothing has failed where it is now."""
        self._failed: list[Way] = []
        self._rounds = 0

    def fail(self, behaviour: Behaviour, *, frees: bool) -> None:
        """Take in that a behaviour has moved nothing."""
        if (behaviour, frees) not in self._failed:
            self._failed.append((behaviour, frees))

    @property
    def last(self) -> Behaviour | None:
        """Return what failed last, None where nothing has."""
        return self._failed[-1][0] if self._failed else None

    def choose(self, opposite: Behaviour | None = None) -> Way | None:
        """Return the first that has not failed: ``opposite``, off what holds the robot unseen; then, as off what the
        local map shows, each that is listed, in turn, and ``drive_on``; at last straight on, and straight back where
        that is listed. None where all have.
        """
        first = self._leaned % len(self.listed)
        ways: list[Way] = [(way, False) for way in (*self.listed[first:], *self.listed[:first], "drive_on")]
        straight: list[Behaviour] = ["drive_on", "back_up"]
        ways += [(way, True) for way in straight if way == "drive_on" or way in self.listed]
        if opposite is not None:
            ways[:0] = [] if any(way == opposite for way, _ in self._failed) else [(opposite, True)]
        else:
            self._leaned += 1
        return next((way for way in ways if way not in self._failed), None)

    def begin_again(self) -> float:
        """Forget what has failed, as all has; return for how long to leave the robot alone first, s."""
        self._failed = []
        self._rounds = min(self._rounds + 1, 8)
        return _AGAIN * 2.0 ** (self._rounds - 1)
