"""Laser scans of grids, discs and segments, exact to rounding; the grid kernel leaps over empty squares.

A ray in a cell leaves at once the largest empty square ahead of it (``grids.quadrant_reach``); next to a wall that square is the
cell itself and the leap is one step of the digital differential analyser of Amanatides and Woo, A Fast Voxel Traversal Algorithm
for Ray Tracing, Eurographics 1987. So the cell that is hit, and where, is what the plain analyser finds.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arena_kernels.compiled import borrowing, inner
from arena_kernels.grids import TILE, GridStack, in_tiles, table_size, to_grid
from arena_kernels.scalars import Integer

Ray = tuple[Integer, float, float, float, float, float, float]


class Beams(NamedTuple):
    """The B beams of a scanner in its own frame, counter-clockwise: unit vectors (B,), first angle and increment rad, maximum range m.

    ``scratch`` (4, B) is the kernels' own: what cannot raise, as an allocation can, is compiled without reference counting.
    """

    cosines: NDArray[np.float64]
    sines: NDArray[np.float64]
    angle_min: float
    angle_increment: float
    range_max: float
    scratch: NDArray[np.float64]


def make_beams(angle_min: float, angle_increment: float, count: int, range_max: float) -> Beams:
    """Return ``count`` beams from ``angle_min`` by ``angle_increment`` > 0."""
    angles = angle_min + angle_increment * np.arange(count)
    return Beams(np.cos(angles), np.sin(angles), float(angle_min), float(angle_increment), float(range_max), np.empty((4, count)))


@borrowing
def scan_grids(
    stack: GridStack, grid_of: NDArray[np.int64], sensors: NDArray[np.float64], beams: Beams, ranges: NDArray[np.float32]
) -> None:
    """Fill ``ranges`` (N, B), m, with the scans of N sensors at poses (N, 3) in ``map``; +inf where nothing is hit."""
    for k in range(len(sensors)):
        cast_grid(stack, grid_of[k], sensors[k, 0], sensors[k, 1], sensors[k, 2], beams, ranges[k])


@borrowing
def cast_grid(stack: GridStack, g: Integer, x: float, y: float, theta: float, beams: Beams, ranges: NDArray[np.float32]) -> None:
    """Fill ``ranges`` (B,) with the distances to the occupied cells of grid ``g``, seen from a pose in ``map``; +inf: nothing hit."""
    u, v = to_grid(stack, g, x, y)
    _turn(beams, theta - stack.origins[g, 2], beams.scratch)
    limit = beams.range_max / stack.resolutions[g]
    _cast(stack.reach, stack.reach_offsets[g], stack.shapes[g, 0], stack.shapes[g, 1], u, v, beams.scratch, limit, ranges)
    for i in range(len(ranges)):
        ranges[i] *= stack.resolutions[g]


@inner
def _cast(
    reach: NDArray[np.uint8],
    offset: Integer,
    rows: Integer,
    columns: Integer,
    u: float,
    v: float,
    directions: NDArray[np.float64],
    limit: float,
    ranges: NDArray[np.float32],
) -> None:
    """Fill ``ranges`` (B,) seen from column u, row v; all lengths in cells."""
    strip, last = (columns // TILE + 1) * TILE * TILE, len(ranges) - 1
    for i in range(0, last + 1, 4):  # four rays at once: their leaps wait for memory, not for each other
        i1, i2, i3 = min(i + 1, last), min(i + 2, last), min(i + 3, last)
        ray0, t0, c0, r0 = _begin(offset, rows, columns, u, v, directions, i)
        ray1, t1, c1, r1 = _begin(offset, rows, columns, u, v, directions, i1)
        ray2, t2, c2, r2 = _begin(offset, rows, columns, u, v, directions, i2)
        ray3, t3, c3, r3 = _begin(offset, rows, columns, u, v, directions, i3)
        while True:
            side0 = np.int64(reach[ray0[0] + in_tiles(r0, c0, strip)]) if t0 < limit else 0
            side1 = np.int64(reach[ray1[0] + in_tiles(r1, c1, strip)]) if t1 < limit else 0
            side2 = np.int64(reach[ray2[0] + in_tiles(r2, c2, strip)]) if t2 < limit else 0
            side3 = np.int64(reach[ray3[0] + in_tiles(r3, c3, strip)]) if t3 < limit else 0
            if side0 | side1 | side2 | side3 == 0:
                break
            t0, c0, r0 = _leap(ray0, side0, t0, c0, r0)
            t1, c1, r1 = _leap(ray1, side1, t1, c1, r1)
            t2, c2, r2 = _leap(ray2, side2, t2, c2, r2)
            t3, c3, r3 = _leap(ray3, side3, t3, c3, r3)
        # a ray that ended within reach, but in no cell of the grid, has left it
        ranges[i] = t0 if t0 < limit and c0 < columns and r0 < rows else np.inf
        ranges[i1] = t1 if t1 < limit and c1 < columns and r1 < rows else np.inf
        ranges[i2] = t2 if t2 < limit and c2 < columns and r2 < rows else np.inf
        ranges[i3] = t3 if t3 < limit and c3 < columns and r3 < rows else np.inf


@inner
def _turn(beams: Beams, yaw: float, out: NDArray[np.float64]) -> None:
    """Write the beams' unit vectors turned by ``yaw``, and their inverses, into ``out`` (4, B)."""
    c, s = math.cos(yaw), math.sin(yaw)
    for i in range(len(beams.cosines)):
        out[0, i] = c * beams.cosines[i] - s * beams.sines[i] + 0.0  # turns -0 into 0: its inverse must be +inf
        out[1, i] = s * beams.cosines[i] + c * beams.sines[i] + 0.0
        out[2, i] = 1.0 / out[0, i]
        out[3, i] = 1.0 / out[1, i]


