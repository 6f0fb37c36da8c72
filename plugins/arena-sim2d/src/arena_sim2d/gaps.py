"""How far bodies are from what stands in world k; thin kernels above ``arena_kernels.footprint``."""

from __future__ import annotations

import math

from numba import njit

from arena_kernels.footprint import Gap, gap_to_cells, gap_to_disc, gap_to_polygon
from arena_sim2d.bodies import Floats
from arena_sim2d.scene import Obstacles, Scene


@njit(cache=True)
def gap_to_obstacle(obstacles: Obstacles, k: int, index: int, hull: Floats, rounding: float) -> Gap:
    """Return the gap to obstacle ``index`` of world k: its discs come first, then its polygons."""
    discs = obstacles.discs_of[k + 1] - obstacles.discs_of[k]
    if index < discs:
        d = obstacles.discs_of[k] + index
        return gap_to_disc(hull, rounding, obstacles.centres[d, 0], obstacles.centres[d, 1], obstacles.radii[d])
    r = obstacles.rings_of[k] + index - discs
    return gap_to_polygon(hull, rounding, obstacles.points[obstacles.ring_starts[r] : obstacles.ring_starts[r + 1]])


@njit(cache=True)
def obstacle_count(obstacles: Obstacles, k: int) -> int:
    """Return how many obstacles world k has."""
    return int(obstacles.discs_of[k + 1] - obstacles.discs_of[k] + obstacles.rings_of[k + 1] - obstacles.rings_of[k])


@njit(cache=True)
def obstacle_may_be_within(obstacles: Obstacles, k: int, index: int, x: float, y: float, reach: float) -> bool:
    """Tell whether an obstacle may lie within ``reach`` of a point: by its bounding circle."""
    discs = obstacles.discs_of[k + 1] - obstacles.discs_of[k]
    if index < discs:
        d = obstacles.discs_of[k] + index
        bx, by, radius = obstacles.centres[d, 0], obstacles.centres[d, 1], obstacles.radii[d]
    else:
        r = obstacles.rings_of[k] + index - discs
        bx, by, radius = obstacles.bounds[r, 0], obstacles.bounds[r, 1], obstacles.bounds[r, 2]
    return bool((bx - x) ** 2 + (by - y) ** 2 < (reach + radius) ** 2)


@njit(cache=True)
def gap_to_things(scene: Scene, k: int, hull: Floats, rounding: float, x: float, y: float, radius: float, within: float) -> Gap:
    """Return the least gap between a body and all that stands in world k, ``NOTHING`` unless it is less than ``within``."""
    obstacles = scene.obstacles
    best = gap_to_cells(scene.stack, scene.grid_of[k], hull, rounding, x, y, radius, within)
    for index in range(obstacle_count(obstacles, k)):
        reach = min(best[0], within) + radius
        if reach == math.inf or obstacle_may_be_within(obstacles, k, index, x, y, reach):
            gap = gap_to_obstacle(obstacles, k, index, hull, rounding)
            if gap[0] < min(best[0], within):
                best = gap
    return best


@njit(cache=True)
def gap_to_people(count: int, positions: Floats, radii: Floats, hull: Floats, rounding: float, x: float, y: float, radius: float) -> float:
    """Return the least gap between a body and the people of a world, inf when there is none."""
    best = math.inf
    for i in range(count):
        centre = math.hypot(positions[i, 0] - x, positions[i, 1] - y)
        if centre - radius - radii[i] < best:
            best = min(best, gap_to_disc(hull, rounding, positions[i, 0], positions[i, 1], radii[i])[0])
    return best
