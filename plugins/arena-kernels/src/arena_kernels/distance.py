"""Exact Euclidean distance transforms of grids."""

from __future__ import annotations

from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from arena_kernels.compiled import compiled


class Grid(Protocol):
    """What these kernels read of an occupancy grid; ``occupied`` has shape (H, W), ``resolution`` is in m."""

    @property
    def occupied(self) -> NDArray[np.bool_]:
        """Return which cells are occupied."""

    @property
    def resolution(self) -> float:
        """Return the side of a cell."""


def distance_field(blocked: NDArray[Any], resolution: float) -> NDArray[np.float32]:
    """Return the distance from each cell's centre to the centre of the nearest blocked cell, m, inf when none is; (H, W).

    Felzenszwalb and Huttenlocher, Distance Transforms of Sampled Functions, Theory of Computing 8, 2012.
    """
    cells = np.ascontiguousarray(blocked, dtype=np.bool_).view(np.uint8)
    field = np.empty(cells.shape, np.float32)
    _transform(cells, float(resolution), field)
    return field


def grid_distance(grid: Grid) -> NDArray[np.float32]:
    """Return the distance field of a grid's occupied cells; meant for ``grid.derive(grid_distance)``."""
    return distance_field(grid.occupied, grid.resolution)


@compiled
def _transform(cells: NDArray[np.uint8], resolution: float, field: NDArray[np.float32]) -> None:
    rows, columns = cells.shape
    none = rows + columns  # farther than any cell of the grid
    along = _distance_along_columns(cells, none)
    sites = np.empty(columns, np.int64)
    starts = np.empty(columns + 1, np.float64)
    for row in range(rows):
        _lower_envelope(along[row], none, sites, starts, resolution, field[row])


@compiled
def _distance_along_columns(cells: NDArray[np.uint8], none: int) -> NDArray[np.int32]:
    """Return how many rows away the nearest blocked cell of the same column is, ``none`` when there is no such cell."""
    rows, columns = cells.shape
    away = np.empty((rows, columns), np.int32)
    for column in range(columns):
        away[0, column] = 0 if cells[0, column] else none
    for row in range(1, rows):
        for column in range(columns):
            away[row, column] = 0 if cells[row, column] else min(away[row - 1, column] + 1, none)
    for row in range(rows - 2, -1, -1):
        for column in range(columns):
            away[row, column] = min(away[row, column], away[row + 1, column] + 1)
    return away


@compiled
def _lower_envelope(
    heights: NDArray[np.int32],
    none: int,
    sites: NDArray[np.int64],
    starts: NDArray[np.float64],
    resolution: float,
    out: NDArray[np.float32],
) -> None:
    """Evaluate the lower envelope of the parabolas (x - site)^2 + heights[site]^2 in every column; integers keep it exact."""
    last = -1
    for site in range(len(heights)):
        if heights[site] >= none:
            continue
        start = -np.inf
        height = float(heights[site]) ** 2 + float(site) ** 2
        while last >= 0:
            other = sites[last]
            start = (height - float(heights[other]) ** 2 - float(other) ** 2) / (2.0 * (site - other))
            if start > starts[last]:
                break
            last -= 1
        if last < 0:
            start = -np.inf
        last += 1
        sites[last] = site
        starts[last] = start
    if last < 0:
        out[:] = np.inf
        return
    starts[last + 1] = np.inf
    current = 0
    for column in range(len(out)):
        while starts[current + 1] < column:
            current += 1
        site = sites[current]
        squared = (column - site) ** 2 + np.int64(heights[site]) ** 2
        out[column] = np.sqrt(float(squared)) * resolution
