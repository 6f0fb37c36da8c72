"""The arrays that the kernels step: N worlds, structure of arrays, passed to compiled code as named tuples."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arena_core import Robot
from arena_kernels.footprint import Body
from arena_sim2d.scene import Scene

Floats = NDArray[np.float64]
KINEMATICS = {"differential": 0, "omnidirectional": 1, "ackermann": 2}


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


class Robots(NamedTuple):
    """N robots: ``poses`` (N, 3) in ``map``, ``velocities`` (N, 3) in ``base_link``, ``ticks`` (N,) since each episode began."""

    poses: Floats
    velocities: Floats
    ticks: NDArray[np.int64]


class People(NamedTuple):
    """The people of N worlds in P slots: as in a Crowd, and ``strides`` (N, P, 2), the way that each wants to go a tick, m."""

    counts: NDArray[np.int32]
    ids: NDArray[np.int32]
    positions: Floats
    velocities: Floats
    radii: Floats
    strides: Floats


class Touch(NamedTuple):
    """Contacts of N robots: ``held`` (N, M), which things each touches, ``ticks`` (N,) in contact, and the rising edges.

    Things are numbered: 0 the walls, then obstacles (discs, polygons), from ``first_person`` on people. ``edges`` (N, E, 7) has
    ``counts`` (N,) rows of tick, thing, closing speed, caused, x, y, person.
    """

    held: NDArray[np.bool_]
    ticks: NDArray[np.int64]
    edges: Floats
    counts: NDArray[np.int64]
    first_person: int


class Moving(NamedTuple):
    """All that takes part in a tick: what stands, the robots and people, their contacts; ``body`` and ``person`` are put where needed."""

    scene: Scene
    chassis: Chassis
    robots: Robots
    people: People
    touch: Touch
    body: Body
    person: Body


def chassis(robot: Robot) -> Chassis:
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
