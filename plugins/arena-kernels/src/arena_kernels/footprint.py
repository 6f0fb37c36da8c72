"""Exact gaps between a body and cells, discs, segments and polygons.

A gap is ``(gap, nx, ny, px, py)``: the distance in m (negative: how deep the two overlap), the unit normal from the body to the
other, and the other's nearest point, in ``map``. ``NOTHING`` stands for nothing in reach. No kernel here allocates memory: what
cannot raise is compiled without reference counting.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arena_kernels.compiled import borrowing, inner
from arena_kernels.grids import GridStack
from arena_kernels.scalars import Integer

Gap = tuple[float, float, float, float, float]
HALF_DIAGONAL = 0.7072  # of a cell, rounded up
Points = NDArray[np.float64]

NOTHING: Gap = (math.inf, 0.0, 0.0, math.inf, math.inf)


class Body(NamedTuple):
    """A disc or a convex polygon: the convex hull of ``points[1, :corners]``, counter-clockwise in ``map``, grown by ``rounding`` m.

    One corner with a rounding is a disc; three or more corners without are a polygon, whose corners in its own frame are
    ``points[0, :corners]``. ``at`` (2,) is where its origin is, ``radius`` that of a disc about the origin that holds it. The rest
    of ``points`` (4, C, 2) is the kernels' own.
    """

    points: NDArray[np.float64]
    at: NDArray[np.float64]
    corners: int
    rounding: float
    radius: float


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


def make_body(vertices_xy: Points, radius: float) -> Body:
    """Return a body at the origin: a disc of ``radius``, or the convex polygon ``vertices_xy`` (V, 2), counter-clockwise, inside it."""
    vertices = np.asarray(vertices_xy, np.float64).reshape(-1, 2)
    corners = max(len(vertices), 1)
    points = np.zeros((4, max(corners, 4), 2))
    points[:2, : len(vertices)] = vertices
    return Body(points, np.zeros(2), corners, 0.0 if len(vertices) else float(radius), float(radius))


@inner
def disc_like(body: Body, radius: float) -> Body:
    """Return a disc of ``radius`` that uses the arrays of another disc."""
    return Body(body.points, body.at, 1, radius, radius)


@borrowing
def place(body: Body, x: float, y: float, theta: float) -> None:
    """Put a body at a pose."""
    body.at[0], body.at[1] = x, y
    c, s = (math.cos(theta), math.sin(theta)) if body.corners > 1 else (1.0, 0.0)
    for i in range(body.corners):
        px, py = body.points[0, i, 0], body.points[0, i, 1]
        body.points[1, i, 0], body.points[1, i, 1] = x + c * px - s * py, y + s * px + c * py


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
def gap_to_disc(body: Body, x: float, y: float, radius: float) -> Gap:
    """Return the gap between a body and a disc."""
    gap, nx, ny = _point_gap(body.points[1, : body.corners], x, y)
    return gap - body.rounding - radius, nx, ny, x - radius * nx, y - radius * ny


@borrowing
def gap_to_convex(body: Body, other: Points) -> Gap:
    """Return the gap between a body and the convex hull of ``other`` (K, 2), counter-clockwise: a segment or a polygon."""
    return _hull_gap(body.points[1, : body.corners], body.rounding, other)


@borrowing
def gap_to_polygon(body: Body, sides: NDArray[np.float64]) -> Gap:
    """Return the gap between a body and a simple polygon, convex or not; ``sides`` (K, 2, 2) are its sides' end points in order."""
    best = NOTHING
    for i in range(len(sides)):
        found = gap_to_convex(body, sides[i])
        if found[0] < best[0]:
            best = found
    if best[0] > -body.rounding and _inside(sides, body.points[1, 0, 0], body.points[1, 0, 1]):
        return -best[0] - 2.0 * body.rounding, -best[1], -best[2], best[3], best[4]
    return best


@borrowing
def gap_to_cells(stack: GridStack, g: Integer, body: Body, within: float) -> Gap:
    """Return the gap between a body and the nearest occupied cell of grid ``g``, ``NOTHING`` unless it is less than ``within``."""
    return gap_to_walls(walls_of(stack, g), body, within)


@inner
def gap_to_walls(walls: Walls, body: Body, within: float) -> Gap:
    """Return the gap between a body and the nearest occupied cell, ``NOTHING`` unless it is less than ``within``."""
    u, v = _to_cells(walls, body.at[0], body.at[1])
    nearest, away = _nearest_centre(walls, u, v)
    if nearest - away - HALF_DIAGONAL >= (within + body.radius) / walls.resolution:
        return NOTHING
    return _search(walls, body, u, v, min(within / walls.resolution, nearest + away + 1e-6))


@inner
def walls_beyond(walls: Walls, x: float, y: float, reach: float) -> bool:
    """Tell whether every occupied cell surely is farther than ``reach`` from a point; one look-up, for the many who are far away."""
    u, v = _to_cells(walls, x, y)
    nearest, away = _nearest_centre(walls, u, v)
    return bool(nearest - away - HALF_DIAGONAL >= reach / walls.resolution)


