"""The part of the global path that a band is made for: from the robot to a local goal inside the window."""

from __future__ import annotations

import math

import numpy as np

from arena_core import NoValidCommand, Pose
from arena_kernels.window import Window, distance_at
from arena_teb.problem import FloatArray

BORDER = 0.3  # m, the local goal stays so far inside the window
BACKTRACK = 0.5  # m, a robot as near to an earlier part of the path as to a later one has not passed the earlier one yet


def local_plan(path: FloatArray, pose: Pose, window: Window, lookahead: float, inscribed_radius: float) -> tuple[FloatArray, bool]:
    """Return the poses (M, 3) of a path ahead of the robot, and whether they end at the path's end.

    They end ``lookahead`` m along the path, at the window's border, or before an obstacle that lies on what would be the last pose.
    """
    if len(path) == 0:
        raise NoValidCommand("teb: the path is empty")
    ahead = path[_nearest(path, pose) :]
    along = np.concatenate(((0.0,), np.cumsum(np.hypot(*np.diff(ahead[:, :2], axis=0).T))))
    rows, columns = window.costs.shape
    low = np.array((window.origin_x, window.origin_y)) + BORDER
    high = low + np.array((columns, rows)) * window.resolution - 2.0 * BORDER
    inside = ((ahead[:, :2] >= low) & (ahead[:, :2] <= high)).all(axis=1) & (along <= lookahead)
    end = len(ahead) if inside.all() else max(1, int(np.argmin(inside)))
    free = _last_free(ahead[:end], window, inscribed_radius)
    return ahead[: free + 1], free + 1 == len(ahead)


def _nearest(path: FloatArray, pose: Pose) -> int:
    return int(np.argmin((path[:, 0] - pose.x) ** 2 + (path[:, 1] - pose.y) ** 2))


def _last_free(poses: FloatArray, window: Window, inscribed_radius: float) -> int:
    """Return the last pose whose middle can be reached, the last of all if there is none."""
    for k in range(len(poses) - 1, 0, -1):
        if distance_at(window, poses[k, 0], poses[k, 1]) > inscribed_radius:
            return k
    return len(poses) - 1


def headings_along(positions: FloatArray, last: float) -> FloatArray:
    """Return the heading from each position (M, 2) to the next, and ``last`` for the last."""
    steps = np.diff(positions, axis=0)
    return np.append(np.arctan2(steps[:, 1], steps[:, 0]), last)


def heading_of_end(plan: FloatArray, pose: Pose, over: float) -> float:
    """Return the direction in which a plan (M, 3) ends, taken over its last ``over`` m; from the robot where it is shorter."""
    x, y = plan[-1, :2].tolist()
    away = np.hypot(plan[:, 0] - x, plan[:, 1] - y)
    before = np.flatnonzero(away > over)
    fx, fy = plan[before[-1], :2].tolist() if len(before) else (pose.x, pose.y)
    return math.atan2(y - fy, x - fx) if math.hypot(x - fx, y - fy) > 1e-3 else pose.theta
