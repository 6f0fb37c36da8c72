"""Connected regions of a grid."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from arena_kernels.compiled import compiled


def connected_components(free: NDArray[np.bool_]) -> NDArray[np.int32]:
    """Return a label for each cell (H, W): 0 where it is not free, equal ones where
    four-neighbours join, numbered row by row.
    """
    labels = np.empty(free.shape, np.int32)
    _label_regions(np.ascontiguousarray(free, dtype=np.bool_).view(np.uint8), labels)
    return labels


@compiled
def _label_regions(free: NDArray[np.uint8], labels: NDArray[np.int32]) -> None:
    rows, columns = free.shape
    labels[:] = 0
    queue, last = np.empty(free.size + 1, np.int64), 0
    for seed in range(free.size):
        if free[seed // columns, seed % columns] == 0 or labels[seed // columns, seed % columns] != 0:
            continue
        last += 1
        labels[seed // columns, seed % columns] = last
        queue[0], begin, end = seed, 0, 1
        while begin < end:
            row, column = queue[begin] // columns, queue[begin] % columns
            begin += 1
            for side in range(4):
                r, c = row + (side == 0) - (side == 1), column + (side == 2) - (side == 3)
                if 0 <= r < rows and 0 <= c < columns and free[r, c] != 0 and labels[r, c] == 0:
                    labels[r, c] = last
                    queue[end] = r * columns + c
                    end += 1
