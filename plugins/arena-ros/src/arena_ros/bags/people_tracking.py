"""People whom no topic tells of: our tracker over the scans, each seen from where the robot stood when it was made."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator
from dataclasses import replace

from arena_core import LaserScan, OccupancyGrid, Pose, Tracker

MOST_WAITING = 50  # scans for which no pose has come yet; what is older is given up
Person = tuple[float, float, float, float, float, float]  # number, x, y, z, vx, vy


class PeopleTracker:
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

    def detect_people(
        self, begin: int, stood: Callable[[int], tuple[str, Pose] | None]
    ) -> Iterator[tuple[str, int, list[Person]]]:
        """Yield who is seen in the scans that wait, as far as it is known where the
        robot stood: frame, stamp and people.
        """
        while self._waiting and (place := stood(self._waiting[0][0])) is not None:
            frame, pose = place
            stamp, scan = self._waiting.popleft()
            seconds = (stamp - begin) * 1e-9
            tracks = self._tracker.update(replace(scan, stamp=seconds), pose, seconds)
            states = zip(tracks.ids.tolist(), tracks.positions.tolist(), tracks.velocities.tolist(), strict=True)
            yield frame, stamp, [(float(number), x, y, 0.0, vx, vy) for number, (x, y), (vx, vy) in states]
