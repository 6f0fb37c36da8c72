"""The lidar by MuJoCo's own rays: against every geom, from wherever the robot's body is."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from arena_core import Lidar

if TYPE_CHECKING:
    import mujoco

# of the groups of geoms: not the robot itself, nor the discs of people who have legs
SEEN = np.array((1, 0, 0, 0, 0, 0), np.uint8)


class Rays:
    """A lidar ``height`` m above the floor, on the robot's body."""

    def __init__(self, lidar: Lidar, height: float) -> None:
        angles = lidar.mount.theta + lidar.angles()
        self._directions = np.column_stack((np.cos(angles), np.sin(angles), np.zeros(lidar.beams)))
        self._mount = np.array((lidar.mount.x, lidar.mount.y, height))
        self._range_max = lidar.range_max
        self._geoms, self._distances = np.zeros(lidar.beams, np.int32), np.zeros(lidar.beams)

    def cast_rays(
        self, model: mujoco.MjModel, data: mujoco.MjData, ranges: NDArray[np.float32], body: str = "robot"
    ) -> None:
        """Fill ``ranges`` (B,) of the robot whose ``body`` it is: +inf where a beam meets nothing in range."""
        import mujoco

        mujoco.mj_kinematics(model, data)
        robot = data.body(body)
        turn = robot.xmat.reshape(3, 3)
        origin, beams = robot.xpos + turn @ self._mount, (self._directions @ turn.T).ravel()
        sizes = len(ranges), self._range_max
        mujoco.mj_multiRay(model, data, origin, beams, SEEN, 1, robot.id, self._geoms, self._distances, None, *sizes)
        missed = (self._distances < 0.0) | (self._distances > self._range_max)  # the cut-off is not strict
        ranges[:] = np.where(missed, np.inf, self._distances)
