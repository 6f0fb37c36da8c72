"""Exact gaps between a body and the occupied cells of a grid, each a square; see ``arena_kernels.footprint``."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arena_kernels.compiled import borrowing, inner
from arena_kernels.costmap_window import HALF_DIAGONAL
from arena_kernels.footprint import NOTHING, Body, Gap, Points, hull_gap
from arena_kernels.grids import GridStack
from arena_kernels.scalars import Integer


class Walls(NamedTuple):
    """One grid of a stack: its distance field from ``offset`` on, its shape, and its place in ``map``."""

    distance: NDArray[np.float32]
    offset: Integer
    rows: Integer
    columns: Integer
    resolution: float
    x: float
    y: float
    cosine: float
    sine: float


@inner
def walls_of(stack: GridStack, g: Integer) -> Walls:
    """Return grid ``g`` of a stack."""
    return Walls(
        stack.distance,
        stack.offsets[g],
        stack.shapes[g, 0],
        stack.shapes[g, 1],
        stack.resolutions[g],
        stack.origins[g, 0],
        stack.origins[g, 1],
        stack.rotations[g, 0],
        stack.rotations[g, 1],
    )


@borrowing
def gap_to_cells(stack: GridStack, g: Integer, body: Body, within: float) -> Gap:
    """Return the gap between a body and the nearest occupied cell of grid ``g``, ``NOTHING``
    unless it is less than ``within``.
    """
    return gap_to_walls(walls_of(stack, g), body, within)


@inner
def gap_to_walls(walls: Walls, body: Body, within: float) -> Gap:
    """Return the gap between a body and the nearest occupied cell, ``NOTHING`` unless it is less than ``within``."""
    u, v = _to_cells(walls, body.at[0], body.at[1])
    nearest, away = _nearest_centre(walls, u, v)
    if nearest - away - HALF_DIAGONAL >= (within + body.radius) / walls.resolution:
        return NOTHING
    return _search_cells(walls, body, u, v, min(within / walls.resolution, nearest + away + 1e-6))


@inner
def walls_beyond(walls: Walls, x: float, y: float, reach: float) -> bool:
    """Return whether every occupied cell surely is farther than ``reach`` from a point; one
    look-up, for the many who are far away.
    """
    u, v = _to_cells(walls, x, y)
    nearest, away = _nearest_centre(walls, u, v)
    return bool(nearest - away - HALF_DIAGONAL >= reach / walls.resolution)


@inner
def _nearest_centre(walls: Walls, u: float, v: float) -> tuple[float, float]:
    """Return how far the cell of (u, v) is from the nearest occupied one, and (u, v)
    from that cell's centre, in cells.
    """
    column = np.int64(min(max(u, 0.0), walls.columns - 1.0))
    row = np.int64(min(max(v, 0.0), walls.rows - 1.0))
    nearest = walls.distance[walls.offset + row * walls.columns + column] / walls.resolution
    return nearest, math.sqrt((u - column - 0.5) ** 2 + (v - row - 0.5) ** 2)


@inner
def _to_cells(walls: Walls, x: float, y: float) -> tuple[float, float]:
    dx, dy = (x - walls.x) / walls.resolution, (y - walls.y) / walls.resolution
    return walls.cosine * dx + walls.sine * dy, walls.cosine * dy - walls.sine * dx


@inner
def _search_cells(walls: Walls, body: Body, u: float, v: float, within: float) -> Gap:
    """Walk the rows outwards from (u, v), and each row outwards, leaping by the distance field; lengths in cells."""
    radius, rounding = body.radius / walls.resolution, body.rounding / walls.resolution
    hull = body.points[2, : body.corners]
    for i in range(body.corners):
        hull[i, 0], hull[i, 1] = _to_cells(walls, body.points[1, i, 0], body.points[1, i, 1])
    first_row = np.int64(min(max(v, 0.0), walls.rows - 1.0))
    first_column = np.int64(min(max(u, 0.0), walls.columns - 1.0))
    beside = max(first_column - u, u - first_column - 1.0, 0.0)  # how far outside the grid
    best = (within, 0.0, 0.0, np.inf, np.inf)
    found = False
    for side in range(-1, 2, 2):
        row = first_row if side > 0 else first_row - 1
        while 0 <= row < walls.rows:
            dy = max(row - v, v - row - 1.0, 0.0)
            if dy >= best[0] + radius:
                break
            start = walls.offset + row * walls.columns
            half = math.sqrt((best[0] + radius) ** 2 - dy * dy)  # of the chord in which a nearer cell could lie
            # the row's middle cell sees the whole chord, up to the rim of the last cell
            if walls.distance[start + first_column] < (half + 1.0) * walls.resolution or beside > 0.0:
                for way in range(-1, 2, 2):
                    column = first_column if way > 0 else first_column - 1
                    while 0 <= column < walls.columns:
                        dx = max(column - u, u - column - 1.0, 0.0)
                        if dx * dx + dy * dy >= (best[0] + radius) ** 2:
                            break
                        free = walls.distance[start + column]
                        if free > 0.0:
                            column += way * np.int64(max(free / walls.resolution, 1.0))
                            continue
                        gap = _gap_to_cell(hull, rounding, column, row, body.points[3, :4])
                        if gap[0] < best[0]:
                            best, found = gap, True
                        column += way
            row += side
    return _to_map(walls, best) if found else NOTHING


@inner
def _gap_to_cell(hull: Points, rounding: float, column: Integer, row: Integer, square: Points) -> Gap:
    """Return the gap between a body and a cell, both in cells; ``square`` (4, 2) is scratch."""
    if len(hull) == 1:
        x, y = hull[0, 0], hull[0, 1]
        px, py = min(max(x, column), column + 1.0), min(max(y, row), row + 1.0)
        gap = math.sqrt((px - x) ** 2 + (py - y) ** 2)
        if gap > 0.0:
            return gap - rounding, (px - x) / gap, (py - y) / gap, px, py
    square[0, 0], square[0, 1] = column, row
    square[1, 0], square[1, 1] = column + 1, row
    square[2, 0], square[2, 1] = column + 1, row + 1
    square[3, 0], square[3, 1] = column, row + 1
    return hull_gap(hull, rounding, square)


@inner
def _to_map(walls: Walls, gap: Gap) -> Gap:
    """Turn a gap from the grid's frame in cells to ``map`` in m."""
    c, s = walls.cosine, walls.sine
    distance, nx, ny, px, py = gap
    x = walls.x + walls.resolution * (c * px - s * py)
    y = walls.y + walls.resolution * (s * px + c * py)
    return distance * walls.resolution, c * nx - s * ny, s * nx + c * ny, x, y
