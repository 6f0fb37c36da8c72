"""How far along its path a robot can look past what stands in its rolling window."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from arena_kernels.compiled import borrowing
from arena_kernels.costmap_window import CostmapWindow, distance_at
from arena_kernels.paths import nearest_index

NEAR = 0.25  # of the lookahead, within which the path is followed whether it is seen or not


@borrowing
def in_sight(window: CostmapWindow, line: tuple[float, float, float, float], needed: float, step: float) -> bool:
    """Return whether a disc of radius ``needed`` fits along the straight line between two
    positions, looked at every ``step`` m.
    """
    x, y, to_x, to_y = line
    parts = max(1, math.ceil(math.hypot(to_x - x, to_y - y) / step))
    for k in range(1, parts + 1):
        if distance_at(window, x + (to_x - x) * k / parts, y + (to_y - y) * k / parts) < needed:
            return False
    return True


@borrowing
def farthest_in_sight(
    path: NDArray[np.float64], window: CostmapWindow, needed: float, x: float, y: float, lookahead: float, step: float
) -> int:
    """Return the row of ``path`` (M, 2 or more) to drive to from (x, y): at most ``lookahead`` m on, and
    beyond NEAR all in sight.
    """
    first = nearest_index(path, x, y)
    found, along = first, 0.0
    for i in range(first + 1, len(path)):
        along += math.hypot(path[i, 0] - path[i - 1, 0], path[i, 1] - path[i - 1, 1])
        if along > NEAR * lookahead and not in_sight(window, (x, y, path[i, 0], path[i, 1]), needed, step):
            break
        found = i
        if along >= lookahead:
            break
    return found
