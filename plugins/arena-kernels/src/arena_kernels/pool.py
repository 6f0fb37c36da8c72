"""A grid stack that grows with the worlds that begin, so that one new world does not copy all others."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from arena_kernels.grids import GridStack, PlacedGrid, aligned_buffer, stack_grids, table_size

FLAT = ("cells", "distance", "reach")


class GridPool:
    """Packs grids as they come into use; ``stack`` holds those in use, and earlier ones until their room is needed."""

    stack: GridStack

    def __init__(self) -> None:
        self._grids: list[PlacedGrid] = []  # in the order of the stack; kept, so that no id is used again
        self._places: dict[int, int] = {}  # of each in the stack, by its id

    @property
    def grids(self) -> Sequence[PlacedGrid]:
        """Return the grids in the order of the stack."""
        return self._grids

    def place(self, grids: Sequence[PlacedGrid]) -> NDArray[np.int64]:
        """Return where in the stack the grids of N worlds are, (N,), packing those that are not there yet."""
        new = list({id(grid): grid for grid in grids if id(grid) not in self._places}.values())
        if new and not self._append_grids(new):
            self._repack_grids(grids)
        if new:
            self._places = {id(grid): place for place, grid in enumerate(self._grids)}
        return np.array([self._places[id(grid)] for grid in grids], np.int64)

    def _append_grids(self, grids: Sequence[PlacedGrid]) -> bool:
        """Write grids behind those in the stack; False if there is no room."""
        if not self._grids:
            return False
        added, _ = stack_grids(grids)
        room = {name: (self._used_length(name), getattr(added, name)) for name in FLAT}
        if any(used + len(part) > len(getattr(self.stack, name)) for name, (used, part) in room.items()):
            return False
        for name, (used, part) in room.items():
            getattr(self.stack, name)[used : used + len(part)] = part
        self.stack = _extended_stack(self.stack, added, room["cells"][0], room["reach"][0])
        self._grids += grids
        return True

    def _used_length(self, name: str) -> int:
        """Return how much of a flat array is taken."""
        rows, columns = self.stack.shapes[-1]
        if name == "reach":
            return int(self.stack.reach_offsets[-1]) + 4 * table_size(rows, columns)
        return int(self.stack.offsets[-1] + rows * columns)

    def _repack_grids(self, grids: Sequence[PlacedGrid]) -> None:
        """Pack the grids in use alone, and if they are several leave as much room again."""
        self._grids = list({id(grid): grid for grid in grids}.values())
        self.stack, _ = stack_grids(self._grids)
        if len(self._grids) > 1:
            self.stack = self.stack._replace(**{name: _double_room(getattr(self.stack, name)) for name in FLAT})


def _double_room(array: NDArray[Any]) -> NDArray[Any]:
    room: NDArray[Any] = aligned_buffer(2 * array.nbytes).view(array.dtype)
    room[: len(array)] = array
    return room


def _extended_stack(stack: GridStack, added: GridStack, cells: int, reach: int) -> GridStack:
    """Return ``stack`` with the places of ``added``, whose cells and reaches were written from there on."""
    shifted = added._replace(offsets=added.offsets + cells, reach_offsets=added.reach_offsets + reach)
    names = [name for name in GridStack._fields if name not in FLAT]
    return stack._replace(**{name: np.concatenate((getattr(stack, name), getattr(shifted, name))) for name in names})
