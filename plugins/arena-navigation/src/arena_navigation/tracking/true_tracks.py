"""The tracker that errs in nothing: the true people around the robot, for what perception costs."""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from arena_core import LaserScan, OccupancyGrid, Pedestrians, Pose, Robot, Tracker, Tracks
from arena_core.hosting import Truth, pose_at_scan
from arena_core.parameters import Positive
from arena_navigation.columns import X, Y


class GroundTruthTracker(Tracker):
    """Tell of every person whose body is within ``range`` m of the lidar, and within the lidar's own range.

    People are told of as they stand to the robot: an error of the pose estimate shifts them as it shifts what a scan
    shows. Unless ``hidden``, people of whom no beam would hit anything are left out.
    """

    privileged: ClassVar[bool] = True

    def __init__(self, robot: Robot, range: Positive, hidden: bool) -> None:
        self._range = min(range, robot.lidar.range_max)
        self._hidden = hidden
        self._truth: Truth | None = None

    def see(self, truth: Truth) -> None:
        """Take the truth of the episode that begins."""
        self._truth = truth

    def reset(self, grid: OccupancyGrid | None) -> None:
        """Begin an episode; the truth needs no memory."""

    def update(self, scan: LaserScan, pose: Pose, stamp: float) -> Tracks:
        """Return the people who are near now, seen from ``pose`` (base_link in ``map`` at the scan's stamp)."""
        assert self._truth is not None, "a navigator shows the truth ahead of every reset"
        state = self._truth.state()
        at_scan = pose_at_scan(state.pose, state.twist, stamp - scan.stamp)
        people = state.pedestrians
        near = self._near_ones(people, state.pose.compose(scan.mount), scan)
        turn = pose.theta - at_scan.theta
        c, s = np.cos(turn), np.sin(turn)
        turned = np.array(((c, -s), (s, c)))
        offsets = people.positions[near] - (at_scan.x, at_scan.y)
        return Tracks(
            people.ids[near].copy(),
            offsets @ turned.T + (pose.x, pose.y),
            people.velocities[near] @ turned.T,
            people.radii[near].copy(),
            np.zeros((len(near), 4, 4)),
        )

    def _near_ones(self, people: Pedestrians, lidar: Pose, scan: LaserScan) -> NDArray[np.int64]:
        """Return the rows of those within range, whom the scan shows unless the ``hidden`` count."""
        offsets = people.positions - (lidar.x, lidar.y)
        away = np.hypot(offsets[:, X], offsets[:, Y])
        near = np.flatnonzero(away - people.radii <= self._range)  # who is absent is at NaN
        if self._hidden:
            return near
        bearings = np.arctan2(offsets[:, Y], offsets[:, X]) - lidar.theta
        return np.array([i for i in near if _is_shown(scan, away[i], bearings[i], people.radii[i])], np.int64)


def _is_shown(scan: LaserScan, away: float, bearing: float, radius: float) -> bool:
    """Return whether a beam ends on a body, or as near to its centre as its surface is."""
    angles = scan.angle_min + scan.angle_increment * np.arange(len(scan.ranges))
    off = np.abs((angles - bearing + np.pi) % (2.0 * np.pi) - np.pi)
    towards = off <= np.arcsin(min(radius / max(away, radius), 1.0))
    return bool((np.abs(scan.ranges[towards] - away) <= 1.5 * radius).any())
