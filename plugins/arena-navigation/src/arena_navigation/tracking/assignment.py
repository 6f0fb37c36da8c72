"""The assignment of rows to columns of least total cost."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arena_kernels.compiled import borrowing, inner
from arena_kernels.scalars import Integer


class Assignment(NamedTuple):
    """Room for up to S rows and columns: ``costs`` (C,), row after row; ``column_of`` (S,) is the result; then scratch
    space.

    ``row_prices`` and ``column_prices`` are the dual variables, ``row_of`` is the inverse of the result; ``reached`` is
    what the cheapest path to a column costs, ``before`` the row from which it comes there; ``open`` are the columns
    without a final one.
    """

    costs: NDArray[np.float64]
    column_of: NDArray[np.int64]
    row_of: NDArray[np.int64]
    row_prices: NDArray[np.float64]
    column_prices: NDArray[np.float64]
    reached: NDArray[np.float64]
    before: NDArray[np.int64]
    open: NDArray[np.int64]
    passed: NDArray[np.uint8]

    @staticmethod
    def room(rows: int, columns: int) -> Assignment:
        """Return room for so many rows and columns."""
        size = max(rows, columns)
        whole, real = np.zeros((4, size), np.int64), np.zeros((3, size))
        return Assignment(
            np.empty(rows * columns),
            whole[0],
            whole[1],
            real[0],
            real[1],
            real[2],
            whole[2],
            whole[3],
            np.zeros(size, np.uint8),
        )


@borrowing
def assign_rows(rows: Integer, columns: Integer, room: Assignment) -> None:
    """Write the column of each row, of which there are no more than columns.

    Shortest augmenting paths (D. F. Crouse, On implementing 2D rectangular assignment algorithms, IEEE Transactions on
    Aerospace and Electronic Systems 52, 2016). Of equal assignments it is the one that scipy's
    ``linear_sum_assignment`` finds.
    """
    room.row_prices[:rows] = 0.0
    room.column_prices[:columns] = 0.0
    room.column_of[:rows] = -1
    room.row_of[:columns] = -1
    for row in range(rows):
        end, least = _shortest_path(row, columns, room)
        _raise_prices(row, rows, columns, least, room)
        column = end
        while column >= 0:  # each row on the path takes the column behind it and leaves its own to the row before
            other = room.before[column]
            room.row_of[column] = other
            left = room.column_of[other]
            room.column_of[other] = column
            column = -1 if other == row else left


@inner
def _shortest_path(row: Integer, columns: Integer, room: Assignment) -> tuple[Integer, float]:
    """Write the cheapest paths from a row (Dijkstra) until one ends at a free column; return
    that column and what the path costs.
    """
    for k in range(columns):
        room.open[k] = columns - 1 - k  # so that equal costs give the identity
        room.reached[k] = np.inf
        room.passed[k] = 0
    remaining, least, at = columns, 0.0, row
    while True:
        nearest, lowest = 0, np.inf
        for k in range(remaining):
            column = room.open[k]
            cost = least + room.costs[at * columns + column] - room.row_prices[at] - room.column_prices[column]
            if cost < room.reached[column]:
                room.reached[column], room.before[column] = cost, at
            if room.reached[column] < lowest or (room.reached[column] == lowest and room.row_of[column] < 0):
                nearest, lowest = k, room.reached[column]
        least, column = lowest, room.open[nearest]
        room.passed[column] = 1
        if room.row_of[column] < 0:
            return column, least
        at = room.row_of[column]
        remaining -= 1
        room.open[nearest] = room.open[remaining]


@inner
def _raise_prices(row: Integer, rows: Integer, columns: Integer, least: float, room: Assignment) -> None:
    """Let the dual variables of all that the search has passed follow, so that no reduced cost is negative."""
    room.row_prices[row] += least
    for other in range(rows):
        column = room.column_of[other]
        if other != row and column >= 0 and room.passed[column]:
            room.row_prices[other] += least - room.reached[column]
    for column in range(columns):
        if room.passed[column]:
            room.column_prices[column] -= least - room.reached[column]
