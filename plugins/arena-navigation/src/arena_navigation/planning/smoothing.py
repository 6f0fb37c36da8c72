"""From a chain of cells to a drivable path: straight lines where they cost no more, evenly spaced points, rounded
corners.

Positions are (column, row) in cells, so that cell (r, c) covers [c, c + 1) x [r, r + 1).
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from arena_core import INSCRIBED
from arena_kernels.compiled import compiled
from arena_navigation.columns import X, Y

# what it costs to be in each cell (H, W), and the weights that make a price of it
CellPrices = tuple[NDArray[np.uint8], NDArray[np.float64]]
_GROWTH = 1.3  # a longer line is tried this much farther ahead each time
_SLACK = 1.0 + 1e-9  # a straight line along straight moves costs the same but for rounding
# of the bend at a point, and of its way back, that it moves by at once: rounds corners over some 0.15 m
_PULL, _HOLD = 0.4, 0.2


@compiled
def refine_path(
    prices: CellPrices,
    points: NDArray[np.float64],
    pinned: int,
    spacing: float,
    rounds: int,
) -> NDArray[np.float64]:
    """Return points (M, 2) at most ``spacing`` cells apart along a path no costlier than ``points`` (K, 2), which lead
    from cell to cell.

    ``weights`` (256,) is the cost of one cell of way by cell cost. The first ``pinned`` points are kept, and may lie in
    the inscribed zone. No line leaves the free cells, and smoothing moves no point by more than a cell.
    """
    costs, weights = prices
    lines = _resample_lines(_pull_tight(costs, weights, points[pinned:]), spacing)
    lines = _pull_tight(costs, weights, lines[::-1].copy())  # from the other end, to cut the corners that were left
    even = np.concatenate((points[:pinned], _resample_lines(lines[::-1].copy(), spacing)))
    return _smooth_points(costs, weights, even, pinned, rounds)


@compiled
def path_cost(costs: NDArray[np.uint8], weights: NDArray[np.float64], points: NDArray[np.float64]) -> float:
    """Return the cost of the lines through ``points`` (K, 2) from the first free
    cell on; inf if one of them is blocked.
    """
    first = 0
    while first < len(points) - 1 and costs[math.floor(points[first, Y]), math.floor(points[first, X])] >= INSCRIBED:
        first += 1
    total = 0.0
    for i in range(first, len(points) - 1):
        total += line_cost((costs, weights), points[i, X], points[i, Y], points[i + 1, X], points[i + 1, Y])
    return total


@compiled
def leads_through(costs: NDArray[np.uint8], narrow_from: int, points: NDArray[np.float64]) -> bool:
    """Return whether the lines through ``points`` (K, 2) cross cells of at least ``narrow_from``
    between two stretches of others.
    """
    left_start, narrow = False, False
    for i in range(1, len(points)):
        dx, dy = points[i, X] - points[i - 1, X], points[i, Y] - points[i - 1, Y]
        parts = max(1, math.ceil(2.0 * math.hypot(dx, dy)))
        for part in range(parts):
            share = part / parts
            cost = costs[math.floor(points[i - 1, Y] + share * dy), math.floor(points[i - 1, X] + share * dx)]
            if cost >= narrow_from:
                narrow = left_start
            elif narrow:
                return True
            else:
                left_start = True
    return False


@compiled
def line_cost(prices: CellPrices, x0: float, y0: float, x1: float, y1: float) -> float:
    """Return the cost of a straight line, the sum over the cells it crosses of length times weight; inf if one is
    blocked.

    Cells are visited in order (Amanatides and Woo 1987); through a corner, both cells beside it must be free.
    """
    costs, weights = prices
    column, row = math.floor(x0), math.floor(y0)
    last_column, last_row = math.floor(x1), math.floor(y1)
    dx, dy = x1 - x0, y1 - y0
    length = math.hypot(dx, dy)
    step_column, step_row = (1 if dx > 0 else -1), (1 if dy > 0 else -1)
    per_column = abs(1.0 / dx) if dx != 0.0 else math.inf
    per_row = abs(1.0 / dy) if dy != 0.0 else math.inf
    next_column = (column + (dx > 0) - x0) / dx if dx != 0.0 else math.inf
    next_row = (row + (dy > 0) - y0) / dy if dy != 0.0 else math.inf
    at, total = 0.0, 0.0
    for _ in range(abs(last_column - column) + abs(last_row - row) + 1):
        if costs[row, column] >= INSCRIBED:
            return math.inf
        leave = min(next_column, next_row, 1.0)
        total += (leave - at) * length * weights[costs[row, column]]
        at = leave
        if row == last_row and column == last_column:
            break
        if abs(next_column - next_row) < 1e-9 and row != last_row and column != last_column:
            if costs[row + step_row, column] >= INSCRIBED or costs[row, column + step_column] >= INSCRIBED:
                return math.inf
            column, row = column + step_column, row + step_row
            next_column, next_row = next_column + per_column, next_row + per_row
        elif (next_column < next_row and column != last_column) or row == last_row:
            column, next_column = column + step_column, next_column + per_column
        else:
            row, next_row = row + step_row, next_row + per_row
    return total


@compiled
def _pull_tight(
    costs: NDArray[np.uint8], weights: NDArray[np.float64], points: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Keep the points between which a straight line costs no more than the way along
    all, from each the farthest found.
    """
    count = len(points)
    along = np.zeros(count)
    for i in range(1, count):
        along[i] = along[i - 1] + line_cost(
            (costs, weights), points[i - 1, X], points[i - 1, Y], points[i, X], points[i, Y]
        )
    lines = np.empty((count, 2))
    lines[0, X], lines[0, Y] = points[0, X], points[0, Y]
    number, last = 1, 0
    while last < count - 1:
        last = _farthest_reachable(costs, weights, points, along, last)
        lines[number, X], lines[number, Y] = points[last, X], points[last, Y]
        number += 1
    return lines[:number]


