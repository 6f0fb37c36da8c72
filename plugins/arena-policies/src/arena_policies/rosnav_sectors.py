"""A shorter observation than ROSNAV's: pooled sectors, the waypoint ahead, speed and last action."""

from __future__ import annotations

import numpy as np

from arena_core import ObservationBatch, ObservationField, Robot
from arena_core.parameters import NonNegativeInt, Positive, PositiveInt
from arena_kernels.paths import points_ahead
from arena_policies.encoding import (
    BoundedEncoder,
    Numbers,
    closeness_field,
    nearest_in_sectors,
    sector_order,
    speed_scales,
    write_bearing,
    write_closeness,
    write_robot_points,
    write_speeds,
)
from arena_policies.scan_history import beams_of, lookback_steps, past_sector_ranges
from arena_policies.track_prediction import bodies_of, predict_sector_ranges, sectors_of


class RosnavSectorsEncoder(BoundedEncoder):
    """The nearest return of each of some sectors, transformed so that what is close counts most, and the robot's state.

    Sectors go counter-clockwise; those of a scan all round begin behind the robot, and the first ``overlap`` of them
    follow the last once more, so that a convolution over them has no seam. Earlier scans, ``lookback`` seconds ago, are
    shown as they would be seen from where the robot is now: what stands still coincides, people do not. Scans
    ``foreseen`` seconds from now show where the bodies that the robot tracks will be. The waypoint's direction comes as
    cosine and sine, which have no jump behind the robot. ``ahead`` further points of the path, ``spacing`` m of it
    apart, show where it turns.
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
        ahead: NonNegativeInt = 0,  # policies whose cards say nothing of it were trained without
        spacing: Positive = 1.0,
        foreseen: tuple[Positive, ...] = (),
    ) -> None:
        lidar = robot.lidar
        self.lookback = lookback_steps(lookback, robot)
        self._sectors = min(sectors, lidar.beams)
        self.tracked = bool(foreseen)
        self._times, self._pooled = np.array(foreseen), sectors_of(lidar, self._sectors)
        self._order = sector_order(self._sectors, overlap, lidar)
        self._beams = beams_of(lidar)
        self._range_max = min(range_max, lidar.range_max)
        self._radius, self._decay, self._distance_unit = robot.footprint.radius, decay, distance_unit
        self._speeds = speed_scales(robot)
        self._spacing, self._ways = spacing, spacing * np.arange(1.0, ahead + 1.0)
        names = ("vx", "vy", "wz") if robot.holonomic else ("vx", "wz")
        ago = [f", {seconds:g} s ago, seen from here" for seconds in lookback]
        on = [f", in {seconds:g} s, where tracked bodies will be, seen from here" for seconds in foreseen]
        shown = [("closeness", ""), *((f"closeness_{k}", when) for k, when in enumerate([*ago, *on], 1))]
        super().__init__(
            (
                *(closeness_field(name, len(self._order), self._range_max, robot, decay, when) for name, when in shown),
                ObservationField("waypoint_distance", 1, "-", 0.0, 4.0, f"over {distance_unit:g} m"),
                ObservationField("waypoint_cos", 1, "-", -1.0, 1.0, "cosine of the waypoint's bearing"),
                ObservationField("waypoint_sin", 1, "-", -1.0, 1.0, "sine of the waypoint's bearing"),
                *(ObservationField(n, 1, "-", -1.5, 1.5, "measured, over the robot's greatest") for n in names),
                *(
                    ObservationField(f"last_{n}", 1, "-", -1.0, 1.0, "last command, over the robot's greatest")
                    for n in names
                ),
                *(_points_field(ahead, spacing) for _ in range(min(ahead, 1))),
            )
        )

    def write(self, observations: ObservationBatch, rows: Numbers) -> None:
        """Fill ``rows`` (N, D)."""
        size = len(self._order)
        past = 1 + len(self.lookback)
        nearest = np.empty((len(rows), past + len(self._times), self._sectors))
        nearest_in_sectors(observations.ranges, self._range_max, nearest[:, 0])
        earlier = observations.earlier
        if self.lookback:
            past_sector_ranges(
                earlier.ranges, earlier.poses, observations.poses, self._beams, self._range_max, nearest[:, 1:past]
            )
        if self.tracked:
            bodies = bodies_of(observations.tracks, observations.expected, self._times)
            predict_sector_ranges(
                observations.ranges,
                observations.poses,
                bodies,
                self._pooled,
                self._range_max,
                nearest[:, past:],
            )
        state = size * nearest.shape[1]
        write_closeness(nearest, self._order, self._range_max, self._radius, self._decay, rows)
        write_bearing(observations.waypoints, observations.poses, self._distance_unit, state, rows)
        write_speeds(observations.twists, self._speeds, state + 3, rows)
        write_speeds(observations.last_commands, self._speeds, state + 3 + len(self._speeds), rows)
        if len(self._ways):
            points = np.empty((len(rows), len(self._ways), 2))
            points_ahead(
                observations.paths.poses, observations.paths.offsets, observations.poses, self._spacing, points
            )
            write_robot_points(points, observations.poses, self._ways, 0.0, state + 3 + 2 * len(self._speeds), rows)


def _points_field(count: int, spacing: float) -> ObservationField:
    meaning = f"x, y in base_link of {count} points, {spacing:g} m of path apart, each over its way"
    return ObservationField("ahead_xy", 2 * count, "-", -4.0, 4.0, meaning)
