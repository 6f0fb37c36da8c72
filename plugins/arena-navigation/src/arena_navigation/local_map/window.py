"""Moving a window over the plane, and the static layer beneath it."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from arena_core import INSCRIBED, OccupancyGrid
from arena_kernels.compiled import borrowing, compiled, inner
from arena_kernels.distance import write_distances
from arena_navigation.columns import X, Y
from arena_navigation.local_map.marks import NEVER, MarkedCells, MarkingRange, PlacedScan, update_marks
from arena_navigation.planning.inflation import inflate_costs


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


def covered_cells(table: NDArray[np.uint8]) -> NDArray[np.int64]:
    """Return the offsets (K, 2) of the cells, row and column, whose marks block a robot's centre, by the
    table of ``Inflation.table``.
    """
    touching = int(np.flatnonzero(table >= INSCRIBED)[-1])
    reach = np.arange(-math.isqrt(touching), math.isqrt(touching) + 1)
    offsets = np.stack(np.meshgrid(reach, reach, indexing="ij"), axis=-1).reshape(-1, 2)
    squared = (offsets**2).sum(axis=1)
    nearest_first = np.argsort(squared, kind="stable")
    near: NDArray[np.int64] = offsets[nearest_first][squared[nearest_first] <= touching].astype(np.int64)
    return near


@borrowing
def move_window(
    hit_at: NDArray[np.float32],
    static: NDArray[np.uint8],
    moved: tuple[int, int],
    corner: tuple[int, int],
    keep: bool,
    layer: MapLayer,
    beams: PlacedScan,
    reach: MarkingRange,
) -> None:
    """Move the window, in place, by so many rows and columns to its new ``corner``, and take in a scan.

    Cells that stay inside are kept if ``keep``; those that come in take their static part from the map.
    """
    rows, columns = hit_at.shape
    down, left = moved if keep else (rows, columns)
    if down != 0 or left != 0:
        # the columns of which the window kept something
        first, end = max(-left, 0), max(min(columns - left, columns), 0)
        _shift_values(hit_at.reshape(-1), down * columns + left)  # as one row: what wraps round is new, and looked up
        _shift_values(static.reshape(-1), down * columns + left)
        for row in range(rows):
            known = 0 <= row + down < rows and first < end
            _read_static_cells(hit_at, static, layer, corner, row, 0, first if known else columns)
            _read_static_cells(hit_at, static, layer, corner, row, end if known else columns, columns)
    update_marks(MarkedCells(hit_at, corner[0], corner[1], layer.window_resolution), beams, reach)


@inner
def _shift_values(values: NDArray[Any], by: int) -> None:
    """Move ``values`` (K,) so that the first is what was at ``by``; those at the other end stay."""
    count = len(values) - abs(by)
    if by >= 0:
        for i in range(count):
            values[i] = values[np.uint64(i + by)]
    else:
        for i in range(len(values) - 1, len(values) - 1 - count, -1):
            values[np.uint64(i)] = values[np.uint64(i + by)]


@inner
def _read_static_cells(
    hit_at: NDArray[np.float32],
    static: NDArray[np.uint8],
    layer: MapLayer,
    corner: tuple[int, int],
    row: int,
    first: int,
    end: int,
) -> None:
    """Take the cells ``first`` to ``end`` of a row, which are new, from the map."""
    for column in range(first, end):
        hit_at[row, column] = NEVER
        static[row, column] = _on_map(layer, corner[0] + row, corner[1] + column)


@inner
def _on_map(layer: MapLayer, row: int, column: int) -> bool:
    """Return whether the map is occupied anywhere in a window cell; outside the map nothing is."""
    rows, columns = layer.occupied.shape
    if rows == 0:
        return False
    c, s = layer.rotation
    for i in range(layer.samples):
        y = (row + (i + 0.5) / layer.samples) * layer.window_resolution - layer.origin[Y]
        for j in range(layer.samples):
            x = (column + (j + 0.5) / layer.samples) * layer.window_resolution - layer.origin[X]
            map_column = math.floor((c * x + s * y) / layer.resolution)
            map_row = math.floor((c * y - s * x) / layer.resolution)
            if 0 <= map_row < rows and 0 <= map_column < columns and layer.occupied[map_row, map_column]:
                return True
    return False


@compiled
def costs_of(
    hit_at: NDArray[np.float32], static: NDArray[np.uint8], resolution: float, table: NDArray[np.uint8]
) -> tuple[NDArray[np.uint8], NDArray[np.float32]]:
    """Return costs (H, W) and distances (H, W), m, of the window."""
    distance = np.empty(hit_at.shape, np.float32)
    write_distances(blocked_cells(hit_at, static), resolution, distance)
    return inflate_costs(distance, resolution, table), distance


@borrowing
def is_path_blocked(
    hit_at: NDArray[np.float32],
    static: NDArray[np.uint8],
    corner: tuple[int, int],
    resolution: float,
    body: NDArray[np.int64],
    x: NDArray[np.float64],
    y: NDArray[np.float64],
    robot: tuple[float, float],
) -> bool:
    """Return whether a mark or the map lies under the ``body`` (offsets) on a path (K,), m, from the robot to
    the first that is outside.
    """
    rows, columns = hit_at.shape
    left, below = corner[1] * resolution, corner[0] * resolution
    first, least = 0, math.inf
    for k in range(len(x)):
        squared = (x[k] - robot[X]) ** 2 + (y[k] - robot[Y]) ** 2
        if squared < least:
            first, least = k, squared
    for k in range(first, len(x)):
        row, column = int((y[k] - below) / resolution), int((x[k] - left) / resolution)
        if not (0 <= row < rows and 0 <= column < columns):
            return False
        for i in range(len(body)):
            r, c = row + body[i, 0], column + body[i, 1]
            if 0 <= r < rows and 0 <= c < columns and (static[r, c] != 0 or hit_at[r, c] > NEVER):
                return True
    return False


@compiled
def blocked_cells(hit_at: NDArray[np.float32], static: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Return which cells are marked or occupied on the map."""
    rows, columns = hit_at.shape
    blocked = np.empty((rows, columns), np.uint8)
    for row in range(rows):
        for column in range(columns):
            blocked[row, column] = static[row, column] != 0 or hit_at[row, column] > NEVER
    return blocked
