"""How a robot moves: commands within its limits, and the arc that it drives in a tick."""

from __future__ import annotations

import math
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from arena_kernels.compiled import borrowing, inner

Floats = NDArray[np.float64]

DIFFERENTIAL, OMNIDIRECTIONAL, ACKERMANN = 0, 1, 2
KINEMATICS = {"differential": DIFFERENTIAL, "omnidirectional": OMNIDIRECTIONAL, "ackermann": ACKERMANN}

Position = tuple[float, float, float]
Velocity = tuple[float, float, float]


class Chassis(NamedTuple):
    """How a robot moves, and its limits (SI)."""

    kinematics: int
    vx_min: float
    vx_max: float
    vy_max: float
    wz_max: float
    ax_max: float
    ay_max: float
    alpha_max: float
    curvature_max: float


class Limits(Protocol):
    """What a robot's limits are made of: the fields of ``arena_core.VelocityLimits``."""

    @property
    def vx_min(self) -> float:
        """Return the speed backwards, m/s."""

    @property
    def vx_max(self) -> float:
        """Return the speed forwards, m/s."""

    @property
    def vy_max(self) -> float:
        """Return the speed sideways, m/s."""

    @property
    def wz_max(self) -> float:
        """Return the turn rate, rad/s."""

    @property
    def ax_max(self) -> float:
        """Return the acceleration ahead, m/s^2."""

    @property
    def ay_max(self) -> float:
        """Return the acceleration sideways, m/s^2."""

    @property
    def alpha_max(self) -> float:
        """Return the angular acceleration, rad/s^2."""


class MovingRobot(Protocol):
    """How a robot moves: these fields of ``arena_core.Robot``."""

    @property
    def kinematics(self) -> str:
        """Return its kind of drive."""

    @property
    def limits(self) -> Limits:
        """Return its limits."""

    @property
    def wheelbase(self) -> float:
        """Return the distance between its axles, m."""

    @property
    def steering_max(self) -> float:
        """Return its greatest steering angle, rad."""


def chassis_of(robot: MovingRobot) -> Chassis:
    """Return what the kernels need to know of how a robot moves."""
    limits = robot.limits
    curvature = math.tan(robot.steering_max) / robot.wheelbase if robot.kinematics == "ackermann" else math.inf
    return Chassis(
        KINEMATICS[robot.kinematics],
        float(limits.vx_min),
        float(limits.vx_max),
        float(limits.vy_max),
        float(limits.wz_max),
        float(limits.ax_max),
        float(limits.ay_max),
        float(limits.alpha_max),
        float(curvature),
    )


@borrowing
def next_velocity(chassis: Chassis, share: float, velocity: Velocity, command: Floats, dt: float) -> Velocity:
    """Return the velocity (vx, vy, wz) after a tick: the command within a share of the speed limits, as
    fast as accelerations allow.
    """
    vx = _step_towards(
        velocity[0], _clip_value(command[0], share * chassis.vx_min, share * chassis.vx_max), chassis.ax_max * dt
    )
    wz_max = share * chassis.wz_max
    if chassis.kinematics == ACKERMANN:
        return vx, 0.0, _ackermann_turn_rate(chassis, wz_max, velocity[2], vx, command, dt)
    wz = _step_towards(velocity[2], _clip_value(command[2], -wz_max, wz_max), chassis.alpha_max * dt)
    if chassis.kinematics == DIFFERENTIAL:
        return vx, 0.0, wz
    vy_max = share * chassis.vy_max
    return vx, _step_towards(velocity[1], _clip_value(command[1], -vy_max, vy_max), chassis.ay_max * dt), wz


@inner
def _ackermann_turn_rate(chassis: Chassis, wz_max: float, wz: float, vx: float, command: Floats, dt: float) -> float:
    """Return the turn rate of a car that steers along the commanded arc; it never turns tighter than its steering
    allows.

    A car that brakes in a bend turns more slowly at once, so there the angular acceleration may exceed ``alpha_max``.
    """
    curvature = (
        _clip_value(command[2] / command[0], -chassis.curvature_max, chassis.curvature_max)
        if command[0] != 0.0
        else 0.0
    )
    tightest = chassis.curvature_max * abs(vx)
    wanted = _clip_value(curvature * vx, -wz_max, wz_max)
    return _clip_value(_step_towards(wz, wanted, chassis.alpha_max * dt), -tightest, tightest)


@borrowing
def drive_arc(pose: Position, velocity: Velocity, dt: float) -> Position:
    """Return the pose after ``dt`` seconds at a constant velocity in ``base_link``: an exact arc."""
    x, y, theta = pose
    vx, vy, wz = velocity
    turn = wz * dt
    # series of sin(turn) / turn and (1 - cos(turn)) / turn: exact to rounding, and no division by zero
    if abs(turn) < 0.1:
        t = turn * turn
        ahead = 1.0 - t / 6.0 * (1.0 - t / 20.0 * (1.0 - t / 42.0 * (1.0 - t / 72.0)))
        aside = turn / 2.0 * (1.0 - t / 12.0 * (1.0 - t / 30.0 * (1.0 - t / 56.0 * (1.0 - t / 90.0))))
    else:
        ahead, aside = math.sin(turn) / turn, (1.0 - math.cos(turn)) / turn
    dx, dy = dt * (vx * ahead - vy * aside), dt * (vx * aside + vy * ahead)
    c, s = math.cos(theta), math.sin(theta)
    return x + c * dx - s * dy, y + s * dx + c * dy, wrap_angle(theta + turn)


@inner
def in_map(theta: float, velocity: Velocity) -> Velocity:
    """Turn a velocity from ``base_link`` to ``map``."""
    c, s = math.cos(theta), math.sin(theta)
    return c * velocity[0] - s * velocity[1], s * velocity[0] + c * velocity[1], velocity[2]


@inner
def wrap_angle(angle: float) -> float:
    """Wrap an angle to [-pi, pi)."""
    return angle - 2.0 * math.pi * math.floor((angle + math.pi) / (2.0 * math.pi))


@inner
def _step_towards(value: float, wanted: float, change: float) -> float:
    return _clip_value(wanted, value - change, value + change)  # so that rounding never leads beyond what is wanted


@inner
def _clip_value(value: float, low: float, high: float) -> float:
    return min(max(value, low), high)
