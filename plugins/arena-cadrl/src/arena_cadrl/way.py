"""The target: the farthest point of the path ahead that can be seen past the walls."""

from __future__ import annotations

import math

from arena_cadrl.parameters import Floats
from arena_kernels.compiled import borrowing
from arena_kernels.paths import nearest_index
from arena_kernels.window import Outline, Window, distance_at

STEP = 0.1  # m between two looks along a line of sight


@borrowing
def in_sight(window: Window, x: float, y: float, to_x: float, to_y: float, needed: float) -> bool:
    """Tell whether a disc of radius ``needed`` fits along the straight line between two positions."""
    parts = max(1, math.ceil(math.hypot(to_x - x, to_y - y) / STEP))
    for k in range(1, parts + 1):  # noqa: SIM110 - kernels know no generators
        if distance_at(window, x + (to_x - x) * k / parts, y + (to_y - y) * k / parts) < needed:
            return False
    return True


@borrowing
def target_on(path: Floats, window: Window, outline: Outline, x: float, y: float, lookahead: float) -> tuple[float, float, float]:
    """Return the point of the path to drive to from (x, y), m, at most ``lookahead`` m on and in sight, and the way behind it, m."""
    first = nearest_index(path, x, y)
    found, along = first, 0.0
    for i in range(first + 1, len(path)):
        along += math.hypot(path[i, 0] - path[i - 1, 0], path[i, 1] - path[i - 1, 1])
        if along > 0.25 * lookahead and not in_sight(window, x, y, path[i, 0], path[i, 1], outline.inscribed_radius):
            break
        found = i
        if along >= lookahead:
            break
    behind = 0.0
    for i in range(found + 1, len(path)):
        behind += math.hypot(path[i, 0] - path[i - 1, 0], path[i, 1] - path[i - 1, 1])
    return path[found, 0], path[found, 1], behind
