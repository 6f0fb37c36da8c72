"""The oscillation critic: after a change of direction, the new direction only, until the robot has moved on."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from arena_core import Pose, Twist
from arena_dwa.parameters import OscillationParameters
from arena_kernels.compiled import borrowing

FORWARD, LEFT, TURN = 0, 1, 2


@borrowing
def is_oscillating(only: NDArray[np.int8], vx: float, vy: float, wz: float) -> bool:
    """Return whether a sample runs against a flag: ``only`` (3,) holds for vx, vy, wz the one sign allowed, or 0."""
    return bool(vx * only[FORWARD] < 0.0 or vy * only[LEFT] < 0.0 or wz * only[TURN] < 0.0)


class OscillationFlags:
    """Flags as ROS's oscillation critic keeps them: a reversal forbids the old direction until the robot moved or
    turned far enough.

    After ``reset_time`` s (None: never, as in ROS) they fall as well: a robot that waits would else never turn back.
    """

    def __init__(self, resets: OscillationParameters, still_below: float) -> None:
        self._resets = resets
        self._reset_time = math.inf if resets.reset_time is None else resets.reset_time
        self._still_below = still_below
        self.clear()

    def clear(self) -> None:
        """Forget all directions."""
        self.only = np.zeros(3, np.int8)
        self._driven = np.zeros(3, np.int8)
        self._flagged: tuple[float, Pose] | None = None

    def record_command(self, stamp: float, pose: Pose, command: Twist) -> None:
        """Take in the command chosen at ``stamp`` s and ``pose``: raise flags at a reversal, drop them when
        they have done their work.
        """
        self._record_direction(FORWARD, command.vx, stamp, pose)
        if abs(command.vx) <= self._still_below:
            self._record_direction(LEFT, command.vy, stamp, pose)
            self._record_direction(TURN, command.wz, stamp, pose)
        if self._flagged is not None and self._is_over(*self._flagged, stamp, pose):
            self.clear()

    def _record_direction(self, axis: int, speed: float, stamp: float, pose: Pose) -> None:
        sign = int(np.sign(speed))
        if sign and self._driven[axis] == -sign:
            self.only[axis] = sign
            self._flagged = (stamp, pose)
        if sign:
            self._driven[axis] = sign

    def _is_over(self, began: float, where: Pose, stamp: float, pose: Pose) -> bool:
        turned = abs(where.relative(pose).theta)
        return (
            where.distance(pose) > self._resets.reset_dist
            or turned > self._resets.reset_angle
            or stamp - began > self._reset_time
        )
