"""Plans, and what a robot can do within them."""

from __future__ import annotations

from typing import NamedTuple

from arena_mpc.arrays import FloatArray


class Plan(NamedTuple):
    """A solution: ``states`` (N + 1, 3 + velocities), the intervals' length ``step`` s, ``slack`` (N + 1,) m."""

    states: FloatArray
    step: float
    slack: FloatArray

    @property
    def duration(self) -> float:
        """Return how long the plan takes, s."""
        return (len(self.states) - 1) * self.step


class Room(NamedTuple):
    """What velocities (U,) and accelerations (U,) are possible, the intervals' length, s, and a
    car's fastest turn, rad/s.
    """

    low: FloatArray
    high: FloatArray
    most: FloatArray
    step_low: float
    step_high: float
    turn: float


class Solution(NamedTuple):
    """What a solver found, None when that is nothing to drive, what it costs, and the iterations it took."""

    plan: Plan | None
    cost: float
    iterations: int
