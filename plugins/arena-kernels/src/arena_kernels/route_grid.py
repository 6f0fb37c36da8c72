"""A coarse grid on which people find their way: how much room each cell has, and where in the cell that is."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from arena_kernels.compiled import compiled
from arena_kernels.distance import grid_distance
from arena_kernels.grids import PlacedGrid


class CoarseGrid(NamedTuple):
    """A map in coarse cells of ``factor`` x ``factor`` of its own: ``room`` (h, w) m, ``place`` (h, w) the
    flat map cell that has it.
    """

    room: NDArray[np.float32]
    place: NDArray[np.int32]
    factor: int


class CoarseGridStack(NamedTuple):
    """The coarse grids of a GridStack in its order, packed: cell (row, column) of g is at ``offsets[g] +
    row * shapes[g, 1] + column``.
    """

    room: NDArray[np.float32]
    place: NDArray[np.int32]
    factors: NDArray[np.int64]
    offsets: NDArray[np.int64]
    shapes: NDArray[np.int64]


def stack_coarse_grids(grids: Sequence[PlacedGrid], cell: float) -> CoarseGridStack:
    """Pack the coarse grids (cells of about ``cell`` m) of these distinct grids."""
    rooms = [grid.derive(coarse_grid_maker(cell)) for grid in grids]
    return CoarseGridStack(
        np.concatenate([each.room.ravel() for each in rooms]),
        np.concatenate([each.place.ravel() for each in rooms]),
        np.array([each.factor for each in rooms], np.int64),
        np.cumsum([0, *(each.room.size for each in rooms)], dtype=np.int64)[:-1],
        np.array([each.room.shape for each in rooms], np.int64),
    )


@cache  # one function object for each cell size: it is the key under which a grid keeps the result
def coarse_grid_maker(cell: float) -> Callable[[PlacedGrid], CoarseGrid]:
    """Return the function that makes the coarse grid of a map."""

    def rooms(grid: PlacedGrid) -> CoarseGrid:
        factor = max(round(cell / grid.resolution), 1)
        return CoarseGrid(*_roomiest_cells(grid.derive(grid_distance), factor, 0.5 * grid.resolution), factor)

    return rooms


@compiled
def _roomiest_cells(
    distance: NDArray[np.float32], factor: int, half_cell: float
) -> tuple[NDArray[np.float32], NDArray[np.int32]]:
    rows, columns = distance.shape
    shape = ((rows + factor - 1) // factor, (columns + factor - 1) // factor)
    room, place = np.full(shape, np.float32(-1.0)), np.zeros(shape, np.int32)
    for row in range(rows):
        for column in range(columns):
            r, c = row // factor, column // factor
            here = np.float32(distance[row, column] - half_cell)
            if here > room[r, c]:
                room[r, c], place[r, c] = here, row * columns + column
    return room, place


@compiled
def coarse_grid_of(stack: Any, g: int) -> CoarseGrid:
    """Return coarse grid ``g`` of a RoomStack."""
    rows, columns, first = stack.shapes[g, 0], stack.shapes[g, 1], stack.offsets[g]
    last = first + rows * columns
    return CoarseGrid(
        stack.room[first:last].reshape((rows, columns)),
        stack.place[first:last].reshape((rows, columns)),
        stack.factors[g],
    )
