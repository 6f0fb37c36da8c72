"""From scans to bodies: keeps the map, a few past scans and the scratch space."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from arena_core import OccupancyGrid
from arena_navigation.local_map.marks import Beams
from arena_navigation.tracking.alignment import Alignment, carry, slip
from arena_navigation.tracking.belief import Belief
from arena_navigation.tracking.discs import Discs, Rules, Scratch, find_discs
from arena_navigation.tracking.returns import KnownPlane, PastScans


class Detector:
    """Finds the bodies of a scan that neither the map nor what was seen before explains.

    ``scans`` of the past are kept, one every ``interval`` s.
    """

    def __init__(self, rules: Rules, alignment: Alignment, scans: int, interval: float) -> None:
        self._rules = rules
        self._alignment = alignment
        self._scans = scans
        self._interval = interval
        self.reset(None)

    def reset(self, grid: OccupancyGrid | None) -> None:
        """Begin an episode: forget all scans."""
        self._plane = KnownPlane.of(grid)
        self._make_room(0)

    def align(self, beams: Beams, belief: Belief) -> None:
        """Move all that is remembered, ``belief`` with it, by how far the pose estimate has slipped since the last scan that was kept."""
        if self._kept and len(beams.ranges) == self._past.ranges.shape[1]:
            newest = (self._kept - 1) % self._scans
            slip(beams, self._plane, self._past, newest, self._bodies(belief), self._alignment, self._ends, self._slip)
            carry(beams, self._slip, belief.states, belief.covariances, self._past.sensors)

    def discs(self, beams: Beams, belief: Belief) -> Discs:
        """Return the bodies that this scan shows, valid until the next one, and remember it; returns on a track count anywhere."""
        if len(beams.ranges) != self._past.ranges.shape[1]:
            self._make_room(len(beams.ranges))
        count = find_discs(beams, self._plane, self._past, self._bodies(belief), self._rules, self._scratch)
        self._remember(beams)
        return self._scratch.discs.first(int(count))

    def _bodies(self, belief: Belief) -> NDArray[np.float64]:
        return np.column_stack((belief.states[:, :2], belief.radii + self._rules.doubt.past))

    def _make_room(self, beams: int) -> None:
        self._past, self._kept, self._kept_at = PastScans.none(self._scans, beams), 0, -np.inf
        self._scratch, self._ends, self._slip = Scratch.room(beams), np.zeros((beams, 2)), np.zeros(3)

    def _remember(self, beams: Beams) -> None:
        """Keep the scan in place of the oldest one, if the last one kept is old enough."""
        if beams.stamp - self._kept_at >= self._interval - 1e-9:
            slot = self._kept % self._scans
            self._past.ranges[slot] = beams.ranges
            self._past.sensors[slot] = beams.sensor
            self._past.stamps[slot] = beams.stamp
            self._kept, self._kept_at = self._kept + 1, beams.stamp
