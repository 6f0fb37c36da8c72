"""The observation of GRING: pooled ranges and several waypoints ahead."""

from __future__ import annotations

import numpy as np

from arena_core import ObservationBatch, ObservationField, Positive, PositiveInt, Robot
from arena_kernels.paths import points_ahead
from arena_policies.encoding import BoundedEncoder, Numbers, from_robot, write_ranges


class GringEncoder(BoundedEncoder):
    """Ranges of some sectors and the positions of waypoints ahead on the path, in ``base_link`` (Guldenring et al. 2020)."""

    def __init__(self, robot: Robot, sectors: PositiveInt, range_max: Positive, waypoints: PositiveInt, spacing: Positive) -> None:
        self._sectors = min(sectors, robot.lidar.beams)
        self._range_max = min(range_max, robot.lidar.range_max)
        self._waypoints, self._spacing = waypoints, spacing
        self._reach = waypoints * spacing
        super().__init__(
            (
                ObservationField("ranges", self._sectors, "-", 0.0, 1.0, f"least range of each sector, over {self._range_max:g} m"),
                ObservationField(
                    "waypoints_xy",
                    2 * waypoints,
                    "-",
                    -2.0,
                    2.0,
                    f"x, y in base_link of {waypoints} points, {spacing:g} m of path apart, over {self._reach:g} m",
                ),
            )
        )

    def write(self, observations: ObservationBatch, rows: Numbers) -> None:
        """Fill ``rows`` (N, D)."""
        write_ranges(observations.ranges, self._range_max, self._range_max, self._sectors, rows)
        points = np.empty((len(rows), self._waypoints, 2))
        points_ahead(observations.paths.poses, observations.paths.offsets, observations.poses, self._spacing, points)
        rows[:, self._sectors :] = from_robot(points, observations.poses).reshape(len(rows), -1) / self._reach
