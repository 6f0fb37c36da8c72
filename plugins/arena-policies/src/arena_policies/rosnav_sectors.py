"""A shorter observation than ROSNAV's: pooled sectors, the waypoint ahead, speed and last action."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from arena_core import ConfigurationError, Lidar, NonNegativeInt, ObservationBatch, ObservationField, Positive, PositiveInt, Robot
from arena_policies.encoding import BoundedEncoder, Numbers, nearest_in_sectors, speed_scales, ways_to, write_closeness
from arena_policies.looking_back import beams_of, nearest_now


class RosnavSectorsEncoder(BoundedEncoder):
    """The nearest return of each of some sectors, transformed so that what is close counts most, and the robot's state.

    Sectors go counter-clockwise; those of a scan all round begin behind the robot, and the first ``overlap`` of them follow the last
    once more, so that a convolution over them has no seam. Earlier scans, ``lookback`` seconds ago, are shown as they would be seen
    from where the robot is now: what stands still coincides, people do not. The waypoint's direction comes as cosine and sine, which
    have no jump behind the robot.
    """

    def __init__(
        self,
        robot: Robot,
        sectors: PositiveInt,
        overlap: NonNegativeInt,
        lookback: tuple[Positive, ...],
        range_max: Positive,
        decay: Positive,
        distance_unit: Positive,
    ) -> None:
        lidar = robot.lidar
        self.lookback = tuple(_steps(seconds, robot.control_period) for seconds in lookback)
        self._sectors = min(sectors, lidar.beams)
        self._order = _order(self._sectors, overlap, lidar)
        self._beams = beams_of(lidar)
        self._range_max = min(range_max, lidar.range_max)
        self._radius, self._decay, self._distance_unit = robot.footprint.radius, decay, distance_unit
        self._speeds = speed_scales(robot)
        self._axes = [0, 1, 2] if robot.holonomic else [0, 2]
        names = ("vx", "vy", "wz") if robot.holonomic else ("vx", "wz")
        farthest = self._range_max - self._radius
        low = 2.0 * math.exp(-farthest / decay) - farthest / self._range_max
        high = 2.0 * math.exp(self._radius / decay) + self._radius / self._range_max
        closeness = f"2 exp(-gap / {decay:g} m) - gap / {self._range_max:g} m; gap: least range of a sector less {self._radius:.3f} m"
        ago = [f", {seconds:g} s ago, seen from here" for seconds in lookback]
        shown = [("closeness", ""), *((f"closeness_{k}", when) for k, when in enumerate(ago, 1))]
        super().__init__(
            (
                *(ObservationField(name, len(self._order), "-", low, high, closeness + when) for name, when in shown),
                ObservationField("waypoint_distance", 1, "-", 0.0, 4.0, f"over {distance_unit:g} m"),
                ObservationField("waypoint_cos", 1, "-", -1.0, 1.0, "cosine of the waypoint's bearing"),
                ObservationField("waypoint_sin", 1, "-", -1.0, 1.0, "sine of the waypoint's bearing"),
                *(ObservationField(n, 1, "-", -1.5, 1.5, "measured, over the robot's greatest") for n in names),
                *(ObservationField(f"last_{n}", 1, "-", -1.0, 1.0, "last command, over the robot's greatest") for n in names),
            )
        )

    def write(self, observations: ObservationBatch, rows: Numbers) -> None:
        """Fill ``rows`` (N, D)."""
        axes, size = self._axes, len(self._order)
        nearest = np.empty((len(rows), 1 + len(self.lookback), self._sectors))
        nearest_in_sectors(observations.ranges, self._range_max, nearest[:, 0])
        earlier = observations.earlier
        if self.lookback:
            nearest_now(earlier.ranges, earlier.poses, observations.poses, self._beams, self._range_max, nearest[:, 1:])
        state = size * nearest.shape[1]
        write_closeness(nearest, self._order, self._range_max, self._radius, self._decay, rows)
        way = np.empty((len(rows), 4))
        ways_to(observations.waypoints, observations.poses, way)
        rows[:, state] = way[:, 0] / self._distance_unit
        rows[:, state + 1 : state + 3] = way[:, 2:]
        speed = state + 3
        last = speed + len(axes)
        rows[:, speed:last] = observations.twists[:, axes] / self._speeds
        rows[:, last:] = observations.last_commands[:, axes] / self._speeds


def _steps(seconds: float, period: float) -> int:
    steps = round(seconds / period)
    if steps < 1 or abs(steps * period - seconds) > 1e-9:
        raise ConfigurationError(
            f"observation_encoder.lookback has {seconds:g}; allowed: multiples of the robot's control period, {period:g} s"
        )
    return steps


def _order(sectors: int, overlap: int, lidar: Lidar) -> NDArray[np.int64]:
    """Return which sectors are shown, one after the other."""
    shown = np.arange(sectors)
    if (lidar.beams + 0.5) * lidar.angle_increment < 2.0 * math.pi:
        return shown
    behind = round((math.pi - lidar.angle_min) / (2.0 * math.pi) * sectors)
    return (np.arange(sectors + min(overlap, sectors)) + behind) % sectors
