"""The path that a robot follows, with what is asked of it at every control step."""

from __future__ import annotations

import numpy as np

from arena_core.base.frozen import frozen
from arena_core.contracts.interfaces import PathBatch
from arena_core.values.geometry import FloatArray, Pose
from arena_core.values.world import INSCRIBED, Costmap, Path


class Way:
    """A path that nobody can change; ``shown`` is the planner's own, ``batch`` what waypoint generators take."""

    def __init__(self, path: Path) -> None:
        self.path = Path(frozen(path.poses))
        self.shown = Path(self.path.poses)
        self.batch = PathBatch.of([self.path])
        self._x, self._y, _ = np.ascontiguousarray(self.path.poses.T)

    def rest(self, pose: Pose) -> Path:
        """Return the path from the robot on: its own pose, then those behind the nearest one."""
        poses = self.path.poses
        return Path(np.vstack((pose.array(), poses[min(self._nearest(pose) + 1, len(poses) - 1) :])))

    def ahead(self, pose: Pose, distance: float) -> FloatArray:
        """Return the first position (1, 2) of the rest that is so far from the robot, m, or its end."""
        rest = self.path.poses[self._nearest(pose) :, :2]
        far = np.hypot(*(rest - (pose.x, pose.y)).T) >= distance
        return rest[[int(np.argmax(far)) if far.any() else -1]]

    def is_blocked(self, pose: Pose, local_map: Costmap) -> bool:
        """Tell whether the rest, inside the window, runs through cells where the robot would touch something."""
        first = self._nearest(pose)
        (rows, columns), (left, below) = local_map.costs.shape, local_map.origin_xy.tolist()
        column = ((self._x[first:] - left) / local_map.resolution).astype(np.int64)
        row = ((self._y[first:] - below) / local_map.resolution).astype(np.int64)
        outside = (column.view(np.uint64) >= columns) | (row.view(np.uint64) >= rows)  # what is below 0 counts as very large
        end = int(outside.argmax())
        if end or outside[0]:
            row, column = row[:end], column[:end]
        return bool((local_map.costs[row, column] >= INSCRIBED).any())

    def _nearest(self, pose: Pose) -> int:
        east, north = self._x - pose.x, self._y - pose.y
        return int((east * east + north * north).argmin())
