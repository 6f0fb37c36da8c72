"""How much room a path leaves a robot that follows it."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from arena_kernels.compiled import borrowing
from arena_kernels.costmap_window import CostmapWindow, Outline, distance_at
from arena_kernels.paths import nearest_index

AHEAD = 0.5  # m of path on which a passage counts, at least
KEPT = 0.7  # share of the room in a narrow passage that is kept: the rest is what a robot may be beside its path


@borrowing
def room_along(
    window: CostmapWindow, outline: Outline, path: NDArray[np.float64], at: tuple[float, float], ahead: float
) -> float:
    """Return the least gap, m, beside a robot that drives along ``path`` (M, 3), from its length behind (x, y) to
    ``ahead`` m beyond.

    It is that beside its sides, which of a car lie outside the circle inside its outline. A disc as wide as these is
    looked at: where the path bends, a robot need not. Negative where the path leads through an obstacle.
    """
    side = half_width(outline)
    x, y = at
    place = nearest_index(path, x, y)
    first, behind = place, 0.0
    while first > 0 and behind < outline.radius:
        behind += math.hypot(path[first, 0] - path[first - 1, 0], path[first, 1] - path[first - 1, 1])
        first -= 1
    room, way = math.inf, -behind
    for i in range(first, len(path)):
        free = distance_at(window, path[i, 0], path[i, 1])
        if free > -math.inf:  # beyond the window nothing is known
            room = min(room, free - side)
        if i + 1 < len(path):
            way += math.hypot(path[i + 1, 0] - path[i, 0], path[i + 1, 1] - path[i, 1])
        if way > ahead:
            break
    return room


@borrowing
def half_width(outline: Outline) -> float:
    """Return how far an outline reaches to its wider side, m."""
    side = outline.inscribed_radius
    for i in range(len(outline.points_xy)):
        side = max(side, abs(outline.points_xy[i, 1]))
    return side


@borrowing
def reduced_gap(wanted: float, room: float, share: float, least: float) -> float:
    """Return the gap, m, to keep on a path that leaves ``room`` m: what is ``wanted``, or a ``share`` of the room of at
    least ``least``.

    A path that leads through an obstacle asks for all that is wanted.
    """
    return wanted if room <= 0.0 else min(wanted, max(least, share * room))
