"""What the compiled optimiser is told: tuples of plain numbers and arrays, in SI units.

A band is an array (N, 4) whose row k is (x, y, theta, dt): pose k in ``map`` and the time to pose k + 1; the last dt
means nothing.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]


class Shape(NamedTuple):
    """The footprint: the convex hull of ``corners`` (C, 2), counter-clockwise in ``base_link``, grown by ``rounding``
    m.

    A disc is one corner at the origin. ``radius`` m holds all of it, ``inscribed`` m lies inside it.
    """

    corners: FloatArray
    rounding: float
    radius: float
    inscribed: float


class Penalties(NamedTuple):
    """Where penalties begin, and the square roots of their weights; axes are (forward, left, turn), weight 0 means no
    term.

    ``speed_min``, ``speed_max``, ``acceleration`` and both ``root_`` arrays (3,), m and rad. A point nearer than
    ``near`` m costs ``root_obstacle``, nearer than ``inflated`` m ``root_inflation``; ``dynamic_`` is the same for
    moving obstacles. ``turn_radius`` m. What a point comes short of ``near`` by is counted in ``unit`` m and raised to
    ``exponent``.
    """

    speed_min: FloatArray
    speed_max: FloatArray
    acceleration: FloatArray
    root_speed: FloatArray
    root_acceleration: FloatArray
    root_nonholonomic: float
    root_forward: float
    root_turn_radius: float
    root_time: float
    root_path: float
    root_obstacle: float
    root_inflation: float
    root_dynamic: float
    root_dynamic_inflation: float
    root_via: float
    root_rotation: float
    turn_radius: float
    near: float
    inflated: float
    dynamic_near: float
    dynamic_inflated: float
    exponent: float
    unit: float


class Ends(NamedTuple):
    """How a band begins and ends: ``start`` and ``goal`` (3,) are body velocities.

    ``stops`` 1.0: the goal's velocity counts; ``heading_free`` 1.0: the last heading may turn; ``rotation`` is the
    preferred direction of turning, 0.0: none.
    """

    start: FloatArray
    goal: FloatArray
    stops: float
    heading_free: float
    rotation: float


class Surroundings(NamedTuple):
    """What is around each of N poses.

    ``points`` (N, P, 2) are static points: the nearest to the left and right, then those that are forced to count, inf
    where there is none, each with ``point_radius`` m; ``caps`` (N,) the share of the speed limits that is allowed
    there; ``room`` (N,) m, the gap that a narrow passage leaves on either side of the robot, inf outside of passages;
    ``moving`` (N, K, 2) where moving discs of ``radii`` (K,) m will be when the robot is at the pose; ``vias`` (V, 2)
    points to pass, the pose ``via_poses`` (V,) each.
    """

    points: FloatArray
    point_radius: float
    caps: FloatArray
    room: FloatArray
    moving: FloatArray
    radii: FloatArray
    vias: FloatArray
    via_poses: IntArray


class Rows(NamedTuple):
    """Weighted residuals of the terms that are in action with their derivatives, row by row: the first ``used[0]`` of R
    rows.

    ``jacobian`` (R, 11) holds the derivatives by the ``width`` (R,) variables from ``first`` (R,) on, variable 4 k + i
    being ``band[k, i]``; ``term`` (R,) says which of all R terms a row is of. ``speeds`` (N, 3) and ``slopes`` (N, 3,
    7) are the body velocity of each interval and its derivatives by (x, y, theta, dt, next x, next y, next theta).
    """

    used: IntArray
    residual: FloatArray
    jacobian: FloatArray
    first: IntArray
    width: IntArray
    term: IntArray
    speeds: FloatArray
    slopes: FloatArray


class BandTerms(NamedTuple):
    """What the terms of a band are weighed by, and the rows they are written to."""

    penalties: Penalties
    rows: Rows


INTERVAL_ROWS = 9  # three speeds, three of kinematics, time, path, rotation
JOINT_ROWS = 3  # three accelerations
POINT_ROWS = 2  # near and inflated
REACH = 11  # variables that one term may join: three poses and two times
