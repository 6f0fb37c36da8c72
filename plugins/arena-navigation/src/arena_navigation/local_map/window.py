"""Moving a window over the plane, and the static layer beneath it."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arena_core import OccupancyGrid
from arena_kernels.compiled import compiled
from arena_kernels.distance import write_distances
from arena_navigation.local_map.marks import NEVER, Beams, Reach, take_in
from arena_navigation.planning.inflation import inflate


class MapLayer(NamedTuple):
    """The known map as the window reads it: ``occupied`` (H, W), where its corner lies, and its rotation.

    ``samples`` points along each side of a window cell are looked up, so that no cell of a finer map is missed.
    """

    occupied: NDArray[np.bool_]
    resolution: float
    origin: tuple[float, float]
    rotation: tuple[float, float]
    window_resolution: float
    samples: int

    @staticmethod
    def of(grid: OccupancyGrid | None, window_resolution: float) -> MapLayer:
        """Prepare a map, or nothing."""
        if grid is None:
            nothing = np.zeros((0, 0), np.bool_)
            nothing.flags.writeable = False  # as those of maps are: the compiled code is the same
            return MapLayer(nothing, float(window_resolution), (0.0, 0.0), (1.0, 0.0), float(window_resolution), 1)
        corner = float(grid.origin.x), float(grid.origin.y)
        rotation = math.cos(grid.origin.theta), math.sin(grid.origin.theta)
        samples = max(1, math.ceil(window_resolution / grid.resolution - 1e-6))
        return MapLayer(grid.occupied, float(grid.resolution), corner, rotation, float(window_resolution), samples)


@compiled
def shifted(
    hit_at: NDArray[np.float32],
    static: NDArray[np.uint8],
    down: int,
    left: int,
    row0: int,
    column0: int,
    keep: bool,
    layer: MapLayer,
) -> tuple[NDArray[np.float32], NDArray[np.uint8]]:
    """Return the window moved by (down, left) cells to the corner (row0, column0); cells that stay inside are kept if ``keep``."""
    rows, columns = hit_at.shape
    moved_hits = np.empty((rows, columns), np.float32)
    moved_static = np.empty((rows, columns), np.uint8)
    for row in range(rows):
        old_row = row + down
        for column in range(columns):
            old_column = column + left
            if keep and 0 <= old_row < rows and 0 <= old_column < columns:
                moved_hits[row, column] = hit_at[old_row, old_column]
                moved_static[row, column] = static[old_row, old_column]
            else:
                moved_hits[row, column] = NEVER
                moved_static[row, column] = _on_map(layer, row0 + row, column0 + column)
    return moved_hits, moved_static


@compiled
def _on_map(layer: MapLayer, row: int, column: int) -> bool:
    """Tell whether the map is occupied anywhere in a window cell; outside the map nothing is."""
    rows, columns = layer.occupied.shape
    if rows == 0:
        return False
    c, s = layer.rotation
    for i in range(layer.samples):
        y = (row + (i + 0.5) / layer.samples) * layer.window_resolution - layer.origin[1]
        for j in range(layer.samples):
            x = (column + (j + 0.5) / layer.samples) * layer.window_resolution - layer.origin[0]
            map_column = math.floor((c * x + s * y) / layer.resolution)
            map_row = math.floor((c * y - s * x) / layer.resolution)
            if 0 <= map_row < rows and 0 <= map_column < columns and layer.occupied[map_row, map_column]:
                return True
    return False


@compiled
def window_with(
    hit_at: NDArray[np.float32],
    static: NDArray[np.uint8],
    corner: tuple[int, int],
    resolution: float,
    beams: Beams,
    reach: Reach,
    table: NDArray[np.uint8],
) -> tuple[NDArray[np.uint8], NDArray[np.float32]]:
    """Take in a scan, and return costs (H, W) and distances (H, W), m, of the window whose corner is (row, column)."""
    take_in(hit_at, corner[0], corner[1], resolution, beams, reach)
    distance = np.empty(hit_at.shape, np.float32)
    write_distances(blocked_cells(hit_at, static), resolution, distance)
    return inflate(distance, resolution, table), distance


@compiled
def blocked_cells(hit_at: NDArray[np.float32], static: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Return which cells are marked or occupied on the map."""
    rows, columns = hit_at.shape
    blocked = np.empty((rows, columns), np.uint8)
    for row in range(rows):
        for column in range(columns):
            blocked[row, column] = static[row, column] != 0 or hit_at[row, column] > NEVER
    return blocked
