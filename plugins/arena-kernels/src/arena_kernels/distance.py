"""Exact Euclidean distance transforms of grids."""

from __future__ import annotations

from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from arena_kernels.compiled import borrowing, compiled

NARROW = 256  # columns, up to which a row's cells are compared with each other
SQUARED_FITS = 2**15 - 1  # cells, up to which twice a square is a number of 32 bits
# [cells^2] stands for infinitely far in numbers of 16 bits: with any square of a small grid it stays one
FAR = 2**15 - 1
FEW = 4  # where at most one of so many columns holds a blocked cell, each row is compared with these columns alone


class Grid(Protocol):
    """What these kernels read of an occupancy grid; ``occupied`` has shape (H, W), ``resolution`` is in m."""

    @property
    def occupied(self) -> NDArray[np.bool_]:
        """Return which cells are occupied."""

    @property
    def resolution(self) -> float:
        """Return the side of a cell."""


def distance_field(blocked: NDArray[Any], resolution: float) -> NDArray[np.float32]:
    """Return the distance from each cell's centre to the centre of the nearest blocked cell, m, inf when none is; (H,
    W).

    Felzenszwalb and Huttenlocher, Distance Transforms of Sampled Functions, Theory of Computing 8, 2012; narrow grids,
    such as windows, by comparing the cells of each row.
    """
    cells = np.ascontiguousarray(blocked, dtype=np.bool_).view(np.uint8)
    field = np.empty(cells.shape, np.float32)
    write_distances(cells, float(resolution), field)
    return field


def grid_distance(grid: Grid) -> NDArray[np.float32]:
    """Return the distance field of a grid's occupied cells; meant for ``grid.derive(grid_distance)``."""
    return distance_field(grid.occupied, grid.resolution)


@compiled
def write_distances(cells: NDArray[np.uint8], resolution: float, field: NDArray[np.float32]) -> None:
    """Write the distance field of ``cells`` (H, W), blocked where they are not 0, to ``field``
    (H, W): for other kernels.
    """
    rows, columns = cells.shape
    none = rows + columns  # farther than any cell of the grid
    along = _distance_along_columns(cells, none)
    holding = _columns_below(along, none)
    if len(holding) == 0:
        field[:] = np.inf
        return
    if (rows - 1) ** 2 + (columns - 1) ** 2 < FAR and columns**2 <= FAR:
        squares = np.empty((rows, columns), np.uint16)
        if FEW * len(holding) <= columns:
            greatest = _nearest_of_few(along, holding, np.uint16(FAR), squares)
        else:
            greatest = _nearest_in_rows(along, none, np.uint16(FAR), squares)
        _write_rooted(squares, greatest, np.uint16(FAR), resolution, field)
        return
    if columns <= NARROW and none <= SQUARED_FITS:
        far, squares_of_grid = np.int32(2 * none * none), np.empty((rows, columns), np.int32)
        _write_rooted(squares_of_grid, _nearest_in_rows(along, none, far, squares_of_grid), far, resolution, field)
        return
    sites = np.empty(columns, np.int64)
    starts = np.empty(columns + 1, np.float64)
    for row in range(rows):
        _lower_envelope(along[row], none, sites, starts, resolution, field[row])


@compiled
def _columns_below(along: NDArray[np.int32], none: int) -> NDArray[np.int64]:
    """Return the columns that hold a blocked cell: all cells of them are nearer than ``none``, those of others none."""
    return np.flatnonzero(along[0] < none)


@compiled
def _nearest_of_few(along: NDArray[np.int32], holding: NDArray[np.int64], far: Any, squares: NDArray[Any]) -> Any:
    """Write how far the nearest blocked cell is from each, squared, where few columns are ``holding`` any; return the
    greatest.
    """
    columns, narrow = along.shape[1], squares.dtype.type
    middle, greatest = np.uint64(columns), narrow(0)
    aside = np.empty(2 * columns + 1, squares.dtype)  # squares of how far columns are apart
    for i in range(len(aside)):
        aside[i] = narrow((i - columns) ** 2)
    for row in range(len(along)):
        nearest = squares[row]
        nearest[:] = far
        for column in holding:
            up, first = narrow(along[row, column] * along[row, column]), middle - np.uint64(column)
            for i in range(np.uint64(columns)):
                nearest[i] = min(nearest[i], narrow(aside[first + i] + up))
        for i in range(columns):
            greatest = max(greatest, nearest[i])
    return greatest


