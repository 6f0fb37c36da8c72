"""Cells turned into convex polygons, as costmap_converter's CostmapToPolygonsDBSMCCH does: density-based clusters and
their hulls.

Ester, Kriegel, Sander and Xu, A density-based algorithm for discovering clusters, KDD 1996; Andrew, Another efficient
algorithm for convex hulls in two dimensions, Information Processing Letters 9, 1979.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from arena_kernels.compiled import borrowing, compiled, inner
from arena_kernels.costmap_window import LETHAL, CostmapWindow
from arena_teb.columns import X, Y
from arena_teb.parameters import Polygons
from arena_teb.problem import FloatArray, IntArray


class Hulls(NamedTuple):
    """P convex polygons, lines or points in ``map``: number i has ``corners[starts[i]:starts[i + 1]]`` (V, 2),
    counter-clockwise.

    ``starts`` (P + 1,) is empty where cells are not turned into polygons.
    """

    corners: FloatArray
    starts: IntArray


NO_HULLS = Hulls(np.empty((0, 2)), np.empty(0, np.int64))


def hulls_of(window: CostmapWindow, settings: Polygons) -> Hulls:
    """Return the polygons of a window's lethal cells."""
    far = settings.cluster_max_distance / window.resolution
    cells, labels = cluster_cells(window.costs >= LETHAL, far, settings.cluster_min_pts, settings.cluster_max_pts)
    points = np.array((window.origin_x, window.origin_y)) + (cells[:, ::-1] + 0.5) * window.resolution
    return hulls_around(points, labels, settings.min_pt_separation)


@compiled
def cluster_cells(lethal: np.ndarray, far: float, least: int, most: int) -> tuple[IntArray, IntArray]:
    """Return cells (C, 2) as (row, column), those of one cluster together, and the number of each one's cluster (C,).

    A cell with ``least`` others within ``far`` cells begins a cluster, which grows over such cells up to ``most`` of
    them; a cell that belongs to none is a cluster of its own.
    """
    rows, columns = lethal.shape
    seen = np.zeros((rows, columns), np.bool_)
    total = int(lethal.sum())
    cells, labels = np.empty((total, 2), np.int64), np.empty(total, np.int64)
    queue = np.empty((total, 2), np.int64)
    queued = np.full((rows, columns), -1, np.int64)
    done, count = 0, 0
    for row in range(rows):
        for column in range(columns):
            if not lethal[row, column] or seen[row, column]:
                continue
            first = done
            seen[row, column] = True
            cells[done, 0], cells[done, 1], labels[done] = row, column, count
            done += 1
            waiting = near_cells(lethal, row, column, far, least, count, queue, 0, queued)
            taken = 0
            while taken < waiting and done - first < most:
                r, c = queue[taken]
                taken += 1
                if seen[r, c]:
                    continue
                seen[r, c] = True
                cells[done, 0], cells[done, 1], labels[done] = r, c, count
                done += 1
                waiting = near_cells(lethal, r, c, far, least, count, queue, waiting, queued)
            count += 1
    return cells, labels


@borrowing
def near_cells(
    lethal: np.ndarray,
    row: int,
    column: int,
    far: float,
    least: int,
    cluster: int,
    queue: IntArray,
    waiting: int,
    queued: IntArray,
) -> int:
    """Put the cells near a dense one into the queue, each once a cluster; return how many are in it."""
    reach = math.floor(far)
    low, high = max(row - reach, 0), min(row + reach + 1, lethal.shape[0])
    left, right = max(column - reach, 0), min(column + reach + 1, lethal.shape[1])
    others = -1
    for r in range(low, high):
        for c in range(left, right):
            others += lethal[r, c] and (r - row) ** 2 + (c - column) ** 2 <= far * far
    if others < least:
        return waiting
    for r in range(low, high):
        for c in range(left, right):
            if lethal[r, c] and queued[r, c] != cluster and (r - row) ** 2 + (c - column) ** 2 <= far * far:
                queued[r, c] = cluster
                queue[waiting, 0], queue[waiting, 1] = r, c
                waiting += 1
    return waiting


@compiled
def hulls_around(points: FloatArray, labels: IntArray, separation: float) -> Hulls:
    """Return the convex hulls of clusters of points (C, 2), corners nearer than ``separation`` m
    to the one before left out.
    """
    total = len(points)
    corners, starts = np.empty((2 * total, 2)), np.zeros(total + 1, np.int64)
    end, many, first = 0, 0, 0
    while first < total:
        last = first
        while last < total and labels[last] == labels[first]:
            last += 1
        end += convex_hull(points[first:last], separation, corners[end:])
        many += 1
        starts[many] = end
        first = last
    return Hulls(corners[:end].copy(), starts[: many + 1].copy())


@compiled
def convex_hull(points: FloatArray, separation: float, corners: FloatArray) -> int:
    """Write the convex hull of points (C, 2), counter-clockwise from the lowest x,
    and return how many corners it has.
    """
    # by x, then y: cells differ by centimetres, windows are metres wide
    order = np.argsort(points[:, X] * 1e6 + points[:, Y])
    hull = np.empty((2 * len(points), 2))
    size = 0
    for way in range(2):
        floor = size
        for j in range(len(order)):
            point = points[order[j if way == 0 else len(order) - 1 - j]]
            while size >= floor + 2 and not turns_left(hull[size - 2], hull[size - 1], point):
                size -= 1
            hull[size] = point
            size += 1
        size -= 1  # the last point begins the way back
    kept = 0
    for j in range(max(size, 1)):
        far = (
            kept == 0 or math.hypot(hull[j, X] - corners[kept - 1, X], hull[j, Y] - corners[kept - 1, Y]) >= separation
        )
        if far:
            corners[kept] = hull[j]
            kept += 1
    return kept


@inner
def turns_left(a: FloatArray, b: FloatArray, c: FloatArray) -> bool:
    """Return whether the way over three points turns to the left."""
    return bool((b[X] - a[X]) * (c[Y] - a[Y]) - (b[Y] - a[Y]) * (c[X] - a[X]) > 0.0)
