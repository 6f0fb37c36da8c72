"""Exact gaps between a body and discs, segments and polygons; those to the cells of a grid are in
``arena_kernels.walls``.

A gap is ``(gap, nx, ny, px, py)``: the distance in m (negative: how deep the two overlap), the unit normal from the
body to the other, and the other's nearest point, in ``map``. ``NOTHING`` stands for nothing in reach. No kernel here
allocates memory: what cannot raise is compiled without reference counting.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arena_kernels.compiled import borrowing, inner

Gap = tuple[float, float, float, float, float]
Points = NDArray[np.float64]

NOTHING: Gap = (math.inf, 0.0, 0.0, math.inf, math.inf)


class Body(NamedTuple):
    """A disc or a convex polygon: the convex hull of ``points[1, :corners]``, counter-clockwise in ``map``, grown by
    ``rounding`` m.

    One corner with a rounding is a disc; three or more corners without are a polygon, whose corners in its own frame
    are ``points[0, :corners]``. ``at`` (2,) is where its origin is, ``radius`` that of a disc about the origin that
    holds it. The rest of ``points`` (4, C, 2) is the kernels' own.
    """

    points: NDArray[np.float64]
    at: NDArray[np.float64]
    corners: int
    rounding: float
    radius: float


def make_body(vertices_xy: Points, radius: float) -> Body:
    """Return a body at the origin: a disc of ``radius``, or the convex polygon ``vertices_xy`` (V, 2),
    counter-clockwise, inside it.
    """
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
def place_body(body: Body, x: float, y: float, theta: float) -> None:
    """Put a body at a pose."""
    body.at[0], body.at[1] = x, y
    c, s = (math.cos(theta), math.sin(theta)) if body.corners > 1 else (1.0, 0.0)
    for i in range(body.corners):
        px, py = body.points[0, i, 0], body.points[0, i, 1]
        body.points[1, i, 0], body.points[1, i, 1] = x + c * px - s * py, y + s * px + c * py


@borrowing
def gap_to_disc(body: Body, x: float, y: float, radius: float) -> Gap:
    """Return the gap between a body and a disc."""
    gap, nx, ny = point_gap(body.points[1, : body.corners], x, y)
    return gap - body.rounding - radius, nx, ny, x - radius * nx, y - radius * ny


@borrowing
def gap_to_convex(body: Body, other: Points) -> Gap:
    """Return the gap between a body and the convex hull of ``other`` (K, 2),
    counter-clockwise: a segment or a polygon.
    """
    return hull_gap(body.points[1, : body.corners], body.rounding, other)


@borrowing
def gap_to_polygon(body: Body, sides: NDArray[np.float64]) -> Gap:
    """Return the gap between a body and a simple polygon, convex or not; ``sides`` (K, 2, 2) are
    its sides' end points in order.
    """
    best = NOTHING
    for i in range(len(sides)):
        found = gap_to_convex(body, sides[i])
        if found[0] < best[0]:
            best = found
    if best[0] > -body.rounding and _is_inside(sides, body.points[1, 0, 0], body.points[1, 0, 1]):
        return -best[0] - 2.0 * body.rounding, -best[1], -best[2], best[3], best[4]
    return best


@inner
def hull_gap(hull: Points, rounding: float, other: Points) -> Gap:
    """Return the gap between two convex hulls: the separating axis if they overlap,
    else the nearest vertex and side.
    """
    depth_a, ax, ay = _widest_separation(hull, other)
    depth_b, bx, by = _widest_separation(other, hull)
    if max(depth_a, depth_b) <= 0.0:
        depth, nx, ny = (depth_a, ax, ay) if depth_a > depth_b else (depth_b, -bx, -by)
        i = _support_vertex(other, -nx, -ny)
        return depth - rounding, nx, ny, other[i, 0], other[i, 1]
    best = NOTHING
    for i in range(len(other)):
        gap, nx, ny = point_gap(hull, other[i, 0], other[i, 1])
        if gap < best[0]:
            best = (gap, nx, ny, other[i, 0], other[i, 1])
    for i in range(len(hull)):
        gap, nx, ny = point_gap(other, hull[i, 0], hull[i, 1])
        if gap < best[0]:
            best = (gap, -nx, -ny, hull[i, 0] - gap * nx, hull[i, 1] - gap * ny)
    return best[0] - rounding, best[1], best[2], best[3], best[4]


@inner
def point_gap(hull: Points, x: float, y: float) -> tuple[float, float, float]:
    """Return the signed distance from a convex hull to a point and the unit normal
    towards the point; negative inside.
    """
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
def _widest_separation(hull: Points, other: Points) -> tuple[float, float, float]:
    """Return the widest separation of two hulls along the edge normals of the first, and that normal."""
    best, nx, ny = -np.inf, 0.0, 0.0
    # a segment has a normal on either side, a point none
    for i in range(len(hull) if len(hull) > 2 else 2 * (len(hull) - 1)):
        j, k = (i - 1, i) if len(hull) > 2 else (i, 1 - i)
        ex, ey = hull[k, 0] - hull[j, 0], hull[k, 1] - hull[j, 1]
        length = math.sqrt(ex * ex + ey * ey)
        if length == 0.0:
            continue
        ux, uy = ey / length, -ex / length
        s = _support_vertex(other, -ux, -uy)
        separation = (other[s, 0] - hull[k, 0]) * ux + (other[s, 1] - hull[k, 1]) * uy
        if separation > best:
            best, nx, ny = separation, ux, uy
    return best, nx, ny


@inner
def _support_vertex(points: Points, nx: float, ny: float) -> int:
    """Return which point lies farthest along (nx, ny)."""
    best, index = -np.inf, 0
    for i in range(len(points)):
        along = points[i, 0] * nx + points[i, 1] * ny
        if along > best:
            best, index = along, i
    return index


@inner
def _is_inside(sides: NDArray[np.float64], x: float, y: float) -> bool:
    """Return whether a point lies inside a simple polygon (crossing number)."""
    inside = False
    for i in range(len(sides)):
        ax, ay, bx, by = sides[i, 0, 0], sides[i, 0, 1], sides[i, 1, 0], sides[i, 1, 1]
        if (ay > y) != (by > y) and x < ax + (y - ay) * (bx - ax) / (by - ay):
            inside = not inside
    return inside
