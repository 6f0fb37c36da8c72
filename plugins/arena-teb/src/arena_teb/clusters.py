"""Static obstacles as the robot's middle meets them: connected regions, and a point in each."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from arena_kernels.compiled import compiled
from arena_kernels.costmap_window import CostmapWindow
from arena_teb.columns import X, Y
from arena_teb.problem import FloatArray, IntArray

ROUNDED = 1e-3  # cells, more than a distance is rounded by
FARTHEST = 1e6  # cells, in place of infinitely many


@compiled
def cluster_points(window: CostmapWindow, inscribed_radius: float, x: float, y: float, most: int) -> FloatArray:
    """Return a point (C, 2) inside each connected region that the robot's middle cannot enter, at most the ``most``
    nearest to (x, y).

    It is the cell nearest to the region's centre of mass, the first of them in the window's order.
    """
    columns = window.distance.shape[1]
    cells, starts = connected_components(window.distance, inscribed_radius + 0.5 * window.resolution, window.resolution)
    count = len(starts) - 1
    points, nearest = np.empty((count, 2)), np.full(count, np.inf)
    for k in range(count):
        region = cells[starts[k] : starts[k + 1]]
        middle_row, middle_column = 0.0, 0.0
        for cell in region:
            middle_row += cell // columns
            middle_column += cell % columns
        middle_row, middle_column = middle_row / len(region), middle_column / len(region)
        least, chosen = np.inf, region[0]
        for cell in region:
            row, column = cell // columns, cell % columns
            px, py = (
                window.origin_x + (column + 0.5) * window.resolution,
                window.origin_y + (row + 0.5) * window.resolution,
            )
            off = (row - middle_row) ** 2 + (column - middle_column) ** 2
            if off < least or (off == least and cell < chosen):
                least, chosen = off, cell
                points[k, X], points[k, Y] = px, py
            nearest[k] = min(nearest[k], (px - x) ** 2 + (py - y) ** 2)
    return points[np.argsort(nearest)[:most]]


@compiled
def connected_components(distance: NDArray[np.float32], below: float, resolution: float) -> tuple[IntArray, IntArray]:
    """Return the cells with ``distance`` under ``below`` by their regions (8 neighbours): number i has
    cells[starts[i]:starts[i + 1]].

    A cell is row times columns + column; ``resolution`` is its side, m.
    """
    rows, columns = distance.shape
    seen, cells, starts = (
        np.zeros((rows, columns), np.bool_),
        np.empty(rows * columns, np.int64),
        np.zeros(rows * columns + 1, np.int64),
    )
    end, count = 0, 0
    for first_row in range(rows):
        first = 0
        while first < columns:
            spare = distance[first_row, first] - below
            if spare >= 0.0:  # distances change by no more than the way between two cells
                first += max(1, int(min(spare / resolution - ROUNDED, FARTHEST)))
                continue
            if not seen[first_row, first]:
                seen[first_row, first] = True
                done, cells[end] = end, first_row * columns + first
                end += 1
                while done < end:
                    row, column = cells[done] // columns, cells[done] % columns
                    done += 1
                    for r in range(max(row - 1, 0), min(row + 2, rows)):
                        for c in range(max(column - 1, 0), min(column + 2, columns)):
                            if not seen[r, c] and distance[r, c] < below:
                                seen[r, c] = True
                                cells[end] = r * columns + c
                                end += 1
                count += 1
                starts[count] = end
            first += 1
    return cells[:end].copy(), starts[: count + 1].copy()
