"""Turning on the spot towards a path that lies behind: seen 1.5 s ahead from rest, no rotation
looks worth its beginning.
"""

from __future__ import annotations

import math

import numpy as np

from arena_core import Pose, wrap_angle
from arena_dwa.columns import HIGH, LOW, WZ, X, Y
from arena_dwa.parameters import TurnParameters
from arena_dwa.settings import FloatArray
from arena_kernels.compiled import borrowing
from arena_kernels.paths import nearest_index


class TurnInPlace:
    """Narrows the dynamic window to a turn towards the path from one bearing on until another, as Nav2's rotation shim
    does.

    Only a ``differential`` robot does: others have better ways to drive to what lies behind.
    """

    def __init__(self, bearings: TurnParameters, alpha_max: float, *, differential: bool) -> None:
        self._behind = math.inf if bearings.begin is None else bearings.begin
        self._begin = bearings.begin if differential else None
        self._end = bearings.end
        self._ahead = bearings.ahead
        self._alpha_max = alpha_max
        self._turning = False

    def clear(self) -> None:
        """Begin without a turn."""
        self._turning = False

    def is_behind(self, pose: Pose, path: FloatArray) -> bool:
        """Return whether ``path`` (M, 3) lies so far behind that a robot turns first, on the spot if it can."""
        return abs(path_bearing(pose, path, self._ahead)) > self._behind

    def turn_window(self, velocities: FloatArray, pose: Pose, wz: float, path: FloatArray) -> FloatArray | None:
        """Return the window (3, 2) that only turns towards ``path`` (M, 3), None when the robot faces it well enough.

        The turn goes the shorter way from where the robot, turning with ``wz`` now, could face at the earliest; it is
        as fast as the window and braking at the path's bearing allow. Whatever else moves is braked.
        """
        if self._begin is None:
            return None
        bearing = path_bearing(pose, path, self._ahead)
        self._turning = abs(bearing) > (self._end if self._turning else self._begin)
        if not self._turning:
            return None
        left = float(wrap_angle(bearing - wz * abs(wz) / (2.0 * self._alpha_max)))
        rest = np.clip(np.zeros(3), velocities[:, LOW], velocities[:, HIGH])
        # half of what braking at alpha_max allows
        stoppable = math.copysign(math.sqrt(self._alpha_max * abs(bearing)), left)
        rest[WZ] = min(max(stoppable, velocities[WZ, LOW]), velocities[WZ, HIGH])
        return np.stack((rest, rest), axis=1)


def path_bearing(pose: Pose, path: FloatArray, ahead: float) -> float:
    """Return the bearing, rad, of the point of a path that lies ``ahead`` m beyond the one nearest to ``pose``."""
    x, y, _ = path[_index_ahead(path, pose.x, pose.y, ahead)].tolist()
    target = pose.relative(Pose(x, y))
    return math.atan2(target.y, target.x)


@borrowing
def _index_ahead(path: FloatArray, x: float, y: float, ahead: float) -> int:
    place, way = nearest_index(path, x, y), 0.0
    while place + 1 < len(path) and way < ahead:
        place += 1
        way += math.hypot(path[place, X] - path[place - 1, X], path[place, Y] - path[place - 1, Y])
    return place
