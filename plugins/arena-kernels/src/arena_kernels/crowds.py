"""The people, robots and ground of N worlds as crowd kernels take them, and those of one world
as their inner loops read them.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arena_kernels.compiled import compiled

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
    """One robot in each of N worlds: ``poses`` (N, 3), ``velocities`` (N, 2) in the frame ``map``; ``radius`` m."""

    poses: Floats
    velocities: Floats
    radius: float


@compiled
def bodies_of(crowds: Crowds, world: int) -> Bodies:
    """Return the people of one world, without the slots that it leaves empty."""
    n = crowds.counts[world]
    return Bodies(
        crowds.positions[world, :n], crowds.velocities[world, :n], crowds.radii[world, :n], crowds.states[world, :n]
    )


@compiled
def robot_of(robots: Robots, world: int) -> Robot:
    """Return the robot of one world."""
    x, y, theta = robots.poses[world, 0], robots.poses[world, 1], robots.poses[world, 2]
    return Robot(x, y, robots.velocities[world, 0], robots.velocities[world, 1], robots.radius, theta)
