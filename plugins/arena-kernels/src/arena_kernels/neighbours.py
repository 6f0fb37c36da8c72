"""Which pairs of people are near each other.

Both ways list the same pairs in the same order (by the later person, then by the earlier), so sums over them agree to
the last bit.
"""

from __future__ import annotations

from math import isnan

import numpy as np
from numpy.typing import NDArray

from arena_kernels.compiled import borrowing, compiled

CELLS_FROM = 48  # people; below, testing every pair is faster
_CELLS_A_SIDE = 512  # bounds the memory of the cell table when people are scattered widely


@compiled
def near_pairs(positions: NDArray[np.float64], reach: float, pairs: NDArray[np.int32]) -> tuple[NDArray[np.int32], int]:
    """Return the pairs (earlier, later) of people nearer than ``reach`` m, and their number.

    ``pairs`` (M, 2) is overwritten, or replaced when it is too small.
    """
    if len(positions) < CELLS_FROM:
        return all_pairs(positions, reach, pairs)
    return pairs_by_cells(positions, reach, pairs)


@compiled
def all_pairs(positions: NDArray[np.float64], reach: float, pairs: NDArray[np.int32]) -> tuple[NDArray[np.int32], int]:
    """Test every pair."""
    found = 0
    for later in range(len(positions)):
        x, y = positions[later, 0], positions[later, 1]
        pairs = _grow_pairs(pairs, found + later)
        for earlier in range(later):
            dx, dy = x - positions[earlier, 0], y - positions[earlier, 1]
            if dx * dx + dy * dy < reach * reach:
                pairs[found, 0], pairs[found, 1] = earlier, later
                found += 1
    return pairs, found


@compiled
def pairs_by_cells(
    positions: NDArray[np.float64], reach: float, pairs: NDArray[np.int32]
) -> tuple[NDArray[np.int32], int]:
    """Test only people in the same or a neighbouring square cell of side ``reach`` (or more, where people are scattered
    widely).

    Who is nowhere (NaN) is near no one.
    """
    low_x, low_y, extent = _bounding_square(positions)
    side = max(reach, extent / (_CELLS_A_SIDE - 1))
    width = int(extent / side) + 3  # a rim of empty cells on each side
    newest = np.empty(width * width, np.int32)
    for cell in range(len(newest)):
        newest[cell] = -1
    older = np.empty(len(positions), np.int32)
    found = 0
    for later in range(len(positions)):
        x, y = positions[later, 0], positions[later, 1]
        if isnan(x):
            continue
        home = (int((y - low_y) / side) + 1) * width + int((x - low_x) / side) + 1
        first = found
        for row in range(-width, width + 1, width):
            for cell in range(home + row - 1, home + row + 2):
                earlier = int(newest[cell])
                while earlier >= 0:
                    dx, dy = x - positions[earlier, 0], y - positions[earlier, 1]
                    if dx * dx + dy * dy < reach * reach:
                        pairs = _grow_pairs(pairs, found + 1)
                        found = _insert_pair(pairs, first, found, earlier, later)
                    earlier = int(older[earlier])
        older[later] = newest[home]
        newest[home] = later
    return pairs, found


@compiled
def _bounding_square(positions: NDArray[np.float64]) -> tuple[float, float, float]:
    """Return the lower left corner of a square around all positions, and its side."""
    low_x, low_y, high_x, high_y = np.inf, np.inf, -np.inf, -np.inf
    for i in range(len(positions)):
        if isnan(positions[i, 0]):
            continue
        low_x, high_x = min(low_x, positions[i, 0]), max(high_x, positions[i, 0])
        low_y, high_y = min(low_y, positions[i, 1]), max(high_y, positions[i, 1])
    return low_x, low_y, max(high_x - low_x, high_y - low_y)


@borrowing
def _insert_pair(pairs: NDArray[np.int32], first: int, found: int, earlier: int, later: int) -> int:
    """Put a pair in its place among those of the same later person."""
    place = found
    while place > first and pairs[place - 1, 0] > earlier:
        pairs[place, 0], pairs[place, 1] = pairs[place - 1, 0], later
        place -= 1
    pairs[place, 0], pairs[place, 1] = earlier, later
    return found + 1


@compiled
def _grow_pairs(pairs: NDArray[np.int32], wanted: int) -> NDArray[np.int32]:
    if wanted <= len(pairs):
        return pairs
    grown = np.empty((2 * wanted, 2), np.int32)
    for pair in range(len(pairs)):  # as a slice this takes seconds to compile
        grown[pair, 0], grown[pair, 1] = pairs[pair, 0], pairs[pair, 1]
    return grown
