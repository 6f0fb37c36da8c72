"""The observation of GRING: ranges, pooled or whole, now and before, and several waypoints ahead."""

from __future__ import annotations

import numpy as np

from arena_core import ObservationBatch, ObservationField, Robot
from arena_core.parameters import NonNegativeInt, Positive, PositiveInt
from arena_kernels.paths import points_ahead
from arena_policies.encoding import (
    BoundedEncoder,
    Floats,
    Numbers,
    closeness_field,
    nearest_in_scans,
    nearest_in_sectors,
    sector_order,
    speed_scales,
    write_closeness,
    write_robot_points,
    write_speeds,
)
from arena_policies.scan_history import beams_of, lookback_steps, past_sector_ranges


class GringEncoder(BoundedEncoder):
    """Ranges of some sectors, or of all beams, and the positions of waypoints ahead, in ``base_link`` (Guldenring et
    al. 2020).

    Earlier scans are shown as they were then, so that what stands moves as the robot did, or ``aligned``: as they would
    be seen from where the robot is now, so that what stands coincides. With ``decay`` ranges come as closeness and each
    waypoint over its way along the path; without, both come in metres. ``resolution`` rounds both, m. ``speeds`` adds
    the measured ones, as the image variant of the release has them.
    """

    def __init__(
        self,
        robot: Robot,
        sectors: PositiveInt | None,
        overlap: NonNegativeInt,
        lookback: tuple[Positive, ...],
        range_max: Positive | None,
        waypoints: PositiveInt,
        spacing: Positive,
        decay: Positive | None,
        resolution: Positive | None,
        *,
        aligned: bool,
        speeds: bool,
    ) -> None:
        self.lookback = lookback_steps(lookback, robot)
        self._sectors = min(sectors or robot.lidar.beams, robot.lidar.beams)
        self._order = sector_order(self._sectors, overlap, robot.lidar)
        self._beams = beams_of(robot.lidar) if aligned else None
        self._range_max = min(range_max or robot.lidar.range_max, robot.lidar.range_max)
        self._radius, self._decay, self._resolution = robot.footprint.radius, decay, resolution
        self._spacing = spacing
        ways = spacing * np.arange(1.0, waypoints + 1.0)
        self._units = ways if decay else np.ones(waypoints)
        self._shows_speeds = speeds
        self._speeds = speed_scales(robot)
        names = ("vx", "vy", "wz") if robot.holonomic else ("vx", "wz")
        scans = [
            ("", ""),
            *(
                (f"_{k}", f", {seconds:g} s ago" + ", seen from here" * aligned)
                for k, seconds in enumerate(lookback, 1)
            ),
        ]
        super().__init__(
            (
                *(self._scan_field(robot, suffix, when) for suffix, when in scans),
                self._waypoints_field(waypoints),
                *(
                    ObservationField(n, 1, "-", -1.5, 1.5, "measured, over the robot's greatest")
                    for n in names
                    if speeds
                ),
            )
        )

    def write(self, observations: ObservationBatch, rows: Numbers) -> None:
        """Fill ``rows`` (N, D)."""
        nearest = self._sector_ranges(observations)
        seen = nearest.shape[1] * len(self._order)
        if self._decay:
            write_closeness(nearest, self._order, self._range_max, self._radius, self._decay, rows)
        else:
            rows[:, :seen] = nearest[:, :, self._order].reshape(len(rows), seen)
        points = np.empty((len(rows), len(self._units), 2))
        points_ahead(observations.paths.poses, observations.paths.offsets, observations.poses, self._spacing, points)
        write_robot_points(points, observations.poses, self._units, self._resolution or 0.0, seen, rows)
        if self._shows_speeds:
            write_speeds(observations.twists, self._speeds, seen + 2 * len(self._units), rows)

    def _sector_ranges(self, observations: ObservationBatch) -> Floats:
        """Return the least range of each sector (N, C, S), m, of the scan now and of the earlier ones."""
        now, earlier = observations.ranges, observations.earlier
        nearest = np.empty((len(now), 1 + len(self.lookback), self._sectors))
        if self._beams is not None and self.lookback:
            nearest_in_sectors(now, self._range_max, nearest[:, 0])
            past_sector_ranges(
                earlier.ranges, earlier.poses, observations.poses, self._beams, self._range_max, nearest[:, 1:]
            )
        else:
            nearest_in_scans(now, earlier.ranges, self._range_max, nearest)
        return self._round_lengths(nearest)

    def _round_lengths(self, lengths: Floats) -> Floats:
        return lengths if self._resolution is None else np.round(lengths / self._resolution) * self._resolution

    def _scan_field(self, robot: Robot, suffix: str, when: str) -> ObservationField:
        size = len(self._order)
        if self._decay is None:
            what = "least range of each sector" if self._sectors < robot.lidar.beams else "range of each beam"
            return ObservationField(f"ranges{suffix}", size, "m", 0.0, self._range_max, what + when)
        return closeness_field(f"closeness{suffix}", size, self._range_max, robot, self._decay, when)

    def _waypoints_field(self, waypoints: int) -> ObservationField:
        what = f"x, y in base_link of {waypoints} points, {self._spacing:g} m of path apart"
        if self._decay is None:
            reach = 2.0 * waypoints * self._spacing
            return ObservationField("waypoints_xy", 2 * waypoints, "m", -reach, reach, what)
        return ObservationField("waypoints_xy", 2 * waypoints, "-", -4.0, 4.0, f"{what}, each over its way")
