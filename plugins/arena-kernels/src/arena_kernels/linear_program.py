"""The linear programmes of van den Berg, Guy, Lin, Manocha (2011), section 5: the nearest allowed velocity, or the
safest.

Half-planes are added one by one (de Berg et al., Computational Geometry, chapter 4), in the order given, so that the
same input gives the same output.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from arena_kernels.compiled import borrowing
from arena_kernels.half_planes import ALONG_X, ALONG_Y, POINT_X, POINT_Y, FloatArray, line_violation

PARALLEL = 1e-9


class Wish(NamedTuple):
    """The velocity wished for (m/s); with ``by_direction`` a unit vector: as far along it as is allowed."""

    velocity: tuple[float, float]
    by_direction: bool


@borrowing
def nearest_on_line(lines: FloatArray, last: int, speed: float, wished: Wish) -> tuple[bool, float, float]:
    """Return whether line ``last`` holds an allowed velocity, given the lines before it, and the one nearest to
    what is ``wished`` for.

    Velocities are no faster than ``speed``. A wish by direction is for the farthest one along it.
    """
    px, py, ax, ay = lines[last, POINT_X], lines[last, POINT_Y], lines[last, ALONG_X], lines[last, ALONG_Y]
    middle = -(px * ax + py * ay)
    half_squared = middle * middle + speed * speed - px * px - py * py
    if half_squared < 0.0:
        return False, 0.0, 0.0
    low, high = middle - math.sqrt(half_squared), middle + math.sqrt(half_squared)
    for i in range(last):
        turn = ax * lines[i, ALONG_Y] - ay * lines[i, ALONG_X]
        beyond = lines[i, ALONG_X] * (py - lines[i, POINT_Y]) - lines[i, ALONG_Y] * (px - lines[i, POINT_X])
        if abs(turn) <= PARALLEL:
            if beyond < 0.0:
                return False, 0.0, 0.0
        elif turn > 0.0:
            high = min(high, beyond / turn)
        else:
            low = max(low, beyond / turn)
        if low > high:
            return False, 0.0, 0.0
    along = ax * wished.velocity[0] + ay * wished.velocity[1]
    farthest = high if along > 0.0 else low
    t = farthest if wished.by_direction else min(max(along + middle, low), high)
    return True, px + t * ax, py + t * ay


@borrowing
def nearest_allowed(lines: FloatArray, count: int, speed: float, wished: Wish) -> tuple[int, float, float]:
    """Return how many of the first ``count`` lines could be kept (all, or up to the one that
    failed) and the best velocity then.
    """
    x, y = wished.velocity
    length = math.hypot(x, y)
    if wished.by_direction:
        x, y = x * speed, y * speed
    elif length > speed:
        x, y = x * speed / length, y * speed / length
    for i in range(count):
        if line_violation(lines[i], x, y) > 0.0:
            kept, new_x, new_y = nearest_on_line(lines, i, speed, wished)
            if not kept:
                return i, x, y
            x, y = new_x, new_y
    return count, x, y


@borrowing
def safest_velocity(
    lines: FloatArray, hard: int, count: int, failed: int, speed: float, best: tuple[float, float], scratch: FloatArray
) -> tuple[float, float]:
    """Return the velocity that lies least far on the wrong side of lines ``hard`` .. ``count`` - 1 while it keeps the
    lines before.

    ``failed`` is the first line that ``best`` could not keep. ``scratch`` has room for ``count`` lines.
    """
    x, y = best
    worst = 0.0
    for i in range(failed, count):
        if line_violation(lines[i], x, y) <= worst:
            continue
        rows = write_bisectors(lines, hard, i, scratch)
        kept, new_x, new_y = nearest_allowed(scratch, rows, speed, Wish((-lines[i, ALONG_Y], lines[i, ALONG_X]), True))
        if kept == rows:  # else rounding is to blame: by construction the velocity so far keeps them all
            x, y = new_x, new_y
        worst = line_violation(lines[i], x, y)
    return x, y


@borrowing
def write_bisectors(lines: FloatArray, hard: int, broken: int, scratch: FloatArray) -> int:
    """Write to ``scratch`` the hard lines, then for each line before ``broken`` the half-plane in which that one is
    less broken.

    Returns how many lines were written.
    """
    for i in range(hard):
        for k in range(4):
            scratch[i, k] = lines[i, k]
    rows = hard
    px, py, ax, ay = lines[broken, POINT_X], lines[broken, POINT_Y], lines[broken, ALONG_X], lines[broken, ALONG_Y]
    for i in range(hard, broken):
        qx, qy, bx, by = lines[i, POINT_X], lines[i, POINT_Y], lines[i, ALONG_X], lines[i, ALONG_Y]
        turn = ax * by - ay * bx
        if abs(turn) <= PARALLEL:
            if ax * bx + ay * by > 0.0:
                continue
            scratch[rows, POINT_X], scratch[rows, POINT_Y] = 0.5 * (px + qx), 0.5 * (py + qy)
        else:
            t = (bx * (py - qy) - by * (px - qx)) / turn
            scratch[rows, POINT_X], scratch[rows, POINT_Y] = px + t * ax, py + t * ay
        length = math.hypot(bx - ax, by - ay)
        scratch[rows, ALONG_X], scratch[rows, ALONG_Y] = (bx - ax) / length, (by - ay) / length
        rows += 1
    return rows
