"""What the tracker remembers from scan to scan but for the tracks, and the room to work in."""

from __future__ import annotations

import math

from arena_core import OccupancyGrid
from arena_navigation.local_map.marks import PlacedScan
from arena_navigation.tracking.belief import COUNT, Belief
from arena_navigation.tracking.returns import KnownPlane, PastScans
from arena_navigation.tracking.step import Known, TrackingScratch


class ScanMemory:
    """Keeps the map and ``scans`` past scans, one every ``interval`` s, and scratch space; bodies show
    ``least`` returns or more.
    """

    def __init__(self, scans: int, interval: float, least: int) -> None:
        self._scans = scans
        self._interval = interval
        self._least = least
        self._workings = TrackingScratch.room(0, 0, 0)
        self._plane = KnownPlane.of(None)
        self._forget_scans(0)

    def reset(self, grid: OccupancyGrid | None) -> None:
        """Begin an episode: forget all scans."""
        self._plane = KnownPlane.of(grid)
        self._forget_scans(self._past.ranges.shape[1])

    def _forget_scans(self, beams: int) -> None:
        self._past = PastScans.none(self._scans, beams)
        self._kept = 0
        self._kept_at = -math.inf

    def room(self, beams: int, belief: Belief) -> tuple[Belief, TrackingScratch]:
        """Return the belief with room for all that so many beams may show, and workings to match; scans of
        other beams are forgotten.
        """
        if beams != self._past.ranges.shape[1]:
            self._forget_scans(beams)
        discs = beams // self._least
        most = int(belief.numbers[COUNT]) + discs
        if most > len(belief.ids):
            belief = belief.with_room(2 * most)
        if not self._workings.fits(beams, len(belief.ids), discs):
            self._workings = TrackingScratch.room(beams, len(belief.ids), discs)
        return belief, self._workings

    @property
    def known(self) -> Known:
        """Return what the next scan is held against."""
        return Known(self._plane, self._past, (self._kept - 1) % self._scans if self._kept else -1)

    def remember(self, beams: PlacedScan) -> None:
        """Keep the scan in place of the oldest one, if the last one kept is old enough."""
        if beams.stamp - self._kept_at >= self._interval - 1e-9:
            slot = self._kept % self._scans
            self._past.ranges[slot] = beams.ranges
            self._past.sensors[slot] = beams.sensor
            self._past.stamps[slot] = beams.stamp
            self._kept, self._kept_at = self._kept + 1, beams.stamp
