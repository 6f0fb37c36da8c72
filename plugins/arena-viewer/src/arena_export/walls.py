"""A map's walls as line segments."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from arena_core import OccupancyGrid

Bools = NDArray[np.bool_]


def wall_segments(grid: OccupancyGrid) -> NDArray[np.float64]:
    """Return (K, 4) x1, y1, x2, y2 m, ``map`` frame: the straight sides of all occupied areas, each once.

    A side lies on the border between an occupied cell and one that is not, and is as long as it goes straight on. What
    is outside the map is not occupied.
    """
    occupied = np.pad(grid.occupied, 1)
    flat = _sides(occupied[1:, 1:-1] != occupied[:-1, 1:-1])  # line, first, last: along the rows
    upright = _sides((occupied[1:-1, 1:] != occupied[1:-1, :-1]).T)
    cells = np.concatenate(
        [flat[:, [1, 0, 2, 0]], upright[:, [0, 1, 0, 2]]]  # as column, row of both ends
    )
    x, y = cells[:, ::2] * grid.resolution, cells[:, 1::2] * grid.resolution
    origin = grid.origin
    cosine, sine = np.cos(origin.theta), np.sin(origin.theta)
    across, up = origin.x + cosine * x - sine * y, origin.y + sine * x + cosine * y
    return np.stack([across[:, 0], up[:, 0], across[:, 1], up[:, 1]], axis=1)


def _sides(border: Bools) -> NDArray[np.int64]:
    """Return (K, 3) line, first and last corner of the runs of true values in each line."""
    padded = np.pad(border, ((0, 0), (1, 1))).astype(np.int8)
    steps = np.diff(padded, axis=1)
    lines, firsts = np.nonzero(steps == 1)
    _, lasts = np.nonzero(steps == -1)
    return np.stack([lines, firsts, lasts], axis=1)
