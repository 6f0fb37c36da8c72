"""Wheel odometry with the noise of Thrun, Burgard and Fox, Probabilistic Robotics, table 5.6."""

from __future__ import annotations

import math
from typing import NamedTuple

from arena_core import OdometryModel
from arena_kernels.compiled import inner
from arena_kernels.motion import wrap_angle
from arena_kernels.random import normal
from arena_sim2d.bodies import Row

Step = tuple[float, float, float]
Noise = tuple[float, float, float]


class Wheels(NamedTuple):
    """When odometry is due, in ticks, and its noise."""

    period: int
    holonomic: bool
    alpha1: float
    alpha2: float
    alpha3: float
    alpha4: float


def wheels_of(model: OdometryModel, inner_step: float, *, holonomic: bool) -> Wheels:
    """Return what the kernels need to know of a robot's odometry."""
    alphas = (float(model.alpha1), float(model.alpha2), float(model.alpha3), float(model.alpha4))
    return Wheels(round(model.period / inner_step), holonomic, *alphas)


@inner
def measure_motion(wheels: Wheels, robot: Row, tick: int, dt: float) -> None:
    """Add the noisy motion of a robot since its last odometry; ``dt`` is the length of a tick, s."""
    dx, dy = robot.x - robot.odometry_from_x, robot.y - robot.odometry_from_y
    c, s = math.cos(robot.odometry_from_theta), math.sin(robot.odometry_from_theta)
    step = (c * dx + s * dy, c * dy - s * dx, wrap_angle(robot.theta - robot.odometry_from_theta))
    noise = (0.0, 0.0, 0.0)
    if wheels.alpha1 + wheels.alpha2 + wheels.alpha3 + wheels.alpha4 > 0.0:
        noise = (
            normal(robot.odometry_key, tick, 0),
            normal(robot.odometry_key, tick, 1),
            normal(robot.odometry_key, tick, 2),
        )
    seen = _noisy_shift(wheels, step, noise) if wheels.holonomic else _noisy_rotations(wheels, step, noise)
    _add_step(robot, seen, (tick - robot.odometry_tick) * dt)
    robot.odometry_tick = tick
    robot.odometry_from_x, robot.odometry_from_y, robot.odometry_from_theta = robot.x, robot.y, robot.theta


@inner
def _noisy_rotations(wheels: Wheels, step: Step, noise: Noise) -> Step:
    """Disturb a motion seen as rotation, translation, rotation; driving backwards is a translation backwards."""
    length = math.sqrt(step[0] * step[0] + step[1] * step[1])
    direction = -1.0 if step[0] < 0.0 else 1.0
    first = math.atan2(direction * step[1], direction * step[0]) if length > 0.0 else 0.0
    second = wrap_angle(step[2] - first)
    turning = first * first + second * second
    first += math.sqrt(wheels.alpha1 * first * first + wheels.alpha2 * length * length) * noise[0]
    moved = direction * (length + math.sqrt(wheels.alpha3 * length * length + wheels.alpha4 * turning) * noise[1])
    second += math.sqrt(wheels.alpha1 * second * second + wheels.alpha2 * length * length) * noise[2]
    return moved * math.cos(first), moved * math.sin(first), first + second


@inner
def _noisy_shift(wheels: Wheels, step: Step, noise: Noise) -> Step:
    """Disturb a motion that needs no turning: both translations and the rotation, with the same four alphas."""
    squared, turning = step[0] * step[0] + step[1] * step[1], step[2] * step[2]
    shift = math.sqrt(wheels.alpha3 * squared + wheels.alpha4 * turning)
    turn = math.sqrt(wheels.alpha1 * turning + wheels.alpha2 * squared)
    return step[0] + shift * noise[0], step[1] + shift * noise[1], step[2] + turn * noise[2]


@inner
def _add_step(robot: Row, step: Step, seconds: float) -> None:
    """Move the odometry pose by a step in its own frame; the twist is the mean velocity over that time."""
    theta = robot.odometry_theta
    c, s = math.cos(theta), math.sin(theta)
    robot.odometry_x += c * step[0] - s * step[1]
    robot.odometry_y += s * step[0] + c * step[1]
    robot.odometry_theta = wrap_angle(theta + step[2])
    c, s = math.cos(step[2] / 2.0), math.sin(step[2] / 2.0)  # the chord of an arc points along its middle heading
    robot.odometry_vx = (c * step[0] + s * step[1]) / seconds
    robot.odometry_vy = (c * step[1] - s * step[0]) / seconds
    robot.odometry_wz = step[2] / seconds
