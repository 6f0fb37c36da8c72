"""The people, robots and ground of N worlds as crowd kernels take them, and those of one world
as their inner loops read them.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arena_kernels.compiled import borrowing, compiled

Floats = NDArray[np.float64]


class Bodies(NamedTuple):
    """The people of one world:

    ``positions``, ``velocities`` (P, 2), ``radii`` (P,), ``states`` (P,). Metres, m/s, frame ``map``.
    """

    positions: Floats
    velocities: Floats
    radii: Floats
    states: NDArray[np.int8]


class NearPairs(NamedTuple):
    """Who is near whom: the first ``found`` rows of ``pairs`` (K, 2)."""

    pairs: NDArray[np.int32]
    found: int


class Crowds(NamedTuple):
    """The people of N worlds: how many each has (N,), and the arrays of Bodies with one axis more in front."""

    counts: NDArray[np.int32]
    positions: Floats
    velocities: Floats
    radii: Floats
    states: NDArray[np.int8]


class Robot(NamedTuple):
    """The robot of one world: position m, velocity m/s, radius m and heading rad, in the frame ``map``."""

    x: float
    y: float
    vx: float
    vy: float
    radius: float
    theta: float


class Robots(NamedTuple):
    """The M robots of one world: ``poses`` (M, 3), ``velocities`` (M, 2) in the frame ``map``, ``radii`` (M,) m."""

    poses: Floats
    velocities: Floats
    radii: Floats


class RobotStack(NamedTuple):
    """The robots of N worlds: the arrays of Robots with one axis more in front."""

    poses: Floats
    velocities: Floats
    radii: Floats


def robot_stack(poses: Floats, velocities: Floats, radius: float | Floats) -> RobotStack:
    """Return robots as kernels take them, with an axis of robots where each of ``poses`` (N, 3) is alone in its world;
    ``radius`` is that of all, or one of each (N, M).
    """
    stacked = np.ascontiguousarray(poses, np.float64).reshape(len(poses), -1, 3)
    radii = np.empty(stacked.shape[:2])
    radii[:] = radius
    return RobotStack(stacked, np.ascontiguousarray(velocities, np.float64).reshape(len(poses), -1, 2), radii)


@compiled
def bodies_of(crowds: Crowds, world: int) -> Bodies:
    """Return the people of one world, without the slots that it leaves empty."""
    n = crowds.counts[world]
    return Bodies(
        crowds.positions[world, :n], crowds.velocities[world, :n], crowds.radii[world, :n], crowds.states[world, :n]
    )


@compiled
def robots_of(stack: RobotStack, world: int) -> Robots:
    """Return the robots of one world."""
    return Robots(stack.poses[world], stack.velocities[world], stack.radii[world])


@borrowing
def robot_at(robots: Robots, place: int) -> Robot:
    """Return one of the robots of a world."""
    x, y, theta = robots.poses[place, 0], robots.poses[place, 1], robots.poses[place, 2]
    return Robot(x, y, robots.velocities[place, 0], robots.velocities[place, 1], robots.radii[place], theta)


@borrowing
def nearest_robot(robots: Robots, x: float, y: float) -> int:
    """Return the place of the robot whose centre is nearest to (x, y)."""
    nearest, least = 0, math.inf
    for place in range(len(robots.radii)):
        squared = (robots.poses[place, 0] - x) ** 2 + (robots.poses[place, 1] - y) ** 2
        if squared < least:
            nearest, least = place, squared
    return nearest
