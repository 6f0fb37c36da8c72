"""The target: the farthest point of the path ahead that can be seen past the walls."""

from __future__ import annotations

import math

from arena_cadrl.parameters import Floats
from arena_kernels.compiled import borrowing
from arena_kernels.costmap_window import CostmapWindow, Outline
from arena_kernels.lookahead import farthest_in_sight

STEP = 0.1  # m between two looks along a line of sight


@borrowing
def lookahead_target(
    path: Floats, window: CostmapWindow, outline: Outline, x: float, y: float, lookahead: float
) -> tuple[float, float, float]:
    """Return the point of the path to drive to from (x, y), m, at most ``lookahead`` m on and in
    sight, and the way behind it, m.
    """
    found = farthest_in_sight(path, window, outline.inscribed_radius, x, y, lookahead, STEP)
    behind = 0.0
    for i in range(found + 1, len(path)):
        behind += math.hypot(path[i, 0] - path[i - 1, 0], path[i, 1] - path[i - 1, 1])
    return path[found, 0], path[found, 1], behind
