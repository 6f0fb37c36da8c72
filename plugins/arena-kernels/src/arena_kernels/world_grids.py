"""The grids of N worlds as the kernels read them."""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy

import numpy as np
from numpy.typing import NDArray

from arena_kernels.grids import GridStack, PlacedGrid
from arena_kernels.ground import GroundStack, layouts_of
from arena_kernels.pool import GridPool
from arena_kernels.route_grid import CoarseGridStack, stack_coarse_grids
from arena_kernels.routes import nodes_for


class WorldGrids:
    """Which grid each world has, and its rooms, one for each of the grids.

    Packed again only when a grid is not there yet.
    """

    land: GroundStack
    rooms: CoarseGridStack
    nodes: NDArray[np.int32]

    def __init__(self, cell: float) -> None:
        self._cell = cell
        self._grids: list[PlacedGrid] = []
        self._pool = GridPool()
        self._stack: GridStack | None = None

    def replace(self, slots: NDArray[np.int64], grids: Sequence[PlacedGrid], total: int) -> None:
        """Give these slots of ``total`` worlds new grids; worlds that have none yet get the first."""
        if not self._grids:
            self._grids = [grids[0]] * total
        for slot, grid in zip(slots, grids, strict=True):
            self._grids[int(slot)] = grid
        places = self._pool.place(self._grids)
        if self._pool.stack is self._stack:
            self.land = self.land._replace(grids=places)
        else:
            self._set_stack(places, self._pool.stack)

    def fork(self, slots: NDArray[np.int64]) -> WorldGrids:
        """Return the grids of these worlds (K,), packed where they are."""
        forked = copy(self)
        grids = [self._grids[slot] for slot in slots]
        vars(forked).update(_grids=grids, land=self.land._replace(grids=self.land.grids[slots]))
        return forked

    def _set_stack(self, places: NDArray[np.int64], stack: GridStack) -> None:
        self._stack = stack
        self.land = GroundStack(places, stack.distance, layouts_of(stack))
        self.rooms = stack_coarse_grids(self._pool.grids, self._cell)
        self.nodes = nodes_for(self.rooms)
