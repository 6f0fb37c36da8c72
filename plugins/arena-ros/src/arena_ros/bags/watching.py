"""People whom no topic tells of: our tracker over the scans, each seen from where the robot stood when it was made."""

from __future__ import annotations

from collections import deque
from dataclasses import replace
from typing import Protocol

from arena_core import LaserScan, OccupancyGrid, Pose, Tracker
from arena_ros.bags.series import People, Series

MOST_WAITING = 50  # scans for which no pose has come yet; what is older is given up


class Journey(Protocol):
    """What is known so far of where the robot was; stamps in ns."""

    begin: int
    reference: Series
    odometry: Series
    correction: Series
    estimate: Series
    people: People


class Watcher:
    """Runs a tracker over an episode. ``grid`` is the site's map where it is known, else the recording's own counts."""

    def __init__(self, tracker: Tracker, grid: OccupancyGrid | None) -> None:
        self._tracker, self._grid = tracker, grid
        self._waiting: deque[tuple[int, LaserScan]] = deque(maxlen=MOST_WAITING)

    def begin(self, recorded: OccupancyGrid | None) -> None:
        """Begin an episode without tracks."""
        self._waiting.clear()
        self._tracker.reset(self._grid if self._grid is not None else recorded)

    def take(self, stamp: int, scan: LaserScan) -> None:
        """Take in a scan, which waits until it is known where the robot stood."""
        self._waiting.append((stamp, scan))

    def look(self, journey: Journey) -> None:
        """Put down who is seen in the scans that wait, as far as poses have come."""
        while self._waiting and (pose := _pose_at(self._waiting[0][0], journey)) is not None:
            stamp, scan = self._waiting.popleft()
            seconds = (stamp - journey.begin) * 1e-9
            tracks = self._tracker.update(replace(scan, stamp=seconds), pose, seconds)
            states = zip(tracks.ids.tolist(), tracks.positions.tolist(), tracks.velocities.tolist(), strict=True)
            journey.people.add(stamp, [(number, *position, *velocity) for number, position, velocity in states])


def _pose_at(stamp: int, journey: Journey) -> Pose | None:
    """Return the pose in ``map``, in that of odometry where nothing says where it is in ``map``; None where it has not come yet."""
    for series in (journey.reference, journey.odometry, journey.estimate):
        if len(series):
            pose = series.at(stamp)
            break
    else:
        return None
    if pose is None:
        return None
    if series is journey.odometry and (correction := journey.correction.newest(stamp)) is not None:
        return Pose.of(correction).compose(Pose.of(pose))
    return Pose.of(pose)
