"""The moving-obstacle tracker: people and other bodies that the map does not show, each followed by a Kalman filter."""

from __future__ import annotations

from dataclasses import astuple, dataclass

import numpy as np

from arena_core import NO_TRACKS, ConfigurationError, LaserScan, OccupancyGrid, Pose, Robot, Tracker, Tracks
from arena_core.parameters import NonNegative, Positive, PositiveInt
from arena_kernels.compiled import TypedDispatch
from arena_navigation.columns import VX
from arena_navigation.local_map.marks import PlacedScan
from arena_navigation.tracking.alignment import Alignment
from arena_navigation.tracking.belief import Belief, LifeSpan, PublishedTracks, write_published
from arena_navigation.tracking.clusters import Cut
from arena_navigation.tracking.discs import BodyRules, PoseNoise, Shape
from arena_navigation.tracking.legs import Legs
from arena_navigation.tracking.returns import ReturnTolerance
from arena_navigation.tracking.scan_memory import ScanMemory
from arena_navigation.tracking.step import TrackerParameters, process_scan


@dataclass(frozen=True, slots=True)
class ReturnRules:
    """Which returns are looked at: up to ``range`` m, farther than the tolerances from the map's walls (m, rad)."""

    range: Positive
    map_tolerance: NonNegative
    heading_tolerance: NonNegative


@dataclass(frozen=True, slots=True)
class Memory:
    """Past scans that tell where nothing stood: ``scans`` of them, ``interval`` s apart.

    They saw through what lies ``margin`` m before their returns; what they saw within ``same`` m ``standing`` s ago
    stands.
    """

    scans: PositiveInt
    interval: Positive
    margin: Positive
    same: Positive
    standing: Positive


@dataclass(frozen=True, slots=True)
class AlignRules:
    """How the new scan is laid on a past one, see ``tracking_alignment.Alignment``."""

    position: Positive
    heading: Positive
    baseline: Positive
    outlier: Positive
    points: PositiveInt


@dataclass(frozen=True, slots=True)
class CutRules:
    """Where one body ends and another begins, see ``tracking_clusters.Cut``."""

    gap: Positive
    gap_beams: NonNegative
    dent: Positive
    least: PositiveInt


@dataclass(frozen=True, slots=True)
class BodyShape:
    """What bodies look like, see ``tracking_discs.Shape``; m."""

    radius: Positive
    radius_std: Positive
    radius_min: Positive
    radius_max: Positive
    noise: Positive
    misfit: Positive


@dataclass(frozen=True, slots=True)
class LegRules:
    """Which pieces are legs and whose, see ``tracking_legs.Legs``; ``apart`` None: bodies are discs."""

    width: Positive
    apart: Positive | None


@dataclass(frozen=True, slots=True)
class MotionRules:
    """How bodies move: the density of their acceleration, m^2/s^3; how fast they may be when
    first seen and when they stand, m/s.
    """

    acceleration_density: Positive
    speed_std: Positive
    standing_std: Positive


@dataclass(frozen=True, slots=True)
class Life:
    """When a track is believed and when it ends.

    It is told of from the ``confirm_hits``-th hit on. It ends after ``misses`` scans in a row that see through it (the
    first one does before it is told of), after ``hidden_for`` s out of sight or as long as it was in sight, or when its
    position is uncertain by more than ``position_std`` m.
    """

    confirm_hits: PositiveInt
    misses: PositiveInt
    hidden_for: Positive
    position_std: Positive


class KalmanTracker(Tracker):
    """Follows what the map does not explain, as discs that keep their velocity (docs/tracker.md)."""

    def __init__(
        self,
        robot: Robot,
        returns: ReturnRules,
        memory: Memory,
        align: AlignRules,
        cut: CutRules,
        shape: BodyShape,
        legs: LegRules,
        position_doubt: NonNegative,
        heading_doubt: NonNegative,
        gate: Positive,
        motion: MotionRules,
        life: Life,
    ) -> None:
        if not shape.radius_min <= shape.radius <= shape.radius_max:
            raise ConfigurationError(
                f"kalman: shape.radius is {shape.radius}; allowed: from radius_min {shape.radius_min} to "
                f"radius_max {shape.radius_max}"
            )
        rules = BodyRules(
            farthest=returns.range,
            body=robot.footprint.inscribed_radius,
            doubt=ReturnTolerance(
                returns.map_tolerance, memory.margin, returns.heading_tolerance, memory.same, memory.standing
            ),
            cut=Cut(*astuple(cut)),
            shape=Shape(*astuple(shape)),
            pose_doubt=PoseNoise(position_doubt, heading_doubt),
            legs=Legs(legs.width, legs.apart or 0.0),
        )
        alignment = Alignment(align.position, align.heading, shape.noise, align.baseline, align.outlier, align.points)
        lasts = life.confirm_hits, life.misses, life.hidden_for, life.position_std**2
        self._figures = TrackerParameters(
            rules,
            alignment,
            gate,
            motion.acceleration_density,
            motion.standing_std**2,
            LifeSpan(*lasts, motion.speed_std, motion.standing_std),
        )
        self._keeper = ScanMemory(memory.scans, memory.interval, cut.least)
        self._belief = Belief.room(0)
        self._take_in, self._write_told = TypedDispatch(process_scan), TypedDispatch(write_published)
        self.reset(None)

    def reset(self, grid: OccupancyGrid | None) -> None:
        """Begin an episode without tracks."""
        self._keeper.reset(grid)
        self._belief.numbers[:] = 0
        self._told = 0
        self._stamp = -np.inf

    def update(self, scan: LaserScan, pose: Pose, stamp: float) -> Tracks:
        """Take in the scan, seen from ``pose`` (base_link in ``map`` at the scan's stamp), if it is new;
        return the tracks at ``stamp``.
        """
        if scan.stamp > self._stamp:
            beams = PlacedScan.of(scan, pose)
            self._belief, workings = self._keeper.room(len(beams.ranges), self._belief)
            lapse = beams.stamp - self._stamp
            self._told = int(self._take_in(beams, lapse, self._keeper.known, self._belief, self._figures, workings))
            self._keeper.remember(beams)
            self._stamp = beams.stamp
        return self._published_tracks(stamp)

    def _published_tracks(self, stamp: float) -> Tracks:
        """Return the tracks that are believed, moved to ``stamp``."""
        if not self._told:
            return NO_TRACKS
        told = PublishedTracks.room(self._told)
        figures = self._figures
        self._write_told(
            self._belief, figures.life.confirm_hits, max(stamp - self._stamp, 0.0), figures.acceleration_density, told
        )
        return Tracks(told.ids, told.states[:, :VX].copy(), told.states[:, VX:].copy(), told.radii, told.covariances)