@compiled
def _nearest_in_rows(along: NDArray[np.int32], none: int, far: Any, squares: NDArray[Any]) -> Any:
    """Write how far the nearest blocked cell is from each, squared, ``far`` when there is none;
    return the greatest that is nearer.
    """
    row_squares, greatest = np.empty(3 * along.shape[1] + 4, squares.dtype), squares.dtype.type(0)
    for row in range(len(along)):
        greatest = max(greatest, _nearest_in_row(along[row], none, far, row_squares, squares[row]))
    return greatest


@borrowing
def _nearest_in_row(
    heights: NDArray[np.int32], none: int, far: Any, squares: NDArray[Any], nearest: NDArray[Any]
) -> Any:
    """Compare every column with those one, two, three ... columns away, until none of these can be nearer: in vector
    registers.

    ``squares`` is room for three rows and four more columns. Numbers are as narrow as ``nearest``: a register holds
    more of them.
    """
    # unsigned: an index that cannot count from an array's end leaves the loops to vector registers
    columns = np.uint64(len(heights))
    middle, one, narrow = columns + np.uint64(1), np.uint64(1), nearest.dtype.type
    squares[:] = far  # what lies beyond the row's ends is no nearer
    farthest = narrow(0)
    for i in range(columns):
        square = narrow(heights[i] * heights[i]) if heights[i] < none else far
        squares[middle + i] = nearest[i] = square
        farthest = max(farthest, square)
    away = one
    while away < columns and farthest > narrow(away * away):
        square, next_square = narrow(away * away), narrow((away + one) * (away + one))
        left, right, farthest = middle - away, middle + away, narrow(0)
        for i in range(columns):
            beside = narrow(min(squares[left + i], squares[right + i]) + square)
            further = narrow(min(squares[left - one + i], squares[right + one + i]) + next_square)
            least = min(nearest[i], min(beside, further))
            nearest[i] = least
            farthest = max(farthest, least)
        away += one + one
    return farthest if farthest < far else narrow(0)  # all cells of a row are far, or none is


@compiled
def _write_rooted(
    squares: NDArray[Any], greatest: Any, far: Any, resolution: float, field: NDArray[np.float32]
) -> None:
    """Write the roots of squares times the resolution, inf for ``far``; of few
    different squares each root is drawn once.
    """
    rows, columns = squares.shape
    if 2 * np.int64(greatest) > squares.size:
        for row in range(rows):
            for column in range(columns):
                square = squares[row, column]
                field[row, column] = np.inf if square >= far else np.sqrt(np.float64(square)) * resolution
        return
    roots = np.empty(np.int64(greatest) + 1, np.float32)
    for square in range(len(roots)):
        roots[square] = np.sqrt(np.float64(square)) * resolution
    for row in range(rows):
        for column in range(columns):
            square = squares[row, column]
            field[row, column] = np.inf if square >= far else roots[square]


@compiled
def _distance_along_columns(cells: NDArray[np.uint8], none: int) -> NDArray[np.int32]:
    """Return how many rows away the nearest blocked cell of the same column is, ``none`` when there is no such cell."""
    rows, columns = cells.shape
    away = np.empty((rows, columns), np.int32)
    for column in range(columns):
        away[0, column] = 0 if cells[0, column] else none
    for row in range(1, rows):
        for column in range(columns):
            away[row, column] = 0 if cells[row, column] else min(away[row - 1, column] + 1, none)
    for row in range(rows - 2, -1, -1):
        for column in range(columns):
            away[row, column] = min(away[row, column], away[row + 1, column] + 1)
    return away


@compiled
def _lower_envelope(
    heights: NDArray[np.int32],
    none: int,
    sites: NDArray[np.int64],
    starts: NDArray[np.float64],
    resolution: float,
    out: NDArray[np.float32],
) -> None:
    """Evaluate the lower envelope of the parabolas (x - site)^2 + heights[site]^2 in every
    column; integers keep it exact.
    """
    last = -1
    for site in range(len(heights)):
        if heights[site] >= none:
            continue
        start = -np.inf
        height = float(heights[site]) ** 2 + float(site) ** 2
        while last >= 0:
            other = sites[last]
            start = (height - float(heights[other]) ** 2 - float(other) ** 2) / (2.0 * (site - other))
            if start > starts[last]:
                break
            last -= 1
        if last < 0:
            start = -np.inf
        last += 1
        sites[last] = site
        starts[last] = start
    if last < 0:
        out[:] = np.inf
        return
    starts[last + 1] = np.inf
    current = 0
    for column in range(len(out)):
        while starts[current + 1] < column:
            current += 1
        site = sites[current]
        squared = (column - site) ** 2 + np.int64(heights[site]) ** 2
        out[column] = np.sqrt(float(squared)) * resolution
