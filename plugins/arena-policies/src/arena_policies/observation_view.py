"""What one planner sees as a batch of one, made at every control step: in fewer arrays than the core makes it of."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from arena_core import EarlierScans, Observation, ObservationBatch, PathBatch, Twist


def batch_of_one(
    observation: Observation,
    last_command: Twist,
    earlier: EarlierScans,
    recalled: NDArray[np.float32],
    *,
    tracked: bool = False,
) -> ObservationBatch:
    """Return what ``ObservationBatch.of`` does."""
    pose, twist, goal, waypoint = observation.pose, observation.twist, observation.goal, observation.waypoint
    poses, twists, goals, waypoints, last = np.array(
        (
            ((pose.x, pose.y, pose.theta),),
            ((twist.vx, twist.vy, twist.wz),),
            ((goal.x, goal.y, goal.theta),),
            ((waypoint.x, waypoint.y, waypoint.theta),),
            ((last_command.vx, last_command.vy, last_command.wz),),
        )
    )
    path = np.array(observation.path.poses, np.float64)
    return ObservationBatch(
        stamps=np.array((observation.stamp,)),
        ranges=np.ascontiguousarray(observation.scan.ranges, np.float32)[None],
        poses=poses,
        twists=twists,
        goals=goals,
        waypoints=waypoints,
        last_commands=last,
        paths=PathBatch(path, np.array((0, len(path)))),
        earlier=earlier,
        maps=(observation.map,),
        recalled=recalled,
        depths=None if observation.depth is None else observation.depth.depths[None],
        tracks=(observation.tracks,) if tracked else (),
        predictions=(observation.predictions,) if tracked else (),
    )
