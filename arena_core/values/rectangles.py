"""A grid's occupied cells as few rectangles."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def cover_with_rectangles(occupied: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Return rectangles (N, 4) of first row, first column, end row and end column that hold each occupied cell (H, W)
    once.

    Runs of cells that lie in equal columns of following rows are one rectangle; the same is tried with rows and columns
    exchanged, and the fewer count.
    """
    by_rows = _merged_runs(occupied)
    by_columns = _merged_runs(occupied.T)
    return by_rows if len(by_rows) <= len(by_columns) else by_columns[:, [1, 0, 3, 2]]


def _merged_runs(occupied: NDArray[np.bool_]) -> NDArray[np.int64]:
    edges = np.diff(np.pad(occupied, ((0, 0), (1, 1))).astype(np.int8), axis=1)
    rows, starts = np.nonzero(edges > 0)
    ends = np.nonzero(edges < 0)[1]
    order = np.lexsort((rows, ends, starts))
    rows, starts, ends = rows[order], starts[order], ends[order]
    is_first = np.ones(len(rows), bool)
    is_first[1:] = (np.diff(rows) != 1) | (np.diff(starts) != 0) | (np.diff(ends) != 0)
    is_last = np.roll(is_first, -1)  # a rectangle ends where the next begins, the last one where the first does
    return np.stack((rows[is_first], starts[is_first], rows[is_last] + 1, ends[is_first]), axis=1)
