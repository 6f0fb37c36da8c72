"""The grids of N worlds as the kernels read them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from arena_kernels.grids import PlacedGrid, stack_grids
from arena_kernels.ground import layouts_of
from arena_kernels.route_grid import RoomStack, stack_rooms
from arena_kernels.routes import nodes_for


class Terrain:
    """Which grid each world has; ``index`` (N,) points into ``layouts`` and ``rooms``. Packed anew only when a grid is not there yet."""

    index: NDArray[np.int64]
    distance: NDArray[np.float32]
    layouts: NDArray[np.void]
    rooms: RoomStack
    nodes: NDArray[np.int32]

    def __init__(self, cell: float) -> None:
        self._cell = cell
        self._grids: list[PlacedGrid] = []
        self._places: dict[int, int] = {}

    def replace(self, slots: NDArray[np.int64], grids: Sequence[PlacedGrid], total: int) -> None:
        """Give these slots of ``total`` worlds new grids; worlds that have none yet get the first."""
        if not self._grids:
            self._grids = [grids[0]] * total
        for slot, grid in zip(slots, grids, strict=True):
            self._grids[int(slot)] = grid
        if any(id(grid) not in self._places for grid in grids):
            self._pack()
        self.index = np.array([self._places[id(grid)] for grid in self._grids], np.int64)

    def _pack(self) -> None:
        self._packed = list({id(grid): grid for grid in self._grids}.values())  # kept, so that no id is used again
        self._places = {id(grid): place for place, grid in enumerate(self._packed)}
        stack, _ = stack_grids(self._packed)
        self.distance, self.layouts = stack.distance, layouts_of(stack)
        self.rooms = stack_rooms(self._packed, self._cell)
        self.nodes = nodes_for(self.rooms)
