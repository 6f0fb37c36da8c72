"""What a planner is shown: values of its own that cannot be written to, so that no planner changes what
others read or what is recorded.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from arena_core.base.frozen import freeze_array
from arena_core.base.once import Once
from arena_core.values.geometry import Pose, Twist
from arena_core.values.predictions import Predictions
from arena_core.values.sensing import DepthImage, LaserScan, Observation, PoseEstimate, Sensors, Tracks
from arena_core.values.world import Costmap, OccupancyGrid, Path


def make_observation(
    sensors: Sensors,
    estimate: PoseEstimate,
    goal: Pose,
    waypoint: Pose,
    path: Path,
    grid: OccupancyGrid | None,
    local_map: Callable[[], Costmap],
    tracks: Callable[[], Tracks],
    predict: Callable[[Observation], Predictions] | None = None,
) -> Observation:
    """Return the observation of one control step; ``path`` is frozen and, as ``grid``, which ``shown_map``
    makes, the planner's own.
    """
    twist = sensors.odometry.twist
    observation = Observation(
        sensors.stamp,
        shown_pose(estimate.pose),
        freeze_array(estimate.covariance),
        Twist(twist.vx, twist.vy, twist.wz),
        _freeze_scan(sensors.scan),
        shown_pose(goal),
        shown_pose(waypoint),
        path,
        grid,
        Once(lambda: _freeze_costmap(local_map())),
        Once(lambda: _freeze_tracks(tracks())),
        None if sensors.depth is None else _freeze_depth(sensors.depth),
        None if predict is None else Once(lambda: predict(observation)),
        sensors.heard,
    )
    return observation


def shown_pose(pose: Pose) -> Pose:
    """Return an equal pose that is another object."""
    return Pose(pose.x, pose.y, pose.theta)


def shown_map(grid: OccupancyGrid) -> OccupancyGrid:
    """Return an equal map that derives again what others have derived from this one; meant for
    ``grid.derive(shown_map)``.
    """
    return OccupancyGrid(grid.data, grid.resolution, shown_pose(grid.origin), grid.occupied_from)


def _freeze_scan(scan: LaserScan) -> LaserScan:
    header = scan.stamp, scan.angle_min, scan.angle_increment, scan.range_min, scan.range_max
    return LaserScan(*header, freeze_array(scan.ranges), shown_pose(scan.mount))


def _freeze_depth(image: DepthImage) -> DepthImage:
    return replace(image, depths=freeze_array(image.depths), mount=shown_pose(image.mount))


def _freeze_costmap(window: Costmap) -> Costmap:
    return Costmap(
        freeze_array(window.costs), freeze_array(window.distance), window.resolution, freeze_array(window.origin_xy)
    )


def _freeze_tracks(tracks: Tracks) -> Tracks:
    places = freeze_array(tracks.positions), freeze_array(tracks.velocities), freeze_array(tracks.radii)
    return Tracks(freeze_array(tracks.ids), *places, freeze_array(tracks.covariances))
