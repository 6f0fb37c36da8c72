"""How far a body is from what stands in world k, and from its people; thin kernels above ``arena_kernels.footprint``."""

from __future__ import annotations

import math

from arena_kernels.compiled import borrowing
from arena_kernels.footprint import NOTHING, Body, Gap, gap_to_cells, gap_to_disc, gap_to_polygon
from arena_sim2d.bodies import People
from arena_sim2d.scene import Obstacles, Scene


@borrowing
def gap_to_things(scene: Scene, k: int, body: Body, within: float) -> Gap:
    """Return the least gap between a body and all that stands in world k, ``NOTHING`` unless it is less than ``within``."""
    best = gap_to_cells(scene.stack, scene.grid_of[k], body, within)
    for index in range(obstacle_count(scene.obstacles, k)):
        gap = gap_to_obstacle(scene.obstacles, k, index, body, min(best[0], within))
        if gap[0] < best[0]:
            best = gap
    return best


@borrowing
def obstacle_count(obstacles: Obstacles, k: int) -> int:
    """Return how many obstacles world k has."""
    return int(obstacles.discs_of[k + 1] - obstacles.discs_of[k] + obstacles.rings_of[k + 1] - obstacles.rings_of[k])


@borrowing
def gap_to_obstacle(obstacles: Obstacles, k: int, index: int, body: Body, within: float) -> Gap:
    """Return the gap to obstacle ``index`` of world k, discs first, then polygons; ``NOTHING`` unless it is less than ``within``."""
    discs = obstacles.discs_of[k + 1] - obstacles.discs_of[k]
    if index < discs:
        d = obstacles.discs_of[k] + index
        return gap_to_round(body, obstacles.centres[d, 0], obstacles.centres[d, 1], obstacles.radii[d], within)
    r = obstacles.rings_of[k] + index - discs
    if _is_beyond(body, obstacles.bounds[r, 0], obstacles.bounds[r, 1], obstacles.bounds[r, 2], within):
        return NOTHING
    gap = gap_to_polygon(body, obstacles.points[obstacles.ring_starts[r] : obstacles.ring_starts[r + 1]])
    return gap if gap[0] < within else NOTHING


@borrowing
def gap_to_round(body: Body, x: float, y: float, radius: float, within: float) -> Gap:
    """Return the gap to a disc, ``NOTHING`` unless it is less than ``within``."""
    if _is_beyond(body, x, y, radius, within):
        return NOTHING
    gap = gap_to_disc(body, x, y, radius)
    return gap if gap[0] < within else NOTHING


@borrowing
def _is_beyond(body: Body, x: float, y: float, radius: float, within: float) -> bool:
    """Tell whether a disc surely is farther away than ``within``."""
    reach = within + body.radius + radius
    return bool(reach < 0.0 or (x - body.pose[0]) ** 2 + (y - body.pose[1]) ** 2 >= reach * reach)


@borrowing
def gap_to_people(people: People, k: int, body: Body, within: float) -> float:
    """Return the least gap to the people of world k, inf unless it is less than ``within``."""
    best = within
    for i in range(people.counts[k]):
        best = min(best, gap_to_round(body, people.positions[k, i, 0], people.positions[k, i, 1], people.radii[k, i], best)[0])
    return best if best < within else math.inf
