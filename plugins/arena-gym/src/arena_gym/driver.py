"""One robot that members drive: what each would see in a benchmark, made from what its world's environment knows."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

import numpy as np
from numpy.typing import NDArray

from arena_core import (
    Costmap,
    EpisodeStart,
    LaserScan,
    LocalMap,
    NoValidCommand,
    Observation,
    ObservationBatch,
    Path,
    Pose,
    Robot,
    Tracker,
    Tracks,
    Twist,
    random_generator,
)
from arena_core.hosting import BrainPart, Truth
from arena_gym.pool import Problem
from arena_policies.members import Members

CERTAIN = np.zeros((3, 3))


class Driver:
    """Members with the local map and the tracker that a benchmark's navigator would have; the pose is what the
    environment believes.

    Without a tracker of its own it has the tracks that the environment shows to its encoder. ``period`` is the time in
    s between two decisions, the robot's control period where it is None; ``privileged`` parts see the truth.
    """

    def __init__(
        self,
        robot: Robot,
        members: Members,
        local_map: LocalMap,
        tracker: Tracker | None,
        period: float | None = None,
    ) -> None:
        self.privileged: Sequence[BrainPart] = ()
        self._robot, self._members = robot, members
        self._local_map, self._tracker = local_map, tracker
        self._period = robot.control_period if period is None else period

    def begin(self, problem: Problem, truth: Truth) -> None:
        """Begin an episode; privileged parts are shown the ``truth``."""
        for part in self.privileged:
            part.see(truth)
        scenario = problem.scenario
        grid = scenario.world.grid if scenario.world.known else None
        self._local_map.reset(grid)
        if self._tracker is not None:
            self._tracker.reset(grid)
        random = random_generator(scenario.seed, scenario.name, "planner")
        self._members.reset(EpisodeStart(grid, scenario.goal, self._period, random))

    def drive(self, chosen: int, seen: ObservationBatch, row: int) -> NDArray[np.float64]:
        """Return the velocity (3,) that this member wants, the brake where it has none."""
        try:
            return self._members.drive(chosen, self._make_observation(seen, row)).array()
        except NoValidCommand:
            return np.zeros(3)

    def _make_observation(self, seen: ObservationBatch, row: int) -> Observation:
        pose, stamp = Pose.of(seen.poses[row]), float(seen.stamps[row])
        lidar = self._robot.lidar
        limits = lidar.angle_min, lidar.angle_increment, lidar.range_min, lidar.range_max
        scan = LaserScan(stamp, *limits, seen.ranges[row].copy(), lidar.mount)
        paths = seen.paths

        def local_map() -> Costmap:
            return self._local_map.update(scan, pose)

        def tracks() -> Tracks:
            return seen.tracks[row] if self._tracker is None else self._tracker.update(scan, pose, stamp)

        return Observation(
            stamp,
            pose,
            CERTAIN,
            Twist.of(seen.twists[row]),
            scan,
            Pose.of(seen.goals[row]),
            Pose.of(seen.waypoints[row]),
            Path(paths.poses[paths.offsets[row] : paths.offsets[row + 1]]),
            seen.maps[row],
            cache(local_map),
            cache(tracks),
            _predictions=cache(lambda: seen.expected[row]) if self._tracker is None else None,
        )
