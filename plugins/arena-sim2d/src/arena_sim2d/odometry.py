"""Wheel odometry with the noise of Thrun, Burgard and Fox, Probabilistic Robotics, table 5.6."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arena_core import OdometryModel
from arena_kernels.compiled import borrowing
from arena_kernels.random import normal
from arena_sim2d.bodies import Chassis, Floats, Robots
from arena_sim2d.motion import OMNIDIRECTIONAL, wrap

Step = tuple[float, float, float]


class WheelNoise(NamedTuple):
    """When odometry is due, in ticks, and its noise."""

    period: int
    alpha1: float
    alpha2: float
    alpha3: float
    alpha4: float


class Odometers(NamedTuple):
    """N odometers: ``poses`` (N, 3) in ``odom``, ``twists`` (N, 3), ``ticks`` (N,) of their stamps, the true poses then, stream keys."""

    poses: Floats
    twists: Floats
    ticks: NDArray[np.int64]
    true_poses: Floats
    keys: NDArray[np.uint64]


def wheel_noise(model: OdometryModel, inner_step: float) -> WheelNoise:
    """Return the noise parameters for the kernels."""
    return WheelNoise(round(model.period / inner_step), float(model.alpha1), float(model.alpha2), float(model.alpha3), float(model.alpha4))


@borrowing
def measure_motion(chassis: Chassis, noise: WheelNoise, robots: Robots, odometers: Odometers, k: int, tick: int, dt: float) -> None:
    """Add the noisy motion of robot k since its last odometry; ``dt`` is the length of a tick, s."""
    x, y, theta = odometers.true_poses[k, 0], odometers.true_poses[k, 1], odometers.true_poses[k, 2]
    dx, dy = robots.poses[k, 0] - x, robots.poses[k, 1] - y
    c, s = math.cos(theta), math.sin(theta)
    step = (c * dx + s * dy, c * dy - s * dx, wrap(robots.poses[k, 2] - theta))
    seen = _noisy_holonomic(noise, step, odometers.keys[k], tick)
    if chassis.kinematics != OMNIDIRECTIONAL:
        seen = _noisy_rotations(noise, step, odometers.keys[k], tick)
    _advance(odometers, k, seen, (tick - odometers.ticks[k]) * dt)
    odometers.ticks[k] = tick
    for axis in range(3):
        odometers.true_poses[k, axis] = robots.poses[k, axis]


@borrowing
def _noisy_rotations(noise: WheelNoise, step: Step, key: np.uint64, tick: int) -> Step:
    """Disturb a motion seen as rotation, translation, rotation; driving backwards is a translation backwards."""
    length = math.hypot(step[0], step[1])
    direction = -1.0 if step[0] < 0.0 else 1.0
    first = math.atan2(direction * step[1], direction * step[0]) if length > 0.0 else 0.0
    second = wrap(step[2] - first)
    turning = first * first + second * second
    first += math.sqrt(noise.alpha1 * first * first + noise.alpha2 * length * length) * normal(key, tick, 0)
    moved = direction * (length + math.sqrt(noise.alpha3 * length * length + noise.alpha4 * turning) * normal(key, tick, 1))
    second += math.sqrt(noise.alpha1 * second * second + noise.alpha2 * length * length) * normal(key, tick, 2)
    return moved * math.cos(first), moved * math.sin(first), first + second


@borrowing
def _noisy_holonomic(noise: WheelNoise, step: Step, key: np.uint64, tick: int) -> Step:
    """Disturb a motion that needs no turning: both translations and the rotation, with the same four alphas."""
    squared, turning = step[0] * step[0] + step[1] * step[1], step[2] * step[2]
    shift = math.sqrt(noise.alpha3 * squared + noise.alpha4 * turning)
    turn = math.sqrt(noise.alpha1 * turning + noise.alpha2 * squared)
    return (
        step[0] + shift * normal(key, tick, 0),
        step[1] + shift * normal(key, tick, 1),
        step[2] + turn * normal(key, tick, 2),
    )


@borrowing
def _advance(odometers: Odometers, k: int, step: Step, seconds: float) -> None:
    """Move the odometry pose by a step in its own frame; the twist is the mean velocity over that time."""
    theta = odometers.poses[k, 2]
    c, s = math.cos(theta), math.sin(theta)
    odometers.poses[k, 0] += c * step[0] - s * step[1]
    odometers.poses[k, 1] += s * step[0] + c * step[1]
    odometers.poses[k, 2] = wrap(theta + step[2])
    middle_c, middle_s = math.cos(step[2] / 2.0), math.sin(step[2] / 2.0)  # the chord of an arc points along its middle heading
    odometers.twists[k, 0] = (middle_c * step[0] + middle_s * step[1]) / seconds
    odometers.twists[k, 1] = (middle_c * step[1] - middle_s * step[0]) / seconds
    odometers.twists[k, 2] = step[2] / seconds