@inner
def _begin(
    offset: Integer, rows: Integer, columns: Integer, u: float, v: float, directions: NDArray[np.float64], i: int
) -> tuple[Ray, float, Integer, Integer]:
    """Return ray i, mirrored to run to higher columns and rows, and where it is at first: distance, column, row."""
    left, down = directions[0, i] < 0.0, directions[1, i] < 0.0
    x, y = (columns - u if left else u), (rows - v if down else v)
    dx, dy = abs(directions[0, i]), abs(directions[1, i])
    inverse_x, inverse_y = abs(directions[2, i]), abs(directions[3, i])
    base = offset + (np.int64(left) + 2 * np.int64(down)) * table_size(rows, columns)
    ray = (base, x, y, dx, dy, inverse_x, inverse_y)
    if 0.0 <= u < columns and 0.0 <= v < rows:
        column, row = np.int64(u), np.int64(v)
        return ray, 0.0, (columns - 1 - column if left else column), (rows - 1 - row if down else row)
    t = max(-x * inverse_x if x < 0.0 else 0.0, -y * inverse_y if y < 0.0 else 0.0)
    enter_x = max(x + t * dx, 0.0) if t < np.inf else np.inf
    enter_y = max(y + t * dy, 0.0) if t < np.inf else np.inf
    return ray, t, np.int64(min(enter_x, columns)), np.int64(min(enter_y, rows))


@inner
def _leap(ray: Ray, side: Integer, t: float, column: Integer, row: Integer) -> tuple[float, Integer, Integer]:
    """Return where the ray leaves the empty square, without branches; a ray that has ended (side 0) stays."""
    _, x, y, dx, dy, inverse_x, inverse_y = ray
    right, top = column + side, row + side
    tx, ty = (right - x) * inverse_x, (top - y) * inverse_y
    through_right = tx < ty
    leave = tx if through_right else ty
    # the cell after the leap touches the square: clamped, so that rounding and ties cannot cut a corner
    new_column = right if through_right else _clamp(np.int64(x + leave * dx), column, right - 1)
    new_row = _clamp(np.int64(y + leave * dy), row, top - 1) if through_right else top
    ended = side == 0
    return (t if ended else leave), (column if ended else new_column), (row if ended else new_row)


@inner
def _clamp(value: Integer, low: Integer, high: Integer) -> Integer:
    return max(min(value, high), low)


