"""Free cells to begin or end at, when the wished cell itself is not free."""

from __future__ import annotations

import heapq
import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from arena_core import INSCRIBED, LETHAL
from arena_navigation.planning.search import DIAGONAL, STRAIGHT, Cell

_MOVES = [(row, column) for row in (-1, 0, 1) for column in (-1, 0, 1) if row or column]


def escape_paths(costs: NDArray[np.uint8], start: Cell, reach: int) -> list[list[Cell]]:
    """Return the ways from ``start`` through inscribed cells to free ones, shortest first; each holds both its ends.

    A start that is free itself is its own way out. Only ways that stay within ``reach`` cells of the start are looked
    for.
    """
    queue: list[tuple[int, Cell, Cell]] = [(0, start, start)]
    came_from: dict[Cell, Cell] = {}
    ways = []
    while queue:
        length, cell, previous = heapq.heappop(queue)
        if cell in came_from:
            continue
        came_from[cell] = previous
        if costs[cell] < INSCRIBED:
            ways.append(_trace_chain(came_from, cell))
            continue
        for row, column in _MOVES:
            neighbour = cell[0] + row, cell[1] + column
            near = max(abs(neighbour[0] - start[0]), abs(neighbour[1] - start[1])) <= reach
            if near and all(
                _is_passable(costs, beside) for beside in (neighbour, (cell[0], neighbour[1]), (neighbour[0], cell[1]))
            ):
                heapq.heappush(queue, (length + (DIAGONAL if row and column else STRAIGHT), neighbour, cell))
    return ways


def _is_passable(costs: NDArray[np.uint8], cell: Cell) -> bool:
    return 0 <= cell[0] < costs.shape[0] and 0 <= cell[1] < costs.shape[1] and bool(costs[cell] < LETHAL)


def _trace_chain(came_from: dict[Cell, Cell], end: Cell) -> list[Cell]:
    chain = [end]
    while came_from[chain[-1]] != chain[-1]:
        chain.append(came_from[chain[-1]])
    return chain[::-1]


def free_cells_near(costs: NDArray[np.uint8], cell: Cell, tolerance: float) -> Iterator[Cell]:
    """Yield ``cell`` if it is free, then the free cells within ``tolerance`` (in cells) of it, nearest first."""
    if costs[cell] < INSCRIBED:
        yield cell
    reach = math.floor(tolerance)
    first = max(cell[0] - reach, 0), max(cell[1] - reach, 0)
    window = costs[first[0] : cell[0] + reach + 1, first[1] : cell[1] + reach + 1]
    near = np.argwhere(window < INSCRIBED) + first
    distances = np.hypot(*(near - cell).T)
    for index in np.argsort(distances, kind="stable"):
        if 0.0 < distances[index] <= tolerance:
            yield int(near[index, 0]), int(near[index, 1])