@inner
def _nearest_centre(walls: Walls, u: float, v: float) -> tuple[float, float]:
    """Return how far the cell of (u, v) is from the nearest occupied one, and (u, v) from that cell's centre, in cells."""
    column = np.int64(min(max(u, 0.0), walls.columns - 1.0))
    row = np.int64(min(max(v, 0.0), walls.rows - 1.0))
    nearest = walls.distance[walls.offset + row * walls.columns + column] / walls.resolution
    return nearest, math.sqrt((u - column - 0.5) ** 2 + (v - row - 0.5) ** 2)


@inner
def _to_cells(walls: Walls, x: float, y: float) -> tuple[float, float]:
    dx, dy = (x - walls.x) / walls.resolution, (y - walls.y) / walls.resolution
    return walls.cosine * dx + walls.sine * dy, walls.cosine * dy - walls.sine * dx


@inner
def _search(walls: Walls, body: Body, u: float, v: float, within: float) -> Gap:
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
    return _hull_gap(hull, rounding, square)


@inner
def _hull_gap(hull: Points, rounding: float, other: Points) -> Gap:
    """Return the gap between two convex hulls: the separating axis if they overlap, else the nearest vertex and side."""
    depth_a, ax, ay = _separation(hull, other)
    depth_b, bx, by = _separation(other, hull)
    if max(depth_a, depth_b) <= 0.0:
        depth, nx, ny = (depth_a, ax, ay) if depth_a > depth_b else (depth_b, -bx, -by)
        i = _support(other, -nx, -ny)
        return depth - rounding, nx, ny, other[i, 0], other[i, 1]
    best = NOTHING
    for i in range(len(other)):
        gap, nx, ny = _point_gap(hull, other[i, 0], other[i, 1])
        if gap < best[0]:
            best = (gap, nx, ny, other[i, 0], other[i, 1])
    for i in range(len(hull)):
        gap, nx, ny = _point_gap(other, hull[i, 0], hull[i, 1])
        if gap < best[0]:
            best = (gap, -nx, -ny, hull[i, 0] - gap * nx, hull[i, 1] - gap * ny)
    return best[0] - rounding, best[1], best[2], best[3], best[4]


@inner
def _to_map(walls: Walls, gap: Gap) -> Gap:
    """Turn a gap from the grid's frame in cells to ``map`` in m."""
    c, s = walls.cosine, walls.sine
    distance, nx, ny, px, py = gap
    x = walls.x + walls.resolution * (c * px - s * py)
    y = walls.y + walls.resolution * (s * px + c * py)
    return distance * walls.resolution, c * nx - s * ny, s * nx + c * ny, x, y


@inner
def _point_gap(hull: Points, x: float, y: float) -> tuple[float, float, float]:
    """Return the signed distance from a convex hull to a point and the unit normal towards the point; negative inside."""
    best, bx, by = np.inf, 0.0, 0.0
    inner, ix, iy = -np.inf, 0.0, 0.0
    for i in range(len(hull)):
        ax, ay = hull[i - 1, 0], hull[i - 1, 1]
        ex, ey = hull[i, 0] - ax, hull[i, 1] - ay
        dx, dy = x - ax, y - ay
        length = ex * ex + ey * ey
        share = min(max((dx * ex + dy * ey) / length, 0.0), 1.0) if length > 0.0 else 0.0
        qx, qy = dx - share * ex, dy - share * ey
        squared = qx * qx + qy * qy
        if squared < best:
            best, bx, by = squared, qx, qy
        if length > 0.0:
            norm = math.sqrt(length)
            outside = (dx * ey - dy * ex) / norm
            if outside > inner:
                inner, ix, iy = outside, ey / norm, -ex / norm
    if len(hull) > 2 and inner <= 0.0:
        return inner, ix, iy
    distance = math.sqrt(best)
    if distance > 0.0:
        return distance, bx / distance, by / distance
    return 0.0, ix, iy


@inner
def _separation(hull: Points, other: Points) -> tuple[float, float, float]:
    """Return the widest separation of two hulls along the edge normals of the first, and that normal."""
    best, nx, ny = -np.inf, 0.0, 0.0
    for i in range(len(hull) if len(hull) > 2 else 2 * (len(hull) - 1)):  # a segment has a normal on either side, a point none
        j, k = (i - 1, i) if len(hull) > 2 else (i, 1 - i)
        ex, ey = hull[k, 0] - hull[j, 0], hull[k, 1] - hull[j, 1]
        length = math.sqrt(ex * ex + ey * ey)
        if length == 0.0:
            continue
        ux, uy = ey / length, -ex / length
        s = _support(other, -ux, -uy)
        separation = (other[s, 0] - hull[k, 0]) * ux + (other[s, 1] - hull[k, 1]) * uy
        if separation > best:
            best, nx, ny = separation, ux, uy
    return best, nx, ny


@inner
def _support(points: Points, nx: float, ny: float) -> int:
    """Return which point lies farthest along (nx, ny)."""
    best, index = -np.inf, 0
    for i in range(len(points)):
        along = points[i, 0] * nx + points[i, 1] * ny
        if along > best:
            best, index = along, i
    return index


@inner
def _inside(sides: NDArray[np.float64], x: float, y: float) -> bool:
    """Tell whether a point lies inside a simple polygon (crossing number)."""
    inside = False
    for i in range(len(sides)):
        ax, ay, bx, by = sides[i, 0, 0], sides[i, 0, 1], sides[i, 1, 0], sides[i, 1, 1]
        if (ay > y) != (by > y) and x < ax + (y - ay) * (bx - ax) / (by - ay):
            inside = not inside
    return inside
