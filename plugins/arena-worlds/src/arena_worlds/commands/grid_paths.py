"""How long the ways between places are, and how wide: kernels over the cells of a grid."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from arena_kernels.compiled import compiled

STRAIGHT, DIAGONAL = 5, 7  # lengths of steps to the 8 neighbours, in fifths of a cell: 1 % off the square root of two
UNREACHED = 2**30


@compiled
def path_lengths(room: NDArray[np.uint8], row: int, column: int) -> NDArray[np.int32]:
    """Return the length of the shortest way from one cell to every cell of ``room`` (H, W), fifths of a cell; UNREACHED
    elsewhere.

    Sweeps to and fro until nothing changes: as often as the ways turn back (Borgefors, Distance Transformations in
    Digital Images, CVGIP 1986, within walls). Walls surround the room, so that no step leaves the grid.
    """
    rows, columns = room.shape
    lengths = np.full((rows, columns), UNREACHED, np.int32)
    lengths[row, column] = 0
    changed = True
    while changed:
        changed = False
        for r in range(1, rows - 1):
            for c in range(1, columns - 1):
                if room[r, c]:
                    straight = min(lengths[r, c - 1], lengths[r - 1, c]) + STRAIGHT
                    best = min(straight, min(lengths[r - 1, c - 1], lengths[r - 1, c + 1]) + DIAGONAL)
                    if best < lengths[r, c]:
                        lengths[r, c] = best
                        changed = True
        for r in range(rows - 2, 0, -1):
            for c in range(columns - 2, 0, -1):
                if room[r, c]:
                    straight = min(lengths[r, c + 1], lengths[r + 1, c]) + STRAIGHT
                    best = min(straight, min(lengths[r + 1, c + 1], lengths[r + 1, c - 1]) + DIAGONAL)
                    if best < lengths[r, c]:
                        lengths[r, c] = best
                        changed = True
    return lengths


@compiled
def join_levels(
    clearance: NDArray[np.float32], order: NDArray[np.int64], marks: NDArray[np.int64]
) -> tuple[float, float]:
    """Return the least and the mean clearance over all pairs of marked cells, each pair's along its roomiest way.

    ``clearance`` (H, W); ``order`` the flat cells that ways may use, roomiest first; ``marks`` (H * W,) how many marks
    a cell has. Cells are joined in that order (Kruskal's spanning tree): the cell that first joins two marks is the
    narrowest place of the roomiest way between them. NaN with fewer than two marks.
    """
    columns = clearance.shape[1]
    parent = np.full(clearance.size, -1, np.int64)
    count = marks.copy()
    least, total, pairs = np.nan, 0.0, 0
    for cell in order:
        parent[cell] = cell
        level = float(clearance.flat[cell])
        for step in (-columns, -1, 1, columns):
            other = cell + step
            if parent[other] < 0:
                continue
            a, b = _find_root(parent, cell), _find_root(parent, other)
            if a == b:
                continue
            joined = count[a] * count[b]
            if joined:
                least = level
                total += joined * level
                pairs += joined
            parent[b] = a
            count[a] += count[b]
    return least, (total / pairs if pairs else np.nan)


@compiled
def climb_clearance(clearance: NDArray[np.float32], cells: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return where flat ``cells`` come to by steps to the roomiest of the 8
    neighbours, each in the middle of its place.
    """
    columns = clearance.shape[1]
    tops = cells.copy()
    for k in range(len(cells)):
        here = cells[k]
        while True:
            best = here
            for row in range(-1, 2):
                for column in range(-1, 2):
                    other = here + row * columns + column
                    if clearance.flat[other] > clearance.flat[best]:
                        best = other
            if best == here:
                break
            here = best
        tops[k] = here
    return tops


@compiled
def _find_root(parent: NDArray[np.int64], cell: int) -> int:
    while parent[cell] != cell:
        parent[cell] = parent[parent[cell]]
        cell = parent[cell]
    return cell
