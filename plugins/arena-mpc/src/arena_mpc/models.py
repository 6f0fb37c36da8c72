"""Motion models: how a state moves through one interval of constant velocity, in symbols and in numbers."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import casadi as ca
import numpy as np

from arena_core import Pose, Twist
from arena_mpc.arrays import FloatArray
from arena_mpc.parameters import Drive, ModelName

Symbol = Any  # casadi's SX, which has no types

VELOCITIES: dict[ModelName, int] = {"unicycle": 2, "bicycle": 2, "omnidirectional": 3}  # behind x, y, theta in a state
UNBOUNDED = np.full(3, np.inf)
LEAST_SPAN = 1e-3  # of a bounded variable: an interior point needs an interior


def unicycle(state: Symbol, control: Symbol, step: Symbol, wheelbase: Symbol) -> Symbol:
    """Move (x, y, theta, v, omega) under accelerations (a, alpha)."""
    v, omega = state[3] + step * control[0], state[4] + step * control[1]
    return _moved(state, v, 0.0, omega, step, v, omega)


def bicycle(state: Symbol, control: Symbol, step: Symbol, wheelbase: Symbol) -> Symbol:
    """Move (x, y, theta, v, steering angle), referred to the rear axle, under an acceleration and a steering rate."""
    v, steering = state[3] + step * control[0], state[4] + step * control[1]
    return _moved(state, v, 0.0, v * ca.tan(steering) / wheelbase, step, v, steering)


def omnidirectional(state: Symbol, control: Symbol, step: Symbol, wheelbase: Symbol) -> Symbol:
    """Move (x, y, theta, vx, vy, omega) under accelerations (ax, ay, alpha)."""
    vx, vy, omega = (state[3 + i] + step * control[i] for i in range(3))
    return _moved(state, vx, vy, omega, step, vx, vy, omega)


def _moved(state: Symbol, vx: Symbol, vy: Symbol, omega: Symbol, step: Symbol, *velocities: Symbol) -> Symbol:
    """Integrate with the heading of the interval's middle, which is exact up to the arc's sagitta."""
    middle = state[2] + 0.5 * step * omega
    c, s = ca.cos(middle), ca.sin(middle)
    return ca.vertcat(state[0] + step * (c * vx - s * vy), state[1] + step * (s * vx + c * vy), state[2] + step * omega, *velocities)


DYNAMICS: dict[ModelName, Callable[[Symbol, Symbol, Symbol, Symbol], Symbol]] = {
    "unicycle": unicycle,
    "bicycle": bicycle,
    "omnidirectional": omnidirectional,
}


def velocity_bounds(model: ModelName, drive: Drive) -> tuple[FloatArray, FloatArray]:
    """Return least and greatest velocities of a state."""
    if model == "bicycle":
        return _spanned((drive.vx_min, -drive.steering_max), (drive.vx_max, drive.steering_max))
    if model == "unicycle":
        return _spanned((drive.vx_min, -drive.wz_max), (drive.vx_max, drive.wz_max))
    return _spanned((drive.vx_min, -drive.vy_max, -drive.wz_max), (drive.vx_max, drive.vy_max, drive.wz_max))


def control_bounds(model: ModelName, drive: Drive) -> tuple[FloatArray, FloatArray]:
    """Return least and greatest controls."""
    if model == "bicycle":
        most = (drive.ax_max, drive.steering_rate_max)
    elif model == "unicycle":
        most = (drive.ax_max, drive.alpha_max)
    else:
        most = (drive.ax_max, drive.ay_max, drive.alpha_max)  # type: ignore[assignment]
    return _spanned(tuple(-m for m in most), most)


def _spanned(low: tuple[float, ...], high: tuple[float, ...]) -> tuple[FloatArray, FloatArray]:
    lows, highs = np.array(low), np.array(high)
    narrow = highs - lows < LEAST_SPAN
    return np.where(narrow, lows - LEAST_SPAN, lows), np.where(narrow, highs + LEAST_SPAN, highs)


def state_of(model: ModelName, drive: Drive, pose: Pose, twist: Twist, steering: float) -> FloatArray:
    """Return the state of a robot; ``steering`` is a car's angle where its speed is too low to tell."""
    if model == "omnidirectional":
        velocities = [twist.vx, twist.vy, twist.wz]
    elif model == "unicycle":
        velocities = [twist.vx, twist.wz]
    else:
        told = math.atan(twist.wz * drive.wheelbase / twist.vx) if abs(twist.vx) > 0.1 else steering
        velocities = [twist.vx, told]
    low, high = velocity_bounds(model, drive)
    return np.concatenate((pose.array(), np.clip(velocities, low, high)))


def twist_of(model: ModelName, drive: Drive, velocities: FloatArray) -> Twist:
    """Return the command that drives with a state's velocities."""
    values = velocities.tolist()
    if model == "omnidirectional":
        return Twist(*values)
    if model == "unicycle":
        return Twist(values[0], 0.0, values[1])
    return Twist(values[0], 0.0, values[0] * math.tan(values[1]) / drive.wheelbase)
