"""Ways round walls: A* on the coarse grid, then only the corners that a straight walk needs."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arena_kernels.compiled import borrowing, compiled
from arena_kernels.ground import Ground, in_cells, in_map, wall_clearance
from arena_kernels.route_grid import CoarseGrid, CoarseGridStack
from arena_kernels.slide_along import SIGHT, is_visible

STRAIGHT, DIAGONAL = 5, 7  # integer costs, 1 % off the square root of two, make the queue an array of lists
_BUCKETS = 16  # more than cost + estimate can grow along one step, 2 * DIAGONAL
_NEAREST_ROOM = 1.0  # m, how far from a waypoint without room the nearest place with room is looked for

# The working memory of a search over up to C cells is ``nodes`` (C + 1, 5) int32 with these columns; the last row's
# COST counts the
# searches, so that the marks of earlier ones need not be wiped out.
COST, PARENT, NEXT, PREVIOUS, MARK = range(5)


def nodes_for(rooms: CoarseGridStack) -> NDArray[np.int32]:
    """Return working memory for the largest of these grids."""
    return np.zeros((int(rooms.shapes.prod(axis=1).max()) + 1, 5), np.int32)


@borrowing
def nearest_room(ground: Ground, rooms: CoarseGrid, x: float, y: float, radius: float) -> tuple[float, float, int]:
    """Return the nearest place where a body has room and its coarse cell, -1 when there is none near; never one behind
    a wall.

    From a position inside a wall every place counts.
    """
    rows, columns = rooms.room.shape
    v, u = in_cells(ground, x, y)
    home_row, home_column = int(np.floor(v / rooms.factor)), int(np.floor(u / rooms.factor))
    reach = int(_NEAREST_ROOM / (ground.cell * rooms.factor)) + 1
    walled_in = wall_clearance(ground, x, y) <= 0.0
    best, best_squared, best_x, best_y = -1, np.inf, x, y
    for row in range(max(home_row - reach, 0), min(home_row + reach + 1, rows)):
        for column in range(max(home_column - reach, 0), min(home_column + reach + 1, columns)):
            if rooms.room[row, column] < radius:
                continue
            place_x, place_y = place_of(ground, rooms, row * columns + column)
            squared = (place_x - x) ** 2 + (place_y - y) ** 2
            if squared < best_squared and (walled_in or is_visible(ground, (x, y, place_x, place_y), SIGHT * radius)):
                best, best_squared, best_x, best_y = row * columns + column, squared, place_x, place_y
    return best_x, best_y, best


@borrowing
def place_of(ground: Ground, rooms: CoarseGrid, cell: int) -> tuple[float, float]:
    """Return the roomiest position of a coarse cell, in ``map``."""
    coarse_columns, columns = rooms.room.shape[1], ground.field.shape[1]
    fine = rooms.place[cell // coarse_columns, cell % coarse_columns]
    return in_map(ground, fine // columns + 0.5, fine % columns + 0.5)


class RouteSearch(NamedTuple):
    """What a way is searched on: the coarse grid of where there is room, and room for the nodes of the search."""

    rooms: CoarseGrid
    nodes: NDArray[np.int32]


@compiled
def find_corners(
    ground: Ground,
    search: RouteSearch,
    start: tuple[float, float, int],
    goal: tuple[float, float, int],
    radius: float,
    corners: NDArray[np.float64],
) -> int:
    """Write the corners of the way between two positions (x, y, coarse cell near it); return how many, -1 when there is
    no way.

    ``corners`` (C, 2) bounds their number: the way then ends at the last one.
    """
    heads = np.empty(_BUCKETS, np.int32)
    for bucket in range(_BUCKETS):
        heads[bucket] = -1
    if not _search_route(search.rooms.room, goal[2], start[2], radius, search.nodes, heads):
        return -1
    found, cell = 0, start[2]
    from_x, from_y = start[0], start[1]
    last_x, last_y = place_of(ground, search.rooms, cell)
    while cell != goal[2]:
        cell = int(search.nodes[cell, PARENT])
        next_x, next_y = place_of(ground, search.rooms, cell)
        if cell == goal[2]:
            next_x, next_y = goal[0], goal[1]
        if not is_visible(ground, (from_x, from_y, next_x, next_y), SIGHT * radius):
            if found == len(corners):
                return found
            corners[found, 0], corners[found, 1] = last_x, last_y
            found += 1
            from_x, from_y = last_x, last_y
        last_x, last_y = next_x, next_y
    return found


@borrowing
def _search_route(
    room: NDArray[np.float32], start: int, goal: int, radius: float, nodes: NDArray[np.int32], heads: NDArray[np.int32]
) -> bool:
    """Find the cheapest way over cells with room for a body (8 neighbours, no cut corners); parents then lead from goal
    to start.

    A* (Hart, Nilsson, Raphael 1968) with Dial's buckets (1969), each a doubly linked list, so that a cell can move when
    its cost falls. A cell's MARK is ``mark`` while it is queued and ``mark + 1`` once its cost is final.
    """
    nodes[-1, COST] += 1
    mark = 2 * nodes[-1, COST]
    rows, columns = room.shape
    goal_row, goal_column = goal // columns, goal % columns
    level = _octile_cost(start // columns - goal_row, start % columns - goal_column)
    nodes[start, COST], nodes[start, PARENT], nodes[start, MARK] = 0, start, mark
    _push_cell(nodes, heads, start, level)
    queued = 1
    while queued > 0:
        cell = int(heads[level % _BUCKETS])
        if cell < 0:
            level += 1
            continue
        if cell == goal:
            return True
        _remove_cell(nodes, heads, cell, level)
        queued -= 1
        nodes[cell, MARK] = mark + 1
        row, column = cell // columns, cell % columns
        for r in range(max(row - 1, 0), min(row + 2, rows)):
            for c in range(max(column - 1, 0), min(column + 2, columns)):
                neighbour = r * columns + c
                if (
                    nodes[neighbour, MARK] == mark + 1
                    or room[r, c] < radius
                    or room[r, column] < radius
                    or room[row, c] < radius
                ):
                    continue
                cost = nodes[cell, COST] + (DIAGONAL if r != row and c != column else STRAIGHT)
                estimate = _octile_cost(r - goal_row, c - goal_column)
                if nodes[neighbour, MARK] != mark:
                    queued += 1
                elif nodes[neighbour, COST] <= cost:
                    continue
                else:
                    _remove_cell(nodes, heads, neighbour, nodes[neighbour, COST] + estimate)
                nodes[neighbour, COST], nodes[neighbour, PARENT], nodes[neighbour, MARK] = cost, cell, mark
                _push_cell(nodes, heads, neighbour, cost + estimate)
    return False


@borrowing
def _octile_cost(rows: int, columns: int) -> int:
    """Return the cost of an unhindered way over this many rows and columns."""
    rows, columns = abs(rows), abs(columns)
    return STRAIGHT * max(rows, columns) + (DIAGONAL - STRAIGHT) * min(rows, columns)


@borrowing
def _push_cell(nodes: NDArray[np.int32], heads: NDArray[np.int32], cell: int, level: int) -> None:
    first = heads[level % _BUCKETS]
    nodes[cell, PREVIOUS], nodes[cell, NEXT] = -1, first
    if first >= 0:
        nodes[first, PREVIOUS] = cell
    heads[level % _BUCKETS] = cell


@borrowing
def _remove_cell(nodes: NDArray[np.int32], heads: NDArray[np.int32], cell: int, level: int) -> None:
    before, after = nodes[cell, PREVIOUS], nodes[cell, NEXT]
    if before >= 0:
        nodes[before, NEXT] = after
    else:
        heads[level % _BUCKETS] = after
    if after >= 0:
        nodes[after, PREVIOUS] = before
