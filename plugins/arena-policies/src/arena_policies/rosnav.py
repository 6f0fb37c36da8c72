"""The observation of ROSNAV: all beams, the way to the target, and the last action."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np

from arena_core import ObservationBatch, ObservationField, Robot
from arena_core.parameters import Positive
from arena_policies.encoding import BoundedEncoder, Numbers, write_distances_bearings, write_ranges


class RosnavEncoder(BoundedEncoder):
    """All beams, distance and bearing of the target, and the last velocity command (Kaestner et al. 2022;

    AGENT_24 of the release).
    """

    def __init__(
        self,
        robot: Robot,
        target: Literal["waypoint", "goal"],
        range_max: Positive | None,
        distance_max: Positive,
        *,
        scaled: bool,
    ) -> None:
        limits, lidar = robot.limits, robot.lidar
        self._target = target
        self._range_max = min(range_max or lidar.range_max, lidar.range_max)
        reach = max(limits.vx_max, -limits.vx_min), limits.vy_max or 1.0, limits.wz_max
        self._scales = np.array((distance_max, math.pi, *reach)) if scaled else np.ones(5)
        self._range_scale = self._range_max if scaled else 1.0
        bounds = np.array((distance_max, math.pi, *reach)) / self._scales
        distance, bearing, vx, vy, wz = bounds.tolist()
        m, rad, m_s, rad_s = ("-",) * 4 if scaled else ("m", "rad", "m/s", "rad/s")
        over = ", over its greatest value" if scaled else ""
        super().__init__(
            (
                ObservationField(
                    "ranges", lidar.beams, m, 0.0, self._range_max / self._range_scale, f"range of each beam{over}"
                ),
                ObservationField("rho", 1, m, 0.0, distance, f"distance to the {target}{over}"),
                ObservationField("theta", 1, rad, -bearing, bearing, f"bearing of the {target}{over}"),
                ObservationField("last_vx", 1, m_s, -vx, vx, f"last command, forwards{over}"),
                ObservationField("last_vy", 1, m_s, -vy, vy, f"last command, to the left{over}"),
                ObservationField("last_wz", 1, rad_s, -wz, wz, f"last command, counter-clockwise{over}"),
            )
        )

    def write(self, observations: ObservationBatch, rows: Numbers) -> None:
        """Fill ``rows`` (N, B + 5)."""
        beams = rows.shape[1] - 5
        write_ranges(observations.ranges, self._range_max, self._range_scale, beams, rows)
        way = np.empty((len(rows), 4))
        write_distances_bearings(
            observations.waypoints if self._target == "waypoint" else observations.goals, observations.poses, way
        )
        rows[:, beams : beams + 2] = way[:, :2] / self._scales[:2]
        rows[:, beams + 2 :] = observations.last_commands / self._scales[2:]
