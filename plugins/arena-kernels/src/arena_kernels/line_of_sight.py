"""Many straight ways looked along at once: each look waits for memory, but not for the others."""

from __future__ import annotations

from math import sqrt

import numpy as np
from numpy.typing import NDArray

from arena_kernels.compiled import borrowing
from arena_kernels.ground import Ground, wall_clearance
from arena_kernels.slide_along import SIGHT

X, Y, DX, DY, LENGTH, NEEDED, WAY, SEEN = range(8)  # columns of a sight
COLUMNS = 8


@borrowing
def put_sight_line(
    ground: Ground, sight: NDArray[np.float64], line: tuple[float, float, float, float], room: float
) -> None:
    """Write the straight way from (x, y) that shall have this room (m) on both sides, see
    ``sliding.is_visible``, as a row (8,).
    """
    x, y, to_x, to_y = line
    sight[X], sight[Y], sight[DX], sight[DY] = x, y, to_x - x, to_y - y
    sight[LENGTH] = sqrt(sight[DX] * sight[DX] + sight[DY] * sight[DY])
    sight[NEEDED] = min(room, SIGHT * wall_clearance(ground, x, y), SIGHT * wall_clearance(ground, to_x, to_y))
    sight[WAY] = 0.0
    sight[SEEN] = 1.0 if sight[NEEDED] > 0.0 else 0.0


@borrowing
def check_sight_lines(ground: Ground, sights: NDArray[np.float64], count: int, open_ones: NDArray[np.int32]) -> None:
    """Tell in SEEN of the first ``count`` sights (S, 8) which ways are free: to the last bit what
    ``sliding.is_visible`` says of each.

    All sights go on by one stride in turn. ``open_ones`` (S,) is working memory.
    """
    least, left = 0.5 * ground.cell, 0
    for k in range(count):
        open_ones[left] = k
        left += sights[k, SEEN] > 0.0 and sights[k, LENGTH] > 0.0
    while left > 0:
        still = 0
        for place in range(left):
            k = open_ones[place]
            way, length = sights[k, WAY], sights[k, LENGTH]
            x, y = sights[k, X] + sights[k, DX] * way / length, sights[k, Y] + sights[k, DY] * way / length
            spare = wall_clearance(ground, x, y) - sights[k, NEEDED]
            sights[k, WAY] = way + max(spare, least)
            if spare < 0.0:
                sights[k, SEEN] = 0.0
            open_ones[still] = k
            still += spare >= 0.0 and sights[k, WAY] < length
        left = still