@borrowing
def plain_dda(stack: GridStack, g: Integer, x: float, y: float, theta: float, beams: Beams, ranges: NDArray[np.float32]) -> None:
    """Fill ``ranges`` like ``cast_grid``, cell by cell (Amanatides and Woo 1987): the yardstick of tests and benchmarks."""
    u, v = to_grid(stack, g, x, y)
    rows, columns = stack.shapes[g, 0], stack.shapes[g, 1]
    cells = stack.cells[stack.offsets[g] : stack.offsets[g] + rows * columns].reshape((rows, columns))
    limit = beams.range_max / stack.resolutions[g]
    directions = beams.scratch
    _turn(beams, theta - stack.origins[g, 2], directions)
    for i in range(len(ranges)):
        dx, dy = directions[0, i], directions[1, i]
        step_x, step_y = (1 if dx >= 0.0 else -1), (1 if dy >= 0.0 else -1)
        per_column, per_row = abs(directions[2, i]), abs(directions[3, i])
        column, row = np.int64(math.floor(u)), np.int64(math.floor(v))
        tx = (column + 1 - u if step_x > 0 else u - column) * per_column
        ty = (row + 1 - v if step_y > 0 else v - row) * per_row
        t = 0.0
        while t < limit and not (0 <= column < columns and 0 <= row < rows and cells[row, column]):
            if tx < ty:
                t = tx
                tx += per_column
                column += step_x
            else:
                t = ty
                ty += per_row
                row += step_y
        ranges[i] = t * stack.resolutions[g] if t < limit else np.inf


@borrowing
def cast_disc(
    x: float, y: float, theta: float, beams: Beams, centre_x: float, centre_y: float, radius: float, ranges: NDArray[np.float32]
) -> None:
    """Shorten ``ranges`` (B,) where a disc in ``map`` stands before what was hit; only the beams towards it are touched.

    A disc that is nowhere (NaN) is not seen.
    """
    dx, dy = centre_x - x, centre_y - y
    distance = math.sqrt(dx * dx + dy * dy)
    if not distance - radius < beams.range_max:
        return
    if distance <= radius:
        ranges[:] = 0.0
        return
    c, s = math.cos(theta), math.sin(theta)
    px, py = c * dx + s * dy, c * dy - s * dx
    half = math.asin(radius / distance)
    bearing = math.atan2(py, px)
    for turn in range(-1, 2):
        first, last = _window(beams, bearing - half + turn * 2.0 * math.pi, 2.0 * half)
        for i in range(first, last):
            along = px * beams.cosines[i] + py * beams.sines[i]
            across = px * beams.sines[i] - py * beams.cosines[i]
            chord = radius * radius - across * across
            if chord >= 0.0 and along > 0.0:
                _shorten(ranges, i, along - math.sqrt(chord), beams.range_max)


@borrowing
def cast_segments(x: float, y: float, theta: float, beams: Beams, segments: NDArray[np.float64], ranges: NDArray[np.float32]) -> None:
    """Shorten ``ranges`` (B,) where ``segments`` (S, 2, 2), end points in ``map``, stand before what was hit."""
    c, s = math.cos(theta), math.sin(theta)
    for k in range(len(segments)):
        ax, ay = segments[k, 0, 0] - x, segments[k, 0, 1] - y
        bx, by = segments[k, 1, 0] - x, segments[k, 1, 1] - y
        px, py = c * ax + s * ay, c * ay - s * ax
        qx, qy = c * bx + s * by - px, c * by - s * bx - py
        bearing = math.atan2(py, px)
        spread = math.atan2(px * qy - py * qx, px * px + py * py + px * qx + py * qy)
        bearing = min(bearing, bearing + spread)
        for turn in range(-1, 2):
            first, last = _window(beams, bearing + turn * 2.0 * math.pi, abs(spread))
            for i in range(first, last):
                cross = beams.cosines[i] * qy - beams.sines[i] * qx
                if cross == 0.0:
                    continue
                share = (px * beams.sines[i] - py * beams.cosines[i]) / cross
                if -1e-9 <= share <= 1.0 + 1e-9:  # neighbouring edges overlap by this much, so no beam slips through a corner
                    _shorten(ranges, i, (px * qy - py * qx) / cross, beams.range_max)


@inner
def _window(beams: Beams, start: float, width: float) -> tuple[int, int]:
    """Return the half-open range of beams between the angles ``start`` and ``start + width``, a beam wider on both sides."""
    first = math.floor((start - beams.angle_min) / beams.angle_increment) - 1.0
    last = math.ceil((start + width - beams.angle_min) / beams.angle_increment) + 2.0
    count = len(beams.cosines)
    return int(min(max(first, 0.0), count)), int(min(max(last, 0.0), count))


@inner
def _shorten(ranges: NDArray[np.float32], i: int, t: float, range_max: float) -> None:
    if 0.0 <= t < range_max and t < ranges[i]:
        ranges[i] = t
