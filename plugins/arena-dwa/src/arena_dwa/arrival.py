"""Turning to the goal's heading where the path ends, as ROS's latched stop-and-rotate controller does."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from arena_core import Pose, wrap_angle
from arena_dwa.columns import VX, VY, WZ, X, Y
from arena_dwa.parameters import GoalParameters
from arena_dwa.settings import FloatArray, Limits

STOPPED = 0.1  # m/s and rad/s; slower counts as standing (ROS: trans_stopped_vel, theta_stopped_vel)


class Arrival:
    """Brakes nearer to the path's end than ``xy_tolerance`` m (None: never), and turns on the spot to the goal's
    heading.

    Once so near it stays with the turn, with ``latch_xy_tolerance``, though it may slip away again, until there is a
    new path.
    """

    def __init__(self, goal: GoalParameters, limits: Limits) -> None:
        self._goal = goal
        self._limits = limits
        self.clear()

    def clear(self) -> None:
        """Begin away from any goal."""
        self._path: FloatArray | None = None
        self._there = self._turning = False

    def target_velocity(
        self, pose: Pose, twist: NDArray[np.float64], path: FloatArray, heading: float, lapse: float
    ) -> FloatArray | None:
        """Return the velocity (3,) that stops or turns, None while the path (M, 3) is still to be driven.

        ``twist`` (3,) is the measured velocity, ``heading`` (rad) the goal's, ``lapse`` (s) the time in which speeds
        can change.
        """
        if not self._has_arrived(pose, path):
            self._turning = False
            return None
        left = float(wrap_angle(heading - pose.theta))
        if abs(left) <= self._goal.yaw_tolerance:
            return np.zeros(3)
        still = math.hypot(twist[VX], twist[VY]) <= STOPPED and abs(twist[WZ]) <= STOPPED
        self._turning = self._turning or still
        return (
            self._turn_velocity(left, float(twist[WZ]), lapse) if self._turning else self._brake_velocity(twist, lapse)
        )

    def _has_arrived(self, pose: Pose, path: FloatArray) -> bool:
        if self._goal.xy_tolerance is None:
            return False
        if path is not self._path:  # a new plan ends the latch, as move_base's do
            self._path, self._there = path, False
        end = Pose(float(path[-1, X]), float(path[-1, Y]))
        self._there = (self._there and self._goal.latch_xy_tolerance) or pose.distance(end) <= self._goal.xy_tolerance
        return self._there

    def _brake_velocity(self, twist: NDArray[np.float64], lapse: float) -> FloatArray:
        limits = self._limits
        slower = np.array((limits.ax_max, limits.ay_max, limits.alpha_max)) * lapse
        return np.copysign(np.maximum(np.abs(twist) - slower, 0.0), twist)

    def _turn_velocity(self, left: float, wz: float, lapse: float) -> FloatArray:
        """Return a turn by ``left`` (rad): no faster than it could be braked, no slower than ``theta_min``."""
        limits = self._limits
        reached = min(max(abs(left), abs(wz) - limits.alpha_max * lapse), abs(wz) + limits.alpha_max * lapse)
        stoppable = min(reached, math.sqrt(2.0 * limits.alpha_max * abs(left)))
        speed = min(max(stoppable, limits.theta_min), limits.wz_max)
        return np.array((0.0, 0.0, math.copysign(speed, left)))
