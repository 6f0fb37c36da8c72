"""Half-planes of velocities that stay clear of a moving disc for a while: van den Berg, Guy,
Lin, Manocha (2011), section 4.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from arena_kernels.compiled import borrowing

FloatArray = NDArray[np.float64]
POINT_X, POINT_Y, ALONG_X, ALONG_Y = 0, 1, 2, 3  # columns of a line: velocities on its left are allowed


@borrowing
def smallest_change(
    place: tuple[float, float, float, float], radius: float, horizon: float, overlap_time: float
) -> tuple[float, ...]:
    """Return (ux, uy, along_x, along_y): the least change of a relative velocity that leaves the velocity obstacle, and
    its tangent there.

    The other disc is at (px, py), both radii together are ``radius`` (m); the velocity (vx, vy) is relative to it. No
    collision is wanted within ``horizon`` s; discs that overlap shall part within ``overlap_time`` s. Outside the
    obstacle the change points into it: so much is still allowed.
    """
    px, py, vx, vy = place
    apart_squared = px * px + py * py
    overlapping = apart_squared <= radius * radius
    time = overlap_time if overlapping else horizon
    wx, wy = vx - px / time, vy - py / time  # from the centre of the disc that cuts the cone off
    length_squared, toward = wx * wx + wy * wy, wx * px + wy * py
    if overlapping or (toward < 0.0 and toward * toward > radius * radius * length_squared):
        length = math.sqrt(length_squared)
        nx, ny = (wx / length, wy / length) if length > 1e-12 else (-1.0, 0.0)
        push = radius / time - length
        return push * nx, push * ny, ny, -nx
    leg = math.sqrt(apart_squared - radius * radius)
    # which leg of the cone is nearer: the left one, seen from the robot, or the right
    side = 1.0 if px * wy - py * wx > 0.0 else -1.0
    ax = side * (px * leg - side * py * radius) / apart_squared
    ay = side * (side * px * radius + py * leg) / apart_squared
    along = vx * ax + vy * ay
    return along * ax - vx, along * ay - vy, ax, ay


@borrowing
def put_person(
    lines: FloatArray,
    row: int,
    place: tuple[float, float, float, float],
    own: tuple[float, float],
    radius: float,
    rules: tuple[float, ...],
) -> None:
    """Write the half-plane of a robot with velocity ``own`` and a disc at ``place`` (x, y, vx, vy), seen from the
    robot.

    ``rules`` are horizon (s), overlap time (s) and the share of the change that the robot takes upon itself: 1/2 where
    the other does the same, 1 where the other does nothing.
    """
    horizon, overlap_time, share = rules
    ux, uy, ax, ay = smallest_change(
        (place[0], place[1], own[0] - place[2], own[1] - place[3]), radius, horizon, overlap_time
    )
    lines[row, POINT_X], lines[row, POINT_Y] = own[0] + share * ux, own[1] + share * uy
    lines[row, ALONG_X], lines[row, ALONG_Y] = ax, ay


@borrowing
def put_bound(lines: FloatArray, row: int, nx: float, ny: float, bound: float) -> None:
    """Write the half-plane of velocities whose part along the unit vector (nx, ny) is at most ``bound``."""
    lines[row, POINT_X], lines[row, POINT_Y] = nx * bound, ny * bound
    lines[row, ALONG_X], lines[row, ALONG_Y] = -ny, nx


@borrowing
def line_violation(line: FloatArray, x: float, y: float) -> float:
    """Return how far a velocity lies on the forbidden side of a line, negative on the allowed side."""
    return line[ALONG_X] * (line[POINT_Y] - y) - line[ALONG_Y] * (line[POINT_X] - x)  # type: ignore[no-any-return]
