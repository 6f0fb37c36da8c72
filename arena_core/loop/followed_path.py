"""The path that a robot follows, with what is asked of it at every control step."""

from __future__ import annotations

import numpy as np

from arena_core.base.frozen import freeze_array
from arena_core.contracts.navigation import PathBatch, Window
from arena_core.values.geometry import FloatArray, Pose
from arena_core.values.world import Path


class FollowedPath:
    """A path that no one can change; ``shown`` is the planner's own, ``batch`` what waypoint generators take."""

    def __init__(self, path: Path) -> None:
        self.path = Path(freeze_array(path.poses))
        self.shown = Path(self.path.poses)
        self.batch = PathBatch.of([self.path])
        self._x, self._y, _ = np.ascontiguousarray(self.path.poses.T)

    def rest(self, pose: Pose) -> Path:
        """Return the path from the robot on: its own pose, then those behind the nearest one."""
        poses = self.path.poses
        return Path(np.vstack((pose.array(), poses[min(self._nearest_index(pose) + 1, len(poses) - 1) :])))

    def ahead(self, pose: Pose, distance: float) -> FloatArray:
        """Return the first position (1, 2) of the rest that is so far from the robot, m, or its end."""
        rest = self.path.poses[self._nearest_index(pose) :, :2]
        far = np.hypot(*(rest - (pose.x, pose.y)).T) >= distance
        return rest[[int(np.argmax(far)) if far.any() else -1]]

    def is_blocked(self, pose: Pose, window: Window) -> bool:
        """Return whether the rest, inside the window, runs through places where the robot would touch something."""
        return window.is_blocked(self._x, self._y, pose)

    def _nearest_index(self, pose: Pose) -> int:
        east, north = self._x - pose.x, self._y - pose.y
        return int((east * east + north * north).argmin())
