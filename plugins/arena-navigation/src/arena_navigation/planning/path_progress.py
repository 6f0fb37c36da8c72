"""How far each robot has come along its path: never backwards, and never by a leap
to where the path passes near itself.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arena_kernels.compiled import compiled
from arena_navigation.columns import LENGTH, SUM_X, SUM_Y, THETA, X, Y

FloatArray = NDArray[np.float64]

_LOOK_AHEAD = 1.0  # m of path that are searched for the nearest pose: more than a robot drives in a control period


class Progress(NamedTuple):
    """One entry a robot: ``place`` (N,) is the index of its pose on the path, ``travelled`` (N,) the way to there, m.

    ``paths`` (N, 3) is the sum of a path's poses' number, x and y, by which a new path is noticed. ``advance`` (N,) is
    the farthest that the robot has come, m, and ``since`` (N,) the stamp of when that was noted, s.
    """

    place: NDArray[np.int64]
    travelled: FloatArray
    paths: FloatArray
    advance: FloatArray
    since: FloatArray

    @staticmethod
    def of(total: int) -> Progress:
        """Make the state of ``total`` robots without paths."""
        return Progress(
            np.zeros(total, np.int64), np.zeros(total), np.full((total, 3), -1.0), np.zeros(total), np.zeros(total)
        )


@compiled
def follow_path(progress: Progress, k: int, path: FloatArray, robot: FloatArray, stamp: float) -> bool:
    """Move robot k's place to the nearest pose not far ahead; return True if the path is a new one."""
    sum_x, sum_y = 0.0, 0.0
    for i in range(len(path)):
        sum_x += path[i, X]
        sum_y += path[i, Y]
    same = (
        progress.paths[k, LENGTH] == len(path)
        and progress.paths[k, SUM_X] == sum_x
        and progress.paths[k, SUM_Y] == sum_y
    )
    if not same:
        progress.paths[k, LENGTH], progress.paths[k, SUM_X], progress.paths[k, SUM_Y] = len(path), sum_x, sum_y
        progress.place[k], progress.travelled[k] = 0, 0.0
        progress.advance[k], progress.since[k] = -math.inf, stamp
    joins_later = not same and distance_to_pose(path, 0, robot) > _LOOK_AHEAD
    _move_to_nearest(progress, k, path, robot, math.inf if joins_later else _LOOK_AHEAD)
    return not same


@compiled
def _move_to_nearest(progress: Progress, k: int, path: FloatArray, robot: FloatArray, look_ahead: float) -> None:
    i = progress.place[k]
    nearest = distance_to_pose(path, i, robot)
    way = 0.0
    start = progress.travelled[k]
    while i + 1 < len(path) and way < look_ahead:
        i += 1
        way += math.hypot(path[i, X] - path[i - 1, X], path[i, Y] - path[i - 1, Y])
        away = distance_to_pose(path, i, robot)
        if away < nearest:
            nearest = away
            progress.place[k], progress.travelled[k] = i, start + way


@compiled
def distance_to_pose(path: FloatArray, i: int, robot: FloatArray) -> float:
    """Return the distance of the robot from pose i, m."""
    return math.hypot(path[i, X] - robot[X], path[i, Y] - robot[Y])


@compiled
def is_on_time(
    progress: Progress, k: int, path: FloatArray, robot: FloatArray, stamp: float, t_lim: float, min_progress: float
) -> bool:
    """Return whether robot k has come ``min_progress`` m farther along its path, or nearer to it, within ``t_lim`` s.

    After False the clock starts again: a path that is kept is not complained about at every step.
    """
    place = progress.place[k]
    dx, dy = robot[X] - path[place, X], robot[Y] - path[place, Y]
    along, beside = _rotate_vector(dx, dy, path[place, THETA])
    advance = progress.travelled[k] + along - abs(beside)
    late = stamp - progress.since[k] >= t_lim - 1e-9
    if advance >= progress.advance[k] + min_progress:
        progress.advance[k], progress.since[k] = advance, stamp
        return True
    if late:
        progress.since[k] = stamp
    return not late


@compiled
def _rotate_vector(x: float, y: float, heading: float) -> tuple[float, float]:
    """Return the components of (x, y) along ``heading`` and to its left."""
    c, s = math.cos(heading), math.sin(heading)
    return c * x + s * y, c * y - s * x
