"""A shorter observation than ROSNAV's: pooled sectors, the waypoint ahead, speed and last action."""

from __future__ import annotations

import math

import numpy as np

from arena_core import ObservationBatch, ObservationField, Positive, PositiveInt, Robot
from arena_policies.encoding import BoundedEncoder, Numbers, speed_scales, ways_to, write_closeness


class RosnavSectorsEncoder(BoundedEncoder):
    """The nearest return of each of some sectors, transformed so that what is close counts most, and the robot's state.

    The waypoint's direction comes as cosine and sine, which have no jump behind the robot.
    """

    def __init__(self, robot: Robot, sectors: PositiveInt, range_max: Positive, decay: Positive, distance_unit: Positive) -> None:
        self._sectors = min(sectors, robot.lidar.beams)
        self._range_max = min(range_max, robot.lidar.range_max)
        self._radius, self._decay, self._distance_unit = robot.footprint.radius, decay, distance_unit
        self._speeds = speed_scales(robot)
        self._axes = [0, 1, 2] if robot.holonomic else [0, 2]
        names = ("vx", "vy", "wz") if robot.holonomic else ("vx", "wz")
        farthest = self._range_max - self._radius
        low = 2.0 * math.exp(-farthest / decay) - farthest / self._range_max
        high = 2.0 * math.exp(self._radius / decay) + self._radius / self._range_max
        closeness = f"2 exp(-gap / {decay:g} m) - gap / {self._range_max:g} m; gap: least range of a sector less {self._radius:.3f} m"
        super().__init__(
            (
                ObservationField("closeness", self._sectors, "-", low, high, closeness),
                ObservationField("waypoint_distance", 1, "-", 0.0, 4.0, f"over {distance_unit:g} m"),
                ObservationField("waypoint_cos", 1, "-", -1.0, 1.0, "cosine of the waypoint's bearing"),
                ObservationField("waypoint_sin", 1, "-", -1.0, 1.0, "sine of the waypoint's bearing"),
                *(ObservationField(n, 1, "-", -1.5, 1.5, "measured, over the robot's greatest") for n in names),
                *(ObservationField(f"last_{n}", 1, "-", -1.0, 1.0, "last command, over the robot's greatest") for n in names),
            )
        )

    def write(self, observations: ObservationBatch, rows: Numbers) -> None:
        """Fill ``rows`` (N, D)."""
        sectors, axes = self._sectors, self._axes
        write_closeness(observations.ranges, self._range_max, self._radius, self._decay, sectors, rows)
        way = np.empty((len(rows), 4))
        ways_to(observations.waypoints, observations.poses, way)
        rows[:, sectors] = way[:, 0] / self._distance_unit
        rows[:, sectors + 1 : sectors + 3] = way[:, 2:]
        speed = sectors + 3
        last = speed + len(axes)
        rows[:, speed:last] = observations.twists[:, axes] / self._speeds
        rows[:, last:] = observations.last_commands[:, axes] / self._speeds
