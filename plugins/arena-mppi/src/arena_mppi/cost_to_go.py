"""What is left of the way from every place of the window: the viscosity solution of the eikonal
equation, by fast sweeping.
"""

from __future__ import annotations

import math

import numpy as np

from arena_kernels.compiled import borrowing, inner
from arena_mppi.columns import PLACE_X, PLACE_Y
from arena_mppi.parameters import Doubles, Floats

UNREACHED = np.float32(1e6)
STEP = 2  # cells of the window along a cell of the field
ROUNDS = 12  # of four sweeps; a window is done after two or three
SETTLED = np.float32(1e-3)  # m


@borrowing
def fill_slowness(
    gaps: Floats, radius: float, comfort_gap: float, comfort_cost: float, blocked_cost: float, slow: Floats
) -> None:
    """Fill ``slow`` (h, w): what a metre costs, 1 in the open, more within ``comfort_gap`` of walls, ``blocked_cost``
    where none fits.

    The robot fits where it fits in one cell of the window: a gap hardly wider than the robot lies across the field's
    larger ones.
    """
    rows, columns = gaps.shape
    for row in range(slow.shape[0]):
        for column in range(slow.shape[1]):
            gap, widest, cells = 0.0, 0.0, 0
            for i in range(STEP * row, min(STEP * row + STEP, rows)):
                for j in range(STEP * column, min(STEP * column + STEP, columns)):
                    gap, widest, cells = gap + float(gaps[i, j]), max(widest, float(gaps[i, j])), cells + 1
            if widest < radius:
                slow[row, column] = np.float32(blocked_cost)
            else:
                lack = min(max(0.0, 1.0 - (gap / cells - radius) / comfort_gap), 1.0)
                slow[row, column] = np.float32(1.0 + comfort_cost * lack**2)


@borrowing
def fast_sweep(left: Floats, slow: Floats, side: float) -> int:
    """Lower ``left`` (h, w) to the solution of abs(gradient) = ``slow`` with its least value as the source; return the
    rounds taken.

    Zhao, A Fast Sweeping Method for Eikonal Equations, Mathematics of Computation 74, 2005. ``side`` of a cell in m.
    """
    rows, columns = left.shape
    for taken in range(ROUNDS):
        change = np.float32(0.0)
        for order in range(4):
            for i in range(rows):
                row = i if order < 2 else rows - 1 - i
                for j in range(columns):
                    column = j if order % 2 == 0 else columns - 1 - j
                    value = upwind_value(left, row, column, slow[row, column] * np.float32(side))
                    if value < left[row, column]:
                        change = max(change, left[row, column] - value)
                        left[row, column] = value
        if change < SETTLED:
            return taken + 1
    return ROUNDS


@inner
def upwind_value(left: Floats, row: int, column: int, pace: np.float32) -> np.float32:
    """Return the value of a cell that follows from its neighbours' (Godunov's upwind difference)."""
    rows, columns = left.shape
    a = min(left[row, max(column - 1, 0)], left[row, min(column + 1, columns - 1)])
    b = min(left[max(row - 1, 0), column], left[min(row + 1, rows - 1), column])
    difference = a - b
    if abs(difference) >= pace:
        return min(a, b) + pace  # type: ignore[no-any-return]
    root = np.float32(math.sqrt(np.float32(2.0) * pace * pace - difference * difference))
    return np.float32(0.5) * (a + b + root)  # type: ignore[no-any-return]


@borrowing
def last_inside(path: Doubles, first: int, x_min: float, y_min: float, x_max: float, y_max: float) -> int:
    """Return the row of the last pose of ``path`` (M, 3) before it first leaves a rectangle,
    looking from row ``first`` on.
    """
    last = first
    for i in range(first, len(path)):
        if not (x_min <= path[i, PLACE_X] < x_max and y_min <= path[i, PLACE_Y] < y_max):
            break
        last = i
    return last


@borrowing
def nearest_row(path: Doubles, x: float, y: float) -> int:
    """Return the row of ``path`` (M, 3) nearest to a position."""
    best, least = 0, math.inf
    for i in range(len(path)):
        squared = (path[i, PLACE_X] - x) ** 2 + (path[i, PLACE_Y] - y) ** 2
        if squared < least:
            best, least = i, squared
    return best
