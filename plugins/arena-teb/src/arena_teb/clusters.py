"""Static obstacles as the robot's middle meets them: connected regions, and a point in each."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from arena_kernels.compiled import compiled
from arena_kernels.window import Window
from arena_teb.problem import FloatArray, IntArray


@compiled
def cluster_points(window: Window, inscribed_radius: float, x: float, y: float, most: int) -> FloatArray:
    """Return a point (C, 2) inside each connected region that the robot's middle cannot enter, at most the ``most`` nearest to (x, y)."""
    rows, columns = window.distance.shape
    labels, count = labelled(window.distance, inscribed_radius + 0.5 * window.resolution)
    sums = np.zeros((count, 3))
    for row in range(rows):
        for column in range(columns):
            if labels[row, column] >= 0:
                k = labels[row, column]
                sums[k, 0] += row
                sums[k, 1] += column
                sums[k, 2] += 1.0
    points, gaps = np.empty((count, 2)), np.full(count, np.inf)
    nearest = np.full(count, np.inf)
    for row in range(rows):
        for column in range(columns):
            if labels[row, column] < 0:
                continue
            k = labels[row, column]
            px, py = window.origin_x + (column + 0.5) * window.resolution, window.origin_y + (row + 0.5) * window.resolution
            off = (row - sums[k, 0] / sums[k, 2]) ** 2 + (column - sums[k, 1] / sums[k, 2]) ** 2
            if off < gaps[k]:
                gaps[k], points[k, 0], points[k, 1] = off, px, py
            nearest[k] = min(nearest[k], (px - x) ** 2 + (py - y) ** 2)
    return points[np.argsort(nearest)[:most]]


@compiled
def labelled(distance: NDArray[np.float32], below: float) -> tuple[IntArray, int]:
    """Return the number of the region (8 neighbours) that each cell with ``distance`` under ``below`` belongs to, -1 for others."""
    rows, columns = distance.shape
    labels = np.full((rows, columns), -1, np.int64)
    stack = np.empty(rows * columns, np.int64)
    count = 0
    for first in range(rows * columns):
        if labels[first // columns, first % columns] >= 0 or distance[first // columns, first % columns] >= below:
            continue
        labels[first // columns, first % columns] = count
        stack[0], top = first, 1
        while top > 0:
            top -= 1
            row, column = stack[top] // columns, stack[top] % columns
            for r in range(max(row - 1, 0), min(row + 2, rows)):
                for c in range(max(column - 1, 0), min(column + 2, columns)):
                    if labels[r, c] < 0 and distance[r, c] < below:
                        labels[r, c] = count
                        stack[top] = r * columns + c
                        top += 1
        count += 1
    return labels, count
