"""Where a path leads into a narrow place, and how a robot may stand there."""

from __future__ import annotations

import math

import numpy as np

from arena_dwa.columns import X, Y
from arena_dwa.settings import Body, BodyOnWindow, FloatArray
from arena_kernels.compiled import borrowing, compiled
from arena_kernels.costmap_window import CostmapWindow, distance_at, outline_clearance
from arena_kernels.paths import nearest_index

NEAREST, FARTHEST = 0.1, 1.0  # m along the path, between which its narrow place is looked for
ENOUGH = 0.15  # m of gap, beyond which more is worth nothing
SHARE = 0.15  # m of path to either side, over which its direction is taken
HEADINGS = np.linspace(-0.6, 0.6, 25)  # rad off the path's direction
ASIDE = np.linspace(-0.06, 0.06, 7)  # m beside the path


@compiled
def fitting_poses(
    ground: BodyOnWindow,
    path: FloatArray,
    at: tuple[float, float],
    gear: float,
    headings: FloatArray,
    aside: FloatArray,
) -> FloatArray:
    """Return x, y (m), heading (rad) and gap (m) of poses (K, 4) that keep the padding at the entrance ahead of (x, y).

    They lie ``aside`` (m) of ``path`` (M, 3), ``headings`` (rad) off its direction, or off the opposite one where
    ``gear`` is -1.
    """
    x, y = at
    place = entrance_index(ground.window, ground.body, path, x, y)
    before, after = index_at(path, place, -SHARE), index_at(path, place, SHARE)
    direction = math.atan2(gear * (path[after, Y] - path[before, Y]), gear * (path[after, X] - path[before, X]))
    ends, count = np.empty((len(headings) * len(aside), 4)), 0
    for off in aside:
        px, py = path[place, X] - off * math.sin(direction), path[place, Y] + off * math.cos(direction)
        for turn in headings:
            theta = direction + turn
            gap = outline_clearance(
                ground.window, ground.body.outline, (px, py, math.cos(theta), math.sin(theta)), ENOUGH
            )
            if gap >= ground.body.padding:
                ends[count] = px, py, theta, min(gap, ENOUGH)
                count += 1
    return ends[:count]


@borrowing
def entrance_index(window: CostmapWindow, body: Body, path: FloatArray, x: float, y: float) -> int:
    """Return the index of the first place ahead on ``path`` (M, 3) that is about as narrow as any; the
    farthest where all are wide.
    """
    here = nearest_index(path, x, y)
    first, last = index_at(path, here, NEAREST), index_at(path, here, FARTHEST)
    least = math.inf
    for i in range(first, last + 1):
        free = distance_at(window, path[i, X], path[i, Y])
        if free > -math.inf:  # beyond the window nothing is known
            least = min(least, free)
    if least >= body.outline.radius + ENOUGH:
        return last
    for i in range(first, last):
        if -math.inf < distance_at(window, path[i, X], path[i, Y]) <= least + window.resolution:
            return i
    return last


@borrowing
def index_at(path: FloatArray, place: int, way: float) -> int:
    """Return the first index of ``path`` (M, 3) that is ``way`` m beyond ``place``, or before it where that
    is negative; else its end.
    """
    step = 1 if way > 0.0 else -1
    left = abs(way)
    while left > 0.0 and 0 <= place + step < len(path):
        left -= math.hypot(path[place + step, X] - path[place, X], path[place + step, Y] - path[place, Y])
        place += step
    return place