@compiled
def _farthest_reachable(
    costs: NDArray[np.uint8],
    weights: NDArray[np.float64],
    points: NDArray[np.float64],
    along: NDArray[np.float64],
    start: int,
) -> int:
    """Return the farthest point found that a line from ``start`` reaches as cheaply:
    ever longer leaps, then bisection.
    """
    end = len(points) - 1
    best, failed = start + 1, end + 1
    leap = 2.0
    while best < end:
        tried = min(start + int(leap), end)
        leap *= _GROWTH
        if tried <= best:
            continue
        if _is_as_cheap((costs, weights), points, along, start, tried):
            best = tried
        else:
            failed = tried
            break
    while failed - best > 1:
        tried = (best + failed) // 2
        if _is_as_cheap((costs, weights), points, along, start, tried):
            best = tried
        else:
            failed = tried
    return best


@compiled
def _is_as_cheap(
    prices: CellPrices,
    points: NDArray[np.float64],
    along: NDArray[np.float64],
    i: int,
    j: int,
) -> bool:
    direct = line_cost(prices, points[i, X], points[i, Y], points[j, X], points[j, Y])
    return bool(direct <= (along[j] - along[i]) * _SLACK)


@compiled
def _resample_lines(lines: NDArray[np.float64], spacing: float) -> NDArray[np.float64]:
    """Divide each line evenly, corners included."""
    pieces = np.ones(len(lines), np.int64)
    total = 1
    for i in range(1, len(lines)):
        length = math.hypot(lines[i, X] - lines[i - 1, X], lines[i, Y] - lines[i - 1, Y])
        pieces[i] = max(1, math.ceil(length / spacing - 1e-9))
        total += pieces[i]
    points = np.empty((total, 2))
    points[0, X], points[0, Y] = lines[0, X], lines[0, Y]
    number = 1
    for i in range(1, len(lines)):
        for piece in range(1, pieces[i] + 1):
            share = piece / pieces[i]
            points[number, X] = (1.0 - share) * lines[i - 1, X] + share * lines[i, X]
            points[number, Y] = (1.0 - share) * lines[i - 1, Y] + share * lines[i, Y]
            number += 1
    return points


@compiled
def _smooth_points(
    costs: NDArray[np.uint8], weights: NDArray[np.float64], even: NDArray[np.float64], pinned: int, rounds: int
) -> NDArray[np.float64]:
    """Pull every free point towards its neighbours and, softly, back; undo what leads through blocked cells."""
    points = even.copy()
    for _ in range(rounds):
        for i in range(pinned + 1, len(points) - 1):
            dx = points[i, X] - even[i, X] + _PULL * (points[i - 1, X] + points[i + 1, X] - 2.0 * points[i, X])
            dy = points[i, Y] - even[i, Y] + _PULL * (points[i - 1, Y] + points[i + 1, Y] - 2.0 * points[i, Y])
            part = min(1.0 - _HOLD, 1.0 / max(math.hypot(dx, dy), 1e-9))  # at most a cell
            points[i, X], points[i, Y] = even[i, X] + part * dx, even[i, Y] + part * dy
    undone = True
    while undone:
        undone = False
        for i in range(pinned + 1, len(points)):
            moved = _is_different(points, even, i - 1) or _is_different(points, even, i)
            if (
                moved
                and line_cost((costs, weights), points[i - 1, X], points[i - 1, Y], points[i, X], points[i, Y])
                == math.inf
            ):
                for k in (i - 1, i):
                    points[k, X], points[k, Y] = even[k, X], even[k, Y]
                undone = True
    return points


@compiled
def _is_different(a: NDArray[np.float64], b: NDArray[np.float64], i: int) -> bool:
    return bool(a[i, X] != b[i, X] or a[i, Y] != b[i, Y])
