"""From scans to bodies: keeps the map, a few past scans and the scratch space."""

from __future__ import annotations

import numpy as np

from arena_core import OccupancyGrid
from arena_navigation.marks import Beams
from arena_navigation.tracking_belief import Belief
from arena_navigation.tracking_clusters import Cut, Pieces
from arena_navigation.tracking_discs import Discs, PoseDoubt, Shape, find_discs
from arena_navigation.tracking_returns import Doubt, KnownPlane, PastScans, Returns


class Detector:
    """Finds the bodies of a scan that neither the map nor what was seen before explains."""

    def __init__(
        self,
        farthest: float,
        body: float,
        doubt: Doubt,
        scans: int,
        interval: float,
        cut: Cut,
        shape: Shape,
        pose_doubt: PoseDoubt,
    ) -> None:
        self._farthest = farthest
        self._body = body
        self._doubt = doubt
        self._scans = scans
        self._interval = interval
        self._cut = cut
        self._shape = shape
        self._pose_doubt = pose_doubt
        self.reset(None)

    def reset(self, grid: OccupancyGrid | None) -> None:
        """Begin an episode: forget all scans."""
        self._plane = KnownPlane.of(grid)
        self._make_room(0)

    def discs(self, beams: Beams, belief: Belief) -> Discs:
        """Return the bodies that this scan shows, then remember it; returns on a track count wherever they are."""
        if len(beams.ranges) != len(self._returns.x):
            self._make_room(len(beams.ranges))
        tracks = np.column_stack((belief.states[:, :2], belief.radii + self._doubt.past))
        count = find_discs(
            beams,
            self._plane,
            self._past,
            tracks,
            self._doubt,
            self._farthest,
            self._body,
            self._cut,
            self._shape,
            self._pose_doubt,
            self._returns,
            self._pieces,
            self._discs,
        )
        self._remember(beams)
        return self._discs.first(int(count))

    def _make_room(self, beams: int) -> None:
        self._past = PastScans.none(self._scans, beams)
        self._kept, self._kept_at = 0, -np.inf
        self._returns, self._pieces, self._discs = Returns.room(beams), Pieces.room(beams), Discs.room(beams)

    def _remember(self, beams: Beams) -> None:
        """Keep the scan in place of the oldest one, if the last one kept is old enough."""
        if beams.stamp - self._kept_at >= self._interval - 1e-9:
            slot = self._kept % self._scans
            self._past.ranges[slot] = beams.ranges
            self._past.sensors[slot] = beams.sensor
            self._past.stamps[slot] = beams.stamp
            self._kept, self._kept_at = self._kept + 1, beams.stamp
