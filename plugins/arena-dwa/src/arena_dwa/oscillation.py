"""The oscillation critic: after a change of direction, the new direction only, until the robot has moved on."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from arena_core import Pose, Twist

FORWARD, LEFT, TURN = 0, 1, 2


@njit(cache=True)
def oscillates(only: NDArray[np.int8], vx: float, vy: float, wz: float) -> bool:
    """Tell whether a sample runs against a flag: ``only`` (3,) holds for vx, vy, wz the one sign allowed, or 0."""
    return bool(vx * only[FORWARD] < 0.0 or vy * only[LEFT] < 0.0 or wz * only[TURN] < 0.0)


class OscillationFlags:
    """Flags as ROS's oscillation critic keeps them: a reversal forbids the old direction until the robot moved or turned far enough."""

    def __init__(self, reset_dist: float, reset_angle: float, still_below: float) -> None:
        self._reset_dist = reset_dist
        self._reset_angle = reset_angle
        self._still_below = still_below
        self.clear()

    def clear(self) -> None:
        """Forget all directions."""
        self.only = np.zeros(3, np.int8)
        self._driven = np.zeros(3, np.int8)
        self._flagged_at: Pose | None = None

    def note(self, pose: Pose, command: Twist) -> None:
        """Take in the command that was chosen at ``pose``: raise flags at a reversal, drop them once the robot is away."""
        self._turn_over(FORWARD, command.vx, pose)
        if abs(command.vx) <= self._still_below:
            self._turn_over(LEFT, command.vy, pose)
            self._turn_over(TURN, command.wz, pose)
        if self._flagged_at is not None and self._away(self._flagged_at, pose):
            self.clear()

    def _turn_over(self, axis: int, speed: float, pose: Pose) -> None:
        sign = int(np.sign(speed))
        if sign and self._driven[axis] == -sign:
            self.only[axis] = sign
            self._flagged_at = pose
        if sign:
            self._driven[axis] = sign

    def _away(self, flagged_at: Pose, pose: Pose) -> bool:
        turned = abs(flagged_at.relative(pose).theta)
        return flagged_at.distance(pose) > self._reset_dist or turned > self._reset_angle
