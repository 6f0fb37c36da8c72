"""Where bodies have room: clearances, connected regions and lines of sight on known free cells."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from arena_core import OccupancyGrid
from arena_kernels.connected_components import connected_components
from arena_kernels.distance import distance_field


class FreeSpace:
    """The free cells of a grid and their ``clearance`` (H, W), m; meant for ``grid.derive(FreeSpace)``.

    Cells that are unknown count as blocked, and so does all that lies outside the grid: no one is placed behind a wall.
    """

    def __init__(self, grid: OccupancyGrid) -> None:
        free = (grid.data >= 0) & (grid.data < grid.occupied_from)
        self.grid = grid
        self.clearance = clearance_of(free, grid.resolution)

    def regions(self, clearance: float) -> NDArray[np.int32]:
        """Return a label for each cell, 0 where there is less ``clearance``; cells with equal
        labels are connected, (H, W).
        """
        return self.grid.derive(_Regions(clearance))

    def places(self, clearance: float) -> NDArray[np.float64]:
        """Return the centres of all cells with this much clearance, in ``map``, (N, 2)."""
        return self.grid.derive(_Places(clearance))

    def has_room(self, positions_xy: ArrayLike, clearance: float) -> NDArray[np.bool_]:
        """Tell at which positions (..., 2) there is this much clearance."""
        cells = self.grid.cells(positions_xy)
        inside = self.grid.contains(cells)
        rows, columns = np.where(inside, cells[..., 0], 0), np.where(inside, cells[..., 1], 0)
        return np.asarray(inside & (self.clearance[rows, columns] >= clearance))

    def is_visible(self, from_xy: NDArray[np.float64], to_xy: NDArray[np.float64], clearance: float) -> bool:
        """Return whether the straight way between two positions has this much clearance."""
        steps = int(np.hypot(*(to_xy - from_xy)) / (0.5 * self.grid.resolution)) + 2
        return bool(self.has_room(np.linspace(from_xy, to_xy, steps), clearance).all())


def clearance_of(free: NDArray[np.bool_], resolution: float) -> NDArray[np.float32]:
    """Return how far each cell's centre is from what is not free or outside, less half a cell, m; (H, W)."""
    blocked = np.pad(~free, 1, constant_values=True)
    return distance_field(blocked, resolution)[1:-1, 1:-1] - np.float32(0.5 * resolution)


@dataclass(frozen=True, slots=True)
class _Regions:
    """A key and function for ``grid.derive``: the connected regions with this much clearance."""

    clearance: float

    def __call__(self, grid: OccupancyGrid) -> NDArray[np.int32]:
        return connected_components(grid.derive(FreeSpace).clearance >= self.clearance)


@dataclass(frozen=True, slots=True)
class _Places:
    """A key and function for ``grid.derive``: the centres of cells with this much clearance."""

    clearance: float

    def __call__(self, grid: OccupancyGrid) -> NDArray[np.float64]:
        return grid.positions(np.argwhere(grid.derive(FreeSpace).clearance >= self.clearance))
