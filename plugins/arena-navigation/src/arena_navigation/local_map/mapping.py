"""What scans have shown, as a grid to plan on: a map that grows, and marks put on a known one."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from arena_core import FREE, OCCUPIED, OccupancyGrid, Pose
from arena_kernels.distance import grid_distance
from arena_navigation.columns import X, Y
from arena_navigation.local_map.log_odds import LogOddsUpdate, update_log_odds
from arena_navigation.local_map.marks import NEVER, MarkedCells, MarkingRange, PlacedScan

_GROWTH = 5.0  # m by which the map grows beyond what is needed
_RIM = 1.0  # m of free plane around a goal


class ScanMap:
    """A map of all cells that more speaks for than against; it grows with what it has to hold.

    Cells never hit are free.
    """

    def __init__(self, resolution: float, reach: MarkingRange, evidence: LogOddsUpdate) -> None:
        self._resolution = resolution
        self._reach = reach
        self._evidence = evidence
        self._corner = (0, 0)  # in cells: row, column
        self._hit_at = np.empty((0, 0), np.float32)
        self._odds = np.empty((0, 0), np.float32)

    def update(self, beams: PlacedScan) -> None:
        """Take in one scan."""
        self._grow_to_hold(beams.sensor[X], beams.sensor[Y], min(self._reach.marking, beams.range_max))
        update_log_odds(
            self._odds, MarkedCells(self._hit_at, *self._corner, self._resolution), beams, self._reach, self._evidence
        )

    def grid(self, goal: Pose) -> OccupancyGrid:
        """Return the map as it is now, grown to hold ``goal``."""
        self._grow_to_hold(goal.x, goal.y, _RIM)
        data = np.where(self._odds > 0.0, OCCUPIED, FREE).astype(np.int8)
        return OccupancyGrid(
            data, self._resolution, Pose(self._corner[1] * self._resolution, self._corner[0] * self._resolution)
        )

    def _grow_to_hold(self, x: float, y: float, around: float) -> None:
        """Grow, if needed, so that all within ``around`` m of (x, y) is inside."""
        low = _cell_index((y - around, x - around), self._resolution)
        high = _cell_index((y + around, x + around), self._resolution) + 1
        corner, size = np.array(self._corner), np.array(self._hit_at.shape)
        if self._hit_at.size == 0:
            corner = low
        if (low >= corner).all() and (high <= corner + size).all():
            return
        margin = math.ceil(_GROWTH / self._resolution)
        new_corner = np.where(low < corner, low - margin, corner)
        new_end = np.where(high > corner + size, high + margin, corner + size)
        self._hit_at, self._odds = (
            _grow_cells(cells, new_end - new_corner, corner - new_corner) for cells in (self._hit_at, self._odds)
        )
        self._corner = int(new_corner[0]), int(new_corner[1])


def _grow_cells(cells: NDArray[np.float32], shape: NDArray[np.int64], place: NDArray[np.int64]) -> NDArray[np.float32]:
    """Return cells (H, W) at ``place`` (row, column) of a larger array that is otherwise NEVER."""
    grown = np.full(shape, NEVER, np.float32)
    grown[place[0] : place[0] + cells.shape[0], place[1] : place[1] + cells.shape[1]] = cells
    return grown


def with_marks(grid: OccupancyGrid, cells: NDArray[np.int64], resolution: float, *, all_marks: bool) -> OccupancyGrid:
    """Return ``grid`` with marked cells (K, 2) of column and row in the plane occupied; ``grid`` itself if all are on
    it already.

    Unless ``all_marks``, a mark beside an occupied cell is taken for that: a pose that is a little off narrows every
    door.
    """
    samples = max(1, math.ceil(resolution / grid.resolution - 1e-6))
    offsets = (np.stack(np.divmod(np.arange(samples**2), samples), axis=1) + 0.5) / samples
    marked = grid.cells(((cells[:, None] + offsets) * resolution).reshape(-1, 2))
    marked = marked[grid.contains(marked)]
    beside = 0.0 if all_marks else 1.5 * max(resolution, grid.resolution)
    marked = marked[grid.derive(grid_distance)[marked[:, 0], marked[:, 1]] > beside]
    if not len(marked):
        return grid
    data = grid.data.copy()
    data[marked[:, 0], marked[:, 1]] = OCCUPIED
    return OccupancyGrid(data, grid.resolution, grid.origin, grid.occupied_from)


def _cell_index(position_yx: tuple[float, float], resolution: float) -> NDArray[np.int64]:
    return np.floor(np.array(position_yx) / resolution).astype(np.int64)
