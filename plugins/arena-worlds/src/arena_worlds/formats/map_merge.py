"""Several maps as one: what is occupied in any of them is occupied."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from arena_core import UNKNOWN, InputFileError, OccupancyGrid, Pose
from arena_core.files import LIMITS

ROUNDING = 1e-6  # of a cell, by which a map may seem larger than it is


def merge_maps(grids: Sequence[OccupancyGrid], name: str) -> OccupancyGrid:
    """Return a grid that covers all, on the finest cells and in the frame of the first: each cell has the highest value
    of any map there.

    A cell is unknown where every map has it unknown or does not reach. A map of its own frame and cells is kept value
    for value; of one that lies between the cells, every cell counts wherever its centre or that of the new cell lies.
    Raises InputFileError, which calls the maps ``name``, where together they are too large.
    """
    frame, resolution = grids[0].origin, min(grid.resolution for grid in grids)
    corners = np.concatenate([_in_frame(_map_corners(grid), frame) for grid in grids]) / resolution
    low = np.floor(corners.min(axis=0) + ROUNDING)
    columns, rows = (np.ceil(corners.max(axis=0) - ROUNDING) - low).astype(int)
    if rows * columns > LIMITS.cells:
        raise InputFileError(
            f"{name}: its layers together have {columns} x {rows} cells; allowed: {LIMITS.cells} in all"
        )
    origin = frame.compose(Pose(*(low * resolution).tolist()))
    whole = OccupancyGrid(np.full((rows, columns), UNKNOWN, np.int8), resolution, origin, grids[0].occupied_from)
    data = np.array(whole.data)
    for grid in grids:
        _overlay_map(grid, whole, data)
    return OccupancyGrid(data, resolution, origin, grids[0].occupied_from)


def _overlay_map(grid: OccupancyGrid, whole: OccupancyGrid, data: NDArray[np.int8]) -> None:
    """Raise the cells ``data`` of ``whole`` to what a map has there."""
    cells = grid.cells(whole.positions(np.moveaxis(np.indices(data.shape), 0, -1)))
    there = grid.contains(cells)
    data[there] = np.maximum(data[there], grid.data[tuple(cells[there].T)])
    if not (grid.origin.theta == whole.origin.theta and grid.resolution == whole.resolution):
        rows, columns = whole.cells(grid.positions(np.argwhere(grid.occupied))).T
        data[rows, columns] = np.maximum(data[rows, columns], grid.data[grid.occupied])


def _map_corners(grid: OccupancyGrid) -> NDArray[np.float64]:
    """Return the corners of a map, (4, 2) m, in ``map``."""
    rows, columns = grid.data.shape
    width, height = columns * grid.resolution, rows * grid.resolution
    return np.array([grid.origin.compose(Pose(x, y)).array()[:2] for x in (0.0, width) for y in (0.0, height)])


def _in_frame(points: NDArray[np.float64], frame: Pose) -> NDArray[np.float64]:
    """Return points (N, 2) of ``map`` as seen from a pose."""
    cos, sin = math.cos(frame.theta), math.sin(frame.theta)
    return np.asarray((points - (frame.x, frame.y)) @ np.array(((cos, -sin), (sin, cos))))
