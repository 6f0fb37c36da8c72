"""The part of the global path that a band is made for: from the robot to a local goal inside the window."""

from __future__ import annotations

import math

from arena_core import NoValidCommand, Pose
from arena_kernels.compiled import borrowing
from arena_kernels.costmap_window import BORDER, CostmapWindow, distance_at
from arena_kernels.paths import nearest_index
from arena_teb.columns import X, Y
from arena_teb.problem import FloatArray

# m, a robot as near to an earlier part of the path as to a later one has not passed the earlier one yet


def local_plan(
    path: FloatArray, pose: Pose, window: CostmapWindow, lookahead: float, inscribed_radius: float
) -> tuple[FloatArray, bool]:
    """Return the poses (M, 3) of a path ahead of the robot, and whether they end at the path's end.

    They end ``lookahead`` m along the path, at the window's border, or before an obstacle that lies on what would be
    the last pose.
    """
    if len(path) == 0:
        raise NoValidCommand("teb: the path is empty")
    ahead = path[nearest_index(path, pose.x, pose.y) :]
    last = last_reached(ahead, window, lookahead, inscribed_radius)
    return ahead[: last + 1], last + 1 == len(ahead)


@borrowing
def last_reached(ahead: FloatArray, window: CostmapWindow, lookahead: float, inscribed_radius: float) -> int:
    """Return the last pose of ``ahead`` (M, 3) within ``lookahead`` m and the window whose middle can be reached."""
    rows, columns = window.costs.shape
    left, below = window.origin_x + BORDER, window.origin_y + BORDER
    right, above = left + columns * window.resolution - 2.0 * BORDER, below + rows * window.resolution - 2.0 * BORDER
    along, end = 0.0, 0
    while end < len(ahead):
        x, y = ahead[end, X], ahead[end, Y]
        if end > 0:
            along += math.hypot(x - ahead[end - 1, X], y - ahead[end - 1, Y])
        if not (left <= x <= right and below <= y <= above and along <= lookahead):
            break
        end += 1
    return last_free(ahead[: max(1, end)], window, inscribed_radius)


@borrowing
def last_free(poses: FloatArray, window: CostmapWindow, inscribed_radius: float) -> int:
    """Return the last pose whose middle can be reached, the last of all if there is none."""
    for k in range(len(poses) - 1, 0, -1):
        if distance_at(window, poses[k, X], poses[k, Y]) > inscribed_radius:
            return k
    return len(poses) - 1


def end_heading(plan: FloatArray, pose: Pose, over: float) -> float:
    """Return the direction in which a plan (M, 3) ends, taken over its last ``over`` m; from the
    robot where it is shorter.
    """
    x, y = plan[-1, :2].tolist()
    before = last_beyond(plan, over)
    fx, fy = plan[before, :2].tolist() if before >= 0 else (pose.x, pose.y)
    return math.atan2(y - fy, x - fx) if math.hypot(x - fx, y - fy) > 1e-3 else pose.theta


@borrowing
def last_beyond(plan: FloatArray, over: float) -> int:
    """Return the last pose of a plan (M, 3) that is more than ``over`` m away from its end, -1 if there is none."""
    for i in range(len(plan) - 1, -1, -1):
        if math.hypot(plan[i, X] - plan[-1, X], plan[i, Y] - plan[-1, Y]) > over:
            return i
    return -1
