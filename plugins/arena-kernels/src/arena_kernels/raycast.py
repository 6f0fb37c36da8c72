"""Laser scans of grids, discs and segments, exact to rounding; the grid kernel leaps over empty squares.

A ray in a cell leaves at once the largest empty square ahead of it (``grids.quadrant_reach``); next to a wall that
square is the cell itself and the leap is one step of the digital differential analyser of Amanatides and Woo, A Fast
Voxel Traversal Algorithm for Ray Tracing, Eurographics 1987. So the cell that is hit, and where, is what the plain
analyser finds.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arena_kernels.compiled import borrowing, inlined, inner
from arena_kernels.grids import TILE, GridStack, table_size, tile_index, to_grid
from arena_kernels.scalars import Integer

# beams that leap together: their arithmetic runs in vector registers, and their table is read while others are computed
LANES = 32
# where each is in the lanes' numbers
X, Y, DX, DY, INVERSE_X, INVERSE_Y, T, COLUMN, ROW = (k * LANES for k in range(9))


class RayLanes(NamedTuple):
    """Room for the rays that leap together, mirrored to run to higher columns and rows; lengths in cells.

    ``numbers`` (9 LANES,) has origin, direction, its inverse, and the distance, column and row where a ray is now, kind
    after kind. ``tables`` is where a ray's table begins, ``places`` (2 LANES,) where its cell lies in it and, after all
    of these, the side of the empty square there.
    """

    numbers: NDArray[np.float64]
    tables: NDArray[np.int64]
    places: NDArray[np.int32]


class Beams(NamedTuple):
    """The B beams of a scanner in its own frame, counter-clockwise: unit vectors (B,), first angle and increment rad,
    maximum range m.

    ``lanes`` are the kernels' own: what cannot raise, as an allocation can, is compiled without reference counting.
    """

    cosines: NDArray[np.float64]
    sines: NDArray[np.float64]
    angle_min: float
    angle_increment: float
    range_max: float
    lanes: RayLanes


def make_beams(angle_min: float, angle_increment: float, count: int, range_max: float) -> Beams:
    """Return ``count`` beams from ``angle_min`` by ``angle_increment`` > 0."""
    angles = angle_min + angle_increment * np.arange(count)
    lanes = RayLanes(np.zeros(9 * LANES), np.zeros(LANES, np.int64), np.zeros(2 * LANES, np.int32))
    return Beams(np.cos(angles), np.sin(angles), float(angle_min), float(angle_increment), float(range_max), lanes)


@borrowing
def scan_grids(
    stack: GridStack,
    grid_of: NDArray[np.int64],
    sensors: NDArray[np.float64],
    beams: Beams,
    ranges: NDArray[np.float32],
) -> None:
    """Fill ``ranges`` (N, B), m, with the scans of N sensors at poses (N, 3) in ``map``; +inf where nothing is hit."""
    for k in range(len(sensors)):
        cast_grid(stack, grid_of[k], (sensors[k, 0], sensors[k, 1], sensors[k, 2]), beams, ranges[k])


@borrowing
def cast_grid(
    stack: GridStack, g: Integer, pose: tuple[float, float, float], beams: Beams, ranges: NDArray[np.float32]
) -> None:
    """Fill ``ranges`` (B,) with the distances to the occupied cells of grid ``g``, seen from a pose in
    ``map``; +inf: nothing hit.
    """
    x, y, theta = pose
    u, v = to_grid(stack, g, x, y)
    rows, columns, lanes = stack.shapes[g, 0], stack.shapes[g, 1], beams.lanes
    yaw, resolution = theta - stack.origins[g, 2], stack.resolutions[g]
    limit, strip = beams.range_max / resolution, np.int32((columns // TILE + 1) * TILE * TILE)
    now = lanes.numbers
    for first in range(0, len(ranges), LANES):
        count = min(LANES, len(ranges) - first)
        _start_rays(beams, first, count, yaw, u, v, rows, columns)
        _find_tables(lanes, count, stack.reach_offsets[g], table_size(rows, columns))
        _find_places(lanes, count, strip)
        moved = True
        while moved:
            _read_squares(stack.reach, lanes, count)
            moved = _leap_rays(lanes, count, limit, strip)
        for i in range(count):
            # a ray that ended within reach, but in no cell of the grid, has left it
            hit = now[T + i] < limit and now[COLUMN + i] < columns and now[ROW + i] < rows
            ranges[first + i] = now[T + i] if hit else np.inf
            ranges[first + i] *= resolution


@inlined
def _start_rays(
    beams: Beams, first: int, count: int, yaw: float, u: float, v: float, rows: Integer, columns: Integer
) -> None:
    """Begin ``count`` rays from beam ``first`` on, seen from column u, row v; those from outside begin
    where they enter the grid.
    """
    c, s, numbers, cosines, sines = math.cos(yaw), math.sin(yaw), beams.lanes.numbers, beams.cosines, beams.sines
    column, row = float(np.int64(u)), float(np.int64(v))
    for i in range(count):
        dx = c * cosines[first + i] - s * sines[first + i] + 0.0  # turns -0 into 0: its inverse must be +inf
        dy = s * cosines[first + i] + c * sines[first + i] + 0.0
        left, down = dx < 0.0, dy < 0.0
        numbers[X + i], numbers[Y + i] = (columns - u if left else u), (rows - v if down else v)
        numbers[DX + i], numbers[DY + i] = dx, dy
        numbers[INVERSE_X + i], numbers[INVERSE_Y + i] = abs(1.0 / dx), abs(1.0 / dy)
        numbers[T + i] = 0.0
        numbers[COLUMN + i], numbers[ROW + i] = (
            (columns - 1.0 - column if left else column),
            (rows - 1.0 - row if down else row),
        )
    if not (0.0 <= u < columns and 0.0 <= v < rows):
        _enter_grid(beams.lanes, count, rows, columns)


@inner
def _enter_grid(lanes: RayLanes, count: int, rows: Integer, columns: Integer) -> None:
    """Take rays from outside to where they enter the grid, or to the rim beyond its last column and row."""
    numbers = lanes.numbers
    for i in range(count):
        x, y = numbers[X + i], numbers[Y + i]
        t = max(-x * numbers[INVERSE_X + i] if x < 0.0 else 0.0, -y * numbers[INVERSE_Y + i] if y < 0.0 else 0.0)
        numbers[T + i] = t
        numbers[COLUMN + i] = (
            np.floor(_clamp_value(x + t * abs(numbers[DX + i]), 0.0, float(columns))) if t < np.inf else columns
        )
        numbers[ROW + i] = (
            np.floor(_clamp_value(y + t * abs(numbers[DY + i]), 0.0, float(rows))) if t < np.inf else rows
        )


@inlined
def _find_tables(lanes: RayLanes, count: int, offset: Integer, size: int) -> None:
    """Note which of the four tables each ray reads; from here on all of them run to higher columns and rows."""
    numbers = lanes.numbers
    for i in range(count):
        lanes.tables[i] = offset + (size if numbers[DX + i] < 0.0 else 0) + (2 * size if numbers[DY + i] < 0.0 else 0)
        numbers[DX + i], numbers[DY + i] = abs(numbers[DX + i]), abs(numbers[DY + i])


@inlined
def _find_places(lanes: RayLanes, count: int, strip: Integer) -> None:
    """Note where in their tables the cells lie that the rays are in."""
    for i in range(count):
        lanes.places[i] = tile_index(np.int32(lanes.numbers[ROW + i]), np.int32(lanes.numbers[COLUMN + i]), strip)


@inlined
def _read_squares(reach: NDArray[np.uint8], lanes: RayLanes, count: int) -> None:
    """Look up the side of the empty square before each ray: the one thing that takes each ray by itself."""
    for i in range(count):
        lanes.places[LANES + i] = reach[lanes.tables[i] + lanes.places[i]]


@inlined
def _leap_rays(lanes: RayLanes, count: int, limit: float, strip: Integer) -> bool:
    """Take each ray out of its empty square, without branches; return whether any moved.

    One that has ended (side 0) stays.
    """
    numbers, places, moved = lanes.numbers, lanes.places, 0
    for i in range(count):
        t, column, row = numbers[T + i], numbers[COLUMN + i], numbers[ROW + i]
        side = float(places[LANES + i]) if t < limit else 0.0
        right, top = column + side, row + side
        tx, ty = (right - numbers[X + i]) * numbers[INVERSE_X + i], (top - numbers[Y + i]) * numbers[INVERSE_Y + i]
        through_right = tx < ty
        leave = tx if through_right else ty
        # the cell after the leap touches the square: clamped, so that rounding and ties cannot cut a corner
        new_column = (
            right
            if through_right
            else _clamp_value(np.floor(numbers[X + i] + leave * numbers[DX + i]), column, right - 1.0)
        )
        new_row = (
            _clamp_value(np.floor(numbers[Y + i] + leave * numbers[DY + i]), row, top - 1.0) if through_right else top
        )
        ended = side == 0.0
        new_column, new_row = (column if ended else new_column), (row if ended else new_row)
        numbers[T + i] = t if ended else leave
        numbers[COLUMN + i], numbers[ROW + i] = new_column, new_row
        places[i] = tile_index(np.int32(new_row), np.int32(new_column), strip)
        moved |= int(side)
    return moved != 0


@inlined
def _clamp_value(value: float, low: float, high: float) -> float:
    """Return a value within bounds; what is no number is the greatest."""
    below = value if value <= high else high
    return below if below >= low else low


@borrowing
def plain_dda(
    stack: GridStack, g: Integer, pose: tuple[float, float, float], beams: Beams, ranges: NDArray[np.float32]
) -> None:
    """Fill ``ranges`` like ``cast_grid``, cell by cell (Amanatides and Woo 1987):
    the yardstick of tests and benchmarks.
    """
    x, y, theta = pose
    u, v = to_grid(stack, g, x, y)
    rows, columns = stack.shapes[g, 0], stack.shapes[g, 1]
    cells = stack.cells[stack.offsets[g] : stack.offsets[g] + rows * columns].reshape((rows, columns))
    limit, yaw = beams.range_max / stack.resolutions[g], theta - stack.origins[g, 2]
    c, s = math.cos(yaw), math.sin(yaw)
    for i in range(len(ranges)):
        dx = c * beams.cosines[i] - s * beams.sines[i] + 0.0
        dy = s * beams.cosines[i] + c * beams.sines[i] + 0.0
        step_x, step_y = (1 if dx >= 0.0 else -1), (1 if dy >= 0.0 else -1)
        per_column, per_row = abs(1.0 / dx), abs(1.0 / dy)
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
    pose: tuple[float, float, float], beams: Beams, disc: tuple[float, float, float], ranges: NDArray[np.float32]
) -> None:
    """Shorten ``ranges`` (B,) where a disc in ``map`` stands before what was hit; only the beams towards it are
    touched.

    A disc that is nowhere (NaN) is not seen.
    """
    centre_x, centre_y, radius = disc
    x, y, theta = pose
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
        first, last = _beam_range(beams, bearing - half + turn * 2.0 * math.pi, 2.0 * half)
        for i in range(first, last):
            along = px * beams.cosines[i] + py * beams.sines[i]
            across = px * beams.sines[i] - py * beams.cosines[i]
            chord = radius * radius - across * across
            if chord >= 0.0 and along > 0.0:
                _shorten_range(ranges, i, along - math.sqrt(chord), beams.range_max)


@borrowing
def cast_segments(
    pose: tuple[float, float, float], beams: Beams, segments: NDArray[np.float64], ranges: NDArray[np.float32]
) -> None:
    """Shorten ``ranges`` (B,) where ``segments`` (S, 2, 2), end points in ``map``, stand before what was hit."""
    x, y, theta = pose
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
            first, last = _beam_range(beams, bearing + turn * 2.0 * math.pi, abs(spread))
            for i in range(first, last):
                cross = beams.cosines[i] * qy - beams.sines[i] * qx
                if cross == 0.0:
                    continue
                share = (px * beams.sines[i] - py * beams.cosines[i]) / cross
                # neighbouring edges overlap by this much, so no beam slips through a corner
                if -1e-9 <= share <= 1.0 + 1e-9:
                    _shorten_range(ranges, i, (px * qy - py * qx) / cross, beams.range_max)


@inner
def _beam_range(beams: Beams, start: float, width: float) -> tuple[int, int]:
    """Return the half-open range of beams between the angles ``start`` and ``start + width``, a
    beam wider on both sides.
    """
    first = math.floor((start - beams.angle_min) / beams.angle_increment) - 1.0
    last = math.ceil((start + width - beams.angle_min) / beams.angle_increment) + 2.0
    count = len(beams.cosines)
    return int(min(max(first, 0.0), count)), int(min(max(last, 0.0), count))


@inner
def _shorten_range(ranges: NDArray[np.float32], i: int, t: float, range_max: float) -> None:
    if 0.0 <= t < range_max and t < ranges[i]:
        ranges[i] = t
