"""Where robots are along their paths; paths are packed, path k is ``poses[offsets[k]:offsets[k + 1]]``."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from arena_kernels.compiled import borrowing, inner

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]


@borrowing
def nearest_index(path: Floats, x: float, y: float) -> int:
    """Return the first of the rows of one ``path`` (M, 2 or more) that are nearest to (x, y)."""
    best, best_squared = 0, math.inf
    for i in range(len(path)):
        squared = (path[i, 0] - x) ** 2 + (path[i, 1] - y) ** 2
        if squared < best_squared:
            best, best_squared = i, squared
    return best


@borrowing
def lengths_left(poses: Floats, offsets: Integers, left: Floats) -> None:
    """Fill ``left`` (M,) with the way from each pose to the end of its path, m."""
    for k in range(len(offsets) - 1):
        way = 0.0
        for i in range(offsets[k + 1] - 1, offsets[k] - 1, -1):
            if i + 1 < offsets[k + 1]:
                way += math.hypot(poses[i + 1, 0] - poses[i, 0], poses[i + 1, 1] - poses[i, 1])
            left[i] = way


@borrowing
def update_progress(
    poses: Floats, offsets: Integers, left: Floats, robots: Floats, reach: float, places: Integers, out: Floats
) -> None:
    """Move each robot's place, an index into its path, to the nearest segment within ``reach`` m of path from where it
    was.

    ``out`` (N, 2) gets the way left along the path from the nearest point, and the distance beside it, m; ``left`` is
    what ``lengths_left`` fills.
    """
    for k in range(len(robots)):
        first, last = offsets[k], offsets[k + 1] - 1
        here = first + places[k]
        x, y = robots[k, 0], robots[k, 1]
        best = math.hypot(poses[here, 0] - x, poses[here, 1] - y)
        out[k, 0], out[k, 1] = left[here], best
        begin = here
        while begin > first and left[begin - 1] - left[here] <= reach:
            begin -= 1
        i = begin
        while i < last and left[here] - left[i] <= reach:
            share, away = _nearest_on(poses, i, x, y)
            if away < best:
                best = away
                places[k] = i - first
                out[k, 0], out[k, 1] = left[i] - share * (left[i] - left[i + 1]), away
            i += 1


@borrowing
def points_ahead(poses: Floats, offsets: Integers, robots: Floats, spacing: float, points: Floats) -> None:
    """Fill ``points`` (N, K, 2) with positions every ``spacing`` m along each path ahead of its pose
    nearest to the robot; then the end.
    """
    for k in range(len(robots)):
        last = offsets[k + 1] - 1
        i = offsets[k] + nearest_index(poses[offsets[k] : last + 1], robots[k, 0], robots[k, 1])
        way, due = 0.0, spacing
        for j in range(points.shape[1]):
            points[k, j, 0], points[k, j, 1] = poses[last, 0], poses[last, 1]
            while i < last:
                step = math.hypot(poses[i + 1, 0] - poses[i, 0], poses[i + 1, 1] - poses[i, 1])
                if way + step >= due:
                    share = (due - way) / step
                    points[k, j, 0] = poses[i, 0] + share * (poses[i + 1, 0] - poses[i, 0])
                    points[k, j, 1] = poses[i, 1] + share * (poses[i + 1, 1] - poses[i, 1])
                    break
                way += step
                i += 1
            due += spacing


@inner
def _nearest_on(poses: Floats, i: int, x: float, y: float) -> tuple[float, float]:
    """Return which share of the segment from pose i the nearest point lies at, and how far it is, m."""
    dx, dy = poses[i + 1, 0] - poses[i, 0], poses[i + 1, 1] - poses[i, 1]
    squared = dx * dx + dy * dy
    share = 0.0
    if squared > 0.0:
        share = min(max(((x - poses[i, 0]) * dx + (y - poses[i, 1]) * dy) / squared, 0.0), 1.0)
    return share, math.hypot(poses[i, 0] + share * dx - x, poses[i, 1] + share * dy - y)
