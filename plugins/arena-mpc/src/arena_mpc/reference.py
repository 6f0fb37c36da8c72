"""What to follow: the path from the robot to the local goal, and beside each stage of a plan
the path's place and direction.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from arena_kernels.compiled import borrowing, compiled, inner
from arena_kernels.costmap_window import BORDER, CostmapWindow, distance_at
from arena_mpc.arrays import FloatArray
from arena_mpc.columns import HEADING, NORMAL_X, NORMAL_Y, REFERENCE_X, REFERENCE_Y, THETA, X, Y

SEARCH = 3.0  # m, how far along its path the robot may have come since it was last asked


class Reference(NamedTuple):
    """The part of the path ahead: ``path`` (M, 3) from beside the robot to the local goal; ``final`` when that is the
    path's end.

    ``via_points`` (V, 2): points of it that plans are drawn to.
    """

    path: FloatArray
    final: bool
    via_points: FloatArray

    @property
    def goal(self) -> FloatArray:
        """Return the local goal (3,), heading along the path."""
        return np.asarray(self.path[-1])


class PathProgress:
    """Remembers how far the robot has come, so that a path that comes near itself is not cut short."""

    def __init__(self) -> None:
        self.clear()

    def clear(self) -> None:
        """Forget the path."""
        self._path: FloatArray | None = None
        self._place = 0

    def prune_path(self, path: FloatArray, position: FloatArray) -> FloatArray:
        """Return the rest of ``path`` (M, 3) from the pose that is nearest to ``position`` (2,)."""
        if path is not self._path:
            self._path, self._place = path, nearest_pose(path, 0, math.inf, *position.tolist())
        else:
            self._place = nearest_pose(path, self._place, SEARCH, *position.tolist())
        return path[self._place :]


@borrowing
def nearest_pose(path: FloatArray, place: int, search: float, x: float, y: float) -> int:
    """Return the pose of ``path`` (M, 3) that is nearest to (x, y), among those up to ``search`` m along it
    from number ``place`` on.
    """
    best, nearest, along = math.inf, place, 0.0
    for i in range(place, len(path)):
        dx, dy = path[i, X] - x, path[i, Y] - y
        if dx * dx + dy * dy < best:
            best, nearest = dx * dx + dy * dy, i
        if along >= search or i + 1 == len(path):
            break
        along += math.hypot(path[i + 1, X] - path[i, X], path[i + 1, Y] - path[i, Y])
    return nearest


def local_reference(
    rest: FloatArray, look_ahead: float, via_separation: float | None, window: CostmapWindow
) -> Reference:
    """Cut the rest of a path (M, 3) at ``look_ahead`` m or where it leaves the window; headings become those of its
    pieces.

    Every ``via_separation`` m of it is a via point; None: there are none.
    """
    path, along = cut_path(rest, look_ahead, window)
    return Reference(path, len(path) == len(rest), _via_points(path, along, via_separation))


@compiled
def cut_path(rest: FloatArray, look_ahead: float, window: CostmapWindow) -> tuple[FloatArray, FloatArray]:
    """Return the poses (N, 3), at least one, of the first ``look_ahead`` m that lie within the window, and
    how far along each is, m.
    """
    along, count = np.zeros(len(rest)), 0
    while count < len(rest):
        if count > 0:
            along[count] = along[count - 1] + math.hypot(
                rest[count, X] - rest[count - 1, X], rest[count, Y] - rest[count - 1, Y]
            )
        if not (along[count] < look_ahead + 1e-9 and is_within(window, rest[count, X], rest[count, Y])):
            break
        count += 1
    path = rest[: max(count, 1)].copy()
    for i in range(len(path) - 1):
        path[i, THETA] = math.atan2(path[i + 1, Y] - path[i, Y], path[i + 1, X] - path[i, X])
    if len(path) > 1:
        path[-1, THETA] = path[-2, THETA]
    return path, along[: len(path)].copy()


def _via_points(path: FloatArray, along: FloatArray, separation: float | None) -> FloatArray:
    """Return the poses that come next after each ``separation`` m of the path, (V, 2), its ends left out."""
    if separation is None:
        return np.empty((0, 2))
    places = np.searchsorted(along, np.arange(separation, along[-1], separation))
    return path[places[places < len(path) - 1], :2]


def cut_where_blocked(reference: Reference, window: CostmapWindow, radius: float) -> Reference:
    """Cut a reference before the first pose at which a disc of ``radius`` m would touch something."""
    count = free_poses(window, reference.path, radius)
    return (
        reference
        if count == len(reference.path)
        else reference._replace(path=reference.path[: max(count, 1)], final=False)
    )


@borrowing
def free_poses(window: CostmapWindow, path: FloatArray, radius: float) -> int:
    """Return how many poses of ``path`` (M, 3) come before the first, other than the robot's, with less
    than ``radius`` m of room.
    """
    for i in range(1, len(path)):
        if distance_at(window, path[i, X], path[i, Y]) < radius:
            return i
    return len(path)


@inner
def is_within(window: CostmapWindow, x: float, y: float) -> bool:
    """Return whether a position lies inside the window, ``BORDER`` m from its sides."""
    rows, columns = window.costs.shape
    u, v = x - window.origin_x, y - window.origin_y
    return bool(
        BORDER <= u <= columns * window.resolution - BORDER and BORDER <= v <= rows * window.resolution - BORDER
    )


@compiled
def nearest_path_points(path: FloatArray, positions: FloatArray) -> FloatArray:
    """Return (N, 5) for each of ``positions`` (N, 2): the nearest point of ``path`` (M, 3), its normal
    there and its heading, rad.
    """
    found = np.zeros((len(positions), 5))
    for k in range(len(positions)):
        x, y = positions[k, X], positions[k, Y]
        best = math.inf
        found[k, REFERENCE_X], found[k, REFERENCE_Y], found[k, HEADING] = path[0, X], path[0, Y], path[0, THETA]
        for i in range(len(path) - 1):
            ax, ay = path[i, X], path[i, Y]
            dx, dy = path[i + 1, X] - ax, path[i + 1, Y] - ay
            length = dx * dx + dy * dy
            if length < 1e-12:
                continue
            share = min(max(((x - ax) * dx + (y - ay) * dy) / length, 0.0), 1.0)
            px, py = ax + share * dx, ay + share * dy
            away = (x - px) ** 2 + (y - py) ** 2
            if away < best:
                best = away
                found[k, REFERENCE_X], found[k, REFERENCE_Y] = px, py
                found[k, HEADING] = math.atan2(dy, dx)
                found[k, NORMAL_X], found[k, NORMAL_Y] = -math.sin(found[k, HEADING]), math.cos(found[k, HEADING])
    return found


@compiled
def nearest_stages(via_points: FloatArray, positions: FloatArray) -> FloatArray:
    """Return (N + 1, 3) x, y and 1 for each stage that is the nearest to a via point, zeros for all others;
    the first one is the robot.
    """
    rows = np.zeros((len(positions), 3))
    for v in range(len(via_points)):
        best, nearest = math.inf, 0
        for k in range(1, len(positions)):
            away = (positions[k, X] - via_points[v, X]) ** 2 + (positions[k, Y] - via_points[v, Y]) ** 2
            if away < best:
                best, nearest = away, k
        if nearest > 0:
            rows[nearest, 0], rows[nearest, 1], rows[nearest, 2] = via_points[v, X], via_points[v, Y], 1.0
    return rows
