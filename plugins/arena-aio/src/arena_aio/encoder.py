"""The observation of AIO's switch: what stands and what moves around the robot, goal, waypoint and speed."""

from __future__ import annotations

import numpy as np

from arena_aio.pooled_returns import MappedWalls, pool_returns
from arena_core import ObservationBatch, ObservationField, Robot
from arena_core.parameters import NonNegative, Positive, PositiveInt
from arena_policies.encoding import (
    BoundedEncoder,
    Numbers,
    closeness_field,
    sector_order,
    speed_scales,
    write_bearing,
    write_closeness,
    write_speeds,
)
from arena_policies.scan_history import beams_of


class AioEncoder(BoundedEncoder):
    """Two scans pooled into sectors, of what the map has and of what it has not, and the robot's state (Kaestner et al.
    2021).

    Targets come as distance, over ``goal_unit`` or ``waypoint_unit``, and as cosine and sine of their bearing.
    """

    def __init__(
        self,
        robot: Robot,
        sectors: PositiveInt,
        range_max: Positive,
        map_tolerance: NonNegative,
        decay: Positive,
        goal_unit: Positive,
        waypoint_unit: Positive,
    ) -> None:
        lidar = robot.lidar
        self._sectors = min(sectors, lidar.beams)
        self._order = sector_order(self._sectors, 0, lidar)
        self._beams, self._tolerance = beams_of(lidar), map_tolerance
        self._range_max = min(range_max, lidar.range_max)
        self._radius, self._decay = robot.footprint.radius, decay
        self._units = goal_unit, waypoint_unit
        self._speeds = speed_scales(robot)
        names = ("vx", "vy", "wz") if robot.holonomic else ("vx", "wz")
        kinds = (("scan", ", of what is on the map"), ("scan_dynamic", ", of what is not on the map"))
        super().__init__(
            (
                *(closeness_field(name, len(self._order), self._range_max, robot, decay, kind) for name, kind in kinds),
                *_target_fields("goal", goal_unit),
                *_target_fields("waypoint", waypoint_unit),
                *(ObservationField(n, 1, "-", -1.5, 1.5, "measured, over the robot's greatest") for n in names),
            )
        )

    def write(self, observations: ObservationBatch, rows: Numbers) -> None:
        """Fill ``rows`` (N, D)."""
        nearest = np.empty((len(rows), 2, self._sectors))
        for k, grid in enumerate(observations.maps):
            walls = MappedWalls.of(grid)
            pool_returns(
                observations.ranges[k],
                observations.poses[k],
                self._beams,
                walls,
                self._tolerance,
                self._range_max,
                nearest[k],
            )
        write_closeness(nearest, self._order, self._range_max, self._radius, self._decay, rows)
        state = 2 * len(self._order)
        for targets, unit in zip((observations.goals, observations.waypoints), self._units, strict=True):
            write_bearing(targets, observations.poses, unit, state, rows)
            state += 3
        write_speeds(observations.twists, self._speeds, state, rows)


def _target_fields(name: str, unit: float) -> tuple[ObservationField, ...]:
    return (
        ObservationField(f"{name}_distance", 1, "-", 0.0, 4.0, f"over {unit:g} m"),
        ObservationField(f"{name}_cos", 1, "-", -1.0, 1.0, f"cosine of the {name}'s bearing"),
        ObservationField(f"{name}_sin", 1, "-", -1.0, 1.0, f"sine of the {name}'s bearing"),
    )
