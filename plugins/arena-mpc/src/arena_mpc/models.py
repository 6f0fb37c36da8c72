"""Motion models between robot and plan: states of observations, limits of velocities and
controls, commands of states.
"""

from __future__ import annotations

import math

import numpy as np

from arena_core import Pose, Twist
from arena_mpc.arrays import FloatArray
from arena_mpc.parameters import Drive, ModelName

VELOCITY_COUNTS: dict[ModelName, int] = {
    "unicycle": 2,
    "bicycle": 2,
    "omnidirectional": 3,
}  # behind x, y, theta in a state
LEAST_SPAN = 1e-3  # of a bounded variable: an interior point needs an interior


def velocity_bounds(model: ModelName, drive: Drive) -> tuple[FloatArray, FloatArray]:
    """Return least and greatest velocities of a state."""
    if model == "bicycle":
        return _widen_bounds((drive.vx_min, -drive.steering_max), (drive.vx_max, drive.steering_max))
    if model == "unicycle":
        return _widen_bounds((drive.vx_min, -drive.wz_max), (drive.vx_max, drive.wz_max))
    return _widen_bounds((drive.vx_min, -drive.vy_max, -drive.wz_max), (drive.vx_max, drive.vy_max, drive.wz_max))


def control_bounds(model: ModelName, drive: Drive) -> tuple[FloatArray, FloatArray]:
    """Return least and greatest controls."""
    if model == "bicycle":
        most = (drive.ax_max, drive.steering_rate_max)
    elif model == "unicycle":
        most = (drive.ax_max, drive.alpha_max)
    else:
        most = (drive.ax_max, drive.ay_max, drive.alpha_max)  # type: ignore[assignment]
    return _widen_bounds(tuple(-m for m in most), most)


def _widen_bounds(low: tuple[float, ...], high: tuple[float, ...]) -> tuple[FloatArray, FloatArray]:
    lows, highs = np.array(low), np.array(high)
    narrow = highs - lows < LEAST_SPAN
    return np.where(narrow, lows - LEAST_SPAN, lows), np.where(narrow, highs + LEAST_SPAN, highs)


def state_of(
    model: ModelName, drive: Drive, bounds: tuple[FloatArray, FloatArray], pose: Pose, twist: Twist, steering: float
) -> FloatArray:
    """Return the state of a robot, its velocities within ``bounds``; ``steering`` is a car's angle where
    its speed is too low to tell.
    """
    if model == "omnidirectional":
        velocities = [twist.vx, twist.vy, twist.wz]
    elif model == "unicycle":
        velocities = [twist.vx, twist.wz]
    else:
        told = math.atan(twist.wz * drive.wheelbase / twist.vx) if abs(twist.vx) > 0.1 else steering
        velocities = [twist.vx, told]
    return np.concatenate((pose.array(), np.clip(velocities, *bounds)))


def twist_of(model: ModelName, drive: Drive, velocities: FloatArray) -> Twist:
    """Return the command that drives with a state's velocities."""
    values = velocities.tolist()
    if model == "omnidirectional":
        return Twist(*values)
    if model == "unicycle":
        return Twist(values[0], 0.0, values[1])
    return Twist(values[0], 0.0, values[0] * math.tan(values[1]) / drive.wheelbase)
