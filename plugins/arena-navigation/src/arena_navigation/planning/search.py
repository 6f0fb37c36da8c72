"""A* on a cost grid, backwards from the goal, so that later queries for the same goal can use what was found."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arena_core import INSCRIBED
from arena_kernels.compiled import compiled

Cell = tuple[int, int]

STRAIGHT, DIAGONAL = 13860, 19601  # whole numbers: their ratio is sqrt(2) within 2e-9, and sums stay exact in any order
UNREACHED = np.int64(2**62)
BLOCKED = np.int64(-1)
_BUCKET_BITS = 9  # a bucket is 1/27 of the least move wide: few cells are expanded twice
_ROOM = 8  # most cells that one expansion may queue
LEVEL, LENGTH, TOP, FREE = range(4)  # of a queue's state


@dataclass(frozen=True, slots=True)
class MoveCosts:
    """What entering a cell of cost c costs: (neutral_cost + cost_factor c), times sqrt(2) if diagonally, as navfn
    charges it.

    From ``narrow_from`` on a cell lies so near to a wall that the planner at hand does not pass: it costs
    ``narrow_cost`` free cells more.
    """

    neutral_cost: float
    cost_factor: float
    narrow_from: int = INSCRIBED
    narrow_cost: float = 0.0

    def relative(self) -> NDArray[np.float64]:
        """Return what a way through a cell costs by the cell's cost, (256,), in ways through a free one."""
        costs = np.arange(256.0)
        relative: NDArray[np.float64] = 1.0 + self.cost_factor * costs / self.neutral_cost
        relative[self.narrow_from :] += self.narrow_cost
        return relative

    def tables(self) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Return the cost of a straight and of a diagonal move by the entered cell's cost, (256,), in
        1/13860 of a free straight one.
        """
        relative = self.relative()
        return np.rint(STRAIGHT * relative).astype(np.int64), np.rint(DIAGONAL * relative).astype(np.int64)


class _Field(NamedTuple):
    """What is searched, with a rim of blocked cells around it, flat; ``togo`` is the cost to the
    goal or BLOCKED or UNREACHED.
    """

    costs: NDArray[np.uint8]
    width: int
    straight: NDArray[np.int64]
    diagonal: NDArray[np.int64]
    togo: NDArray[np.int64]
    expanded: NDArray[np.uint8]
    anchor: NDArray[np.int64]


class _Queue(NamedTuple):
    """A ring of buckets of cells by cost to the goal plus estimate to the anchor; ``state`` holds level,
    length, top and free entry.
    """

    heads: NDArray[np.int32]
    cells: NDArray[np.int32]
    following: NDArray[np.int32]
    state: NDArray[np.int64]

    def doubled(self) -> _Queue:
        """Return the same queue with room for twice as many cells."""
        return self._replace(
            cells=np.resize(self.cells, 2 * self.cells.size), following=np.resize(self.following, 2 * self.cells.size)
        )


class CostToGo:
    """The cost from cells to one goal, searched as far as was asked.

    A* (Hart, Nilsson, Raphael 1968) runs from the goal towards the cell of the first query. Its octile estimate is
    consistent, so every cell at or below the level that was finished is settled for good: a query for another cell
    reads its value or lets the same search go on. Moves are 8-connected; a diagonal one needs both cells beside it
    free. Costs are whole numbers, so values and paths are exact, and depend on grid, goal and queried cell alone, never
    on the queries before.
    """

    def __init__(self, costs: NDArray[np.uint8], moves: MoveCosts, goal: Cell, anchor: Cell) -> None:
        padded = np.full((costs.shape[0] + 2, costs.shape[1] + 2), 255, np.uint8)
        padded[1:-1, 1:-1] = costs
        togo = np.where(padded < INSCRIBED, UNREACHED, BLOCKED).ravel()
        straight, diagonal = moves.tables()
        self.goal = goal
        self._field = _Field(
            padded.ravel(),
            padded.shape[1],
            straight,
            diagonal,
            togo,
            np.zeros(padded.size, np.uint8),
            np.array(anchor, np.int64) + 1,
        )
        self._queue = _new_queue(int(diagonal[INSCRIBED - 1]))
        _queue_goal(self._field, self._queue, self._cell_index(goal))

    def __call__(self, cell: Cell) -> float:
        """Return the cost from ``cell`` to the goal in free straight moves, inf when there is no way."""
        index = self._cell_index(cell)
        while not _expand_until(self._field, self._queue, index):
            self._queue = self._queue.doubled()
        togo = int(self._field.togo[index])
        return togo / STRAIGHT if 0 <= togo < UNREACHED else float("inf")

    def cells_from(self, cell: Cell) -> NDArray[np.int64]:
        """Return the cheapest way from ``cell`` to the goal, both included, (K, 2) of row and
        column; ``cell`` must have one.
        """
        flat = _trace_path(self._field, self._cell_index(cell))
        return np.stack(np.divmod(flat, self._field.width), axis=1) - 1

    def _cell_index(self, cell: Cell) -> int:
        return (cell[0] + 1) * self._field.width + cell[1] + 1


def _new_queue(dearest: int) -> _Queue:
    """Make an empty ring that is longer than the largest step of the estimated total, so that no
    two levels share a bucket.
    """
    levels = ((dearest + DIAGONAL) >> _BUCKET_BITS) + 2
    heads = np.full(1 << (levels - 1).bit_length(), -1, np.int32)
    return _Queue(heads, np.empty(4096, np.int32), np.empty(4096, np.int32), np.array((0, 0, 0, -1), np.int64))


@compiled
def _octile_distance(row: int, column: int, anchor: NDArray[np.int64]) -> int:
    """Return the octile distance to the anchor, the least that any way there can cost."""
    rows, columns = abs(row - anchor[0]), abs(column - anchor[1])
    return int(STRAIGHT * max(rows, columns) + (DIAGONAL - STRAIGHT) * min(rows, columns))


@compiled
def _bucket_level(field: _Field, cell: int, togo: int) -> int:
    """Return the bucket level of the least total cost of a way through ``cell``."""
    return (togo + _octile_distance(cell // field.width, cell % field.width, field.anchor)) >> _BUCKET_BITS


@compiled
def _queue_goal(field: _Field, queue: _Queue, goal: int) -> None:
    """Queue the goal, unless it is blocked."""
    if field.togo[goal] == BLOCKED:
        return
    field.togo[goal] = 0
    queue.state[LEVEL] = _bucket_level(field, goal, 0)
    _push_cell(queue, goal, queue.state[LEVEL])


@compiled
def _push_cell(queue: _Queue, cell: int, level: int) -> None:
    state = queue.state
    entry = state[FREE]
    if entry >= 0:
        state[FREE] = queue.following[entry]
    else:
        entry = state[TOP]
        state[TOP] += 1
    bucket = level & (queue.heads.size - 1)
    queue.cells[entry] = cell
    queue.following[entry] = queue.heads[bucket]
    queue.heads[bucket] = entry
    state[LENGTH] += 1


@compiled
def _pop_cell(queue: _Queue, bucket: int) -> int:
    state = queue.state
    entry = queue.heads[bucket]
    queue.heads[bucket] = queue.following[entry]
    queue.following[entry] = state[FREE]
    state[FREE] = entry
    state[LENGTH] -= 1
    return int(queue.cells[entry])


@compiled
def _expand_until(field: _Field, queue: _Queue, target: int) -> bool:
    """Search until ``target`` is settled or nothing is left; return False if the queue has to grow first.

    Within a bucket the order is last in, first out; a cell that is bettered after its expansion is expanded again, so
    the values do not depend on the order. A level is finished only when its bucket is empty.
    """
    togo, state = field.togo, queue.state
    while state[LENGTH] > 0:
        bucket = state[LEVEL] & (queue.heads.size - 1)
        while queue.heads[bucket] >= 0:
            if state[LENGTH] + _ROOM > queue.cells.size:
                return False
            cell = _pop_cell(queue, bucket)
            if not field.expanded[cell]:
                field.expanded[cell] = 1
                _expand_cell(field, queue, cell)
        if togo[target] < UNREACHED and _bucket_level(field, target, togo[target]) <= state[LEVEL]:
            break
        state[LEVEL] += 1
    return True


@compiled
def _expand_cell(field: _Field, queue: _Queue, cell: int) -> None:
    """Better the values of the cells from which one move leads into ``cell``."""
    width, togo = field.width, field.togo
    row, column = cell // width, cell % width
    straight = togo[cell] + field.straight[field.costs[cell]]
    diagonal = togo[cell] + field.diagonal[field.costs[cell]]
    for move in range(8):
        if move < 4:
            from_row, from_column, value = row + (move == 0) - (move == 1), column + (move == 2) - (move == 3), straight
        else:
            from_row, from_column, value = row + 2 * (move & 1) - 1, column + (move & 2) - 1, diagonal
        neighbour = from_row * width + from_column
        if value >= togo[neighbour]:  # BLOCKED is below any value
            continue
        if move >= 4 and (togo[row * width + from_column] < 0 or togo[from_row * width + column] < 0):
            continue
        togo[neighbour] = value
        field.expanded[neighbour] = 0
        _push_cell(queue, neighbour, (value + _octile_distance(from_row, from_column, field.anchor)) >> _BUCKET_BITS)


@compiled
def _trace_path(field: _Field, start: int) -> NDArray[np.int64]:
    """Follow from ``start`` the neighbours that explain each cell's value, straight on where there is a choice."""
    width, togo = field.width, field.togo
    steps = np.array((width, -width, 1, -1, width + 1, width - 1, -width + 1, -width - 1))
    way = np.empty(togo.size, np.int64)
    way[0] = start
    count, last = 1, 0
    while togo[way[count - 1]] > 0:
        cell = way[count - 1]
        for turn in range(9):
            move = last if turn == 0 else turn - 1
            neighbour = cell + steps[move]
            table = field.straight if move < 4 else field.diagonal
            if togo[neighbour] < 0 or togo[neighbour] + table[field.costs[neighbour]] != togo[cell]:
                continue
            if move >= 4:
                up = width if move < 6 else -width
                if togo[cell + up] < 0 or togo[neighbour - up] < 0:
                    continue
            way[count] = neighbour
            count += 1
            last = move
            break
    return way[:count].copy()
