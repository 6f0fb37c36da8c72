"""Which static points a pose is paired with: the nearest to its left and right, and all that are so near
that they are forced to count.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from arena_kernels.compiled import borrowing, compiled, inlined, inner
from arena_kernels.costmap_window import LETHAL, CostmapWindow, distance_at
from arena_kernels.footprint import point_gap
from arena_teb.clusters import FARTHEST, ROUNDED
from arena_teb.columns import THETA, X, Y
from arena_teb.polygons import Hulls
from arena_teb.problem import FloatArray

# m by which a point lies behind a pose that is inside a polygon: it then pushes the pose to the nearest side
BEHIND = 1e-3
FORCED_FROM = 2  # the first places are those of the nearest points to the left and right


class Reach(NamedTuple):
    """How far from a pose's origin static points count, m: at all, and in any case."""

    most: float
    forced: float


@compiled
def associate_points(band: FloatArray, window: CostmapWindow, hulls: Hulls, reach: Reach) -> FloatArray:
    """Return the static points (N, P, 2) of the poses of a band, inf where there is none; those of
    polygons, if there are polygons.
    """
    count, places = len(band), FORCED_FROM
    points = np.full((count, places, 2), np.inf)
    for k in range(count):
        if not -math.inf < distance_at(window, band[k, X], band[k, Y]) < reach.most:
            continue
        places = max(places, pair_pose(window, hulls, band[k], reach, points[k]))
    if places == FORCED_FROM:
        return points
    points = np.full((count, places, 2), np.inf)
    for k in range(count):
        if -math.inf < distance_at(window, band[k, X], band[k, Y]) < reach.most:
            pair_pose(window, hulls, band[k], reach, points[k])
    return points


@inner
def pair_pose(window: CostmapWindow, hulls: Hulls, pose: FloatArray, reach: Reach, found: FloatArray) -> int:
    """Write what counts for a pose into ``found`` (P, 2), as far as there is room; return how many places would do."""
    if len(hulls.starts) > 0:
        return pair_hulls(hulls, pose, reach, found)
    return pair_cells(window, pose, reach, found)


@borrowing
def pair_cells(window: CostmapWindow, pose: FloatArray, reach: Reach, found: FloatArray) -> int:
    """Pair a pose with the centres of lethal cells; of those forced to count only cells with a free neighbour do."""
    rows, columns = window.costs.shape
    x, y = pose[X], pose[Y]
    u, v = (x - window.origin_x) / window.resolution - 0.5, (y - window.origin_y) / window.resolution - 0.5
    cells = reach.most / window.resolution
    forced = (reach.forced / window.resolution) ** 2
    c, s = math.cos(pose[THETA]), math.sin(pose[THETA])
    left, right, places = cells * cells, cells * cells, FORCED_FROM
    for row in range(max(0, math.ceil(v - cells)), min(rows - 1, math.floor(v + cells)) + 1):
        dy = row - v
        following, last = max(0, math.ceil(u - cells)), min(columns - 1, math.floor(u + cells))
        while following <= last:
            column = following
            following = column + free_cells(window, row, column)
            if window.costs[row, column] < LETHAL:
                continue
            dx = column - u
            squared = dx * dx + dy * dy
            if squared < forced:
                if on_surface(window, row, column):
                    write_point(found, places, x + dx * window.resolution, y + dy * window.resolution)
                    places += 1
            elif c * dy - s * dx >= 0.0:
                if squared < left:
                    left = squared
                    write_point(found, 0, x + dx * window.resolution, y + dy * window.resolution)
            elif squared < right:
                right = squared
                write_point(found, 1, x + dx * window.resolution, y + dy * window.resolution)
    return places


@inlined
def free_cells(window: CostmapWindow, row: int, column: int) -> int:
    """Return how many cells further no cell of the row can be lethal before: as far as the
    nearest one is away, and at least 1.
    """
    return max(1, int(min(window.distance[row, column] / window.resolution - ROUNDED, FARTHEST)))


@inner
def on_surface(window: CostmapWindow, row: int, column: int) -> bool:
    """Return whether one of a cell's four neighbours is not lethal, or outside the window."""
    rows, columns = window.costs.shape
    if row == 0 or column == 0 or row == rows - 1 or column == columns - 1:
        return True
    across = min(window.costs[row, column - 1], window.costs[row, column + 1])
    return bool(min(across, window.costs[row - 1, column], window.costs[row + 1, column]) < LETHAL)


@borrowing
def pair_hulls(hulls: Hulls, pose: FloatArray, reach: Reach, found: FloatArray) -> int:
    """Pair a pose with the nearest points of polygons; inside one, with a point that
    pushes it out by the nearest side.
    """
    c, s = math.cos(pose[THETA]), math.sin(pose[THETA])
    left, right, places = reach.most, reach.most, FORCED_FROM
    for i in range(len(hulls.starts) - 1):
        gap, nx, ny = point_gap(hulls.corners[hulls.starts[i] : hulls.starts[i + 1]], pose[X], pose[Y])
        gap = max(gap, BEHIND)
        x, y = pose[X] - gap * nx, pose[Y] - gap * ny
        if gap < reach.forced:
            write_point(found, places, x, y)
            places += 1
        elif c * (y - pose[Y]) - s * (x - pose[X]) >= 0.0:
            if gap < left:
                left = gap
                write_point(found, 0, x, y)
        elif gap < right:
            right = gap
            write_point(found, 1, x, y)
    return places


@inner
def write_point(found: FloatArray, at: int, x: float, y: float) -> None:
    """Write a point, if there is room."""
    if at < len(found):
        found[at, X], found[at, Y] = x, y
