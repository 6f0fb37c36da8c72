"""The moving-obstacle tracker: people and other bodies that the map does not show, each followed by a Kalman filter."""

from __future__ import annotations

from dataclasses import astuple, dataclass

import numpy as np
from numpy.typing import NDArray

from arena_core import (
    ConfigurationError,
    LaserScan,
    NonNegative,
    OccupancyGrid,
    Pose,
    Positive,
    PositiveInt,
    Robot,
    Tracker,
    Tracks,
)
from arena_navigation.local_map.marks import Beams
from arena_navigation.tracking.alignment import Alignment
from arena_navigation.tracking.belief import Belief
from arena_navigation.tracking.clusters import Cut
from arena_navigation.tracking.detector import Detector
from arena_navigation.tracking.discs import Discs, PoseDoubt, Rules, Shape
from arena_navigation.tracking.filter import POSITION, VELOCITY, correct, correct_radii, place_by_radii, predict
from arena_navigation.tracking.legs import Legs
from arena_navigation.tracking.matches import matched
from arena_navigation.tracking.returns import Doubt
from arena_navigation.tracking.sight import GONE, SEEN, judge_sight


@dataclass(frozen=True, slots=True)
class ReturnRules:
    """Which returns are looked at: up to ``range`` m, farther than the tolerances from the map's walls (m, rad)."""

    range: Positive
    map_tolerance: NonNegative
    heading_tolerance: NonNegative


@dataclass(frozen=True, slots=True)
class Memory:
    """Past scans that tell where nothing stood: ``scans`` of them, ``interval`` s apart.

    They saw through what lies ``margin`` m before their returns; what they saw within ``same`` m ``standing`` s ago stands.
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
class Motion:
    """How bodies move: the density of their acceleration, m^2/s^3; how fast they may be when first seen and when they stand, m/s."""

    acceleration_density: Positive
    speed_std: Positive
    standing_std: Positive


@dataclass(frozen=True, slots=True)
class Life:
    """When a track is believed and when it ends.

    It is told of from the ``confirm_hits``-th hit on. It ends after ``misses`` scans in a row that see through it (the first one does
    before it is told of), after ``hidden_for`` s out of sight or as long as it was in sight, or when its position is uncertain by more than
    ``position_std`` m.
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
        motion: Motion,
        life: Life,
    ) -> None:
        if not shape.radius_min <= shape.radius <= shape.radius_max:
            raise ConfigurationError(
                f"kalman: shape.radius is {shape.radius}; allowed: from radius_min {shape.radius_min} to radius_max {shape.radius_max}"
            )
        rules = Rules(
            farthest=returns.range,
            body=robot.footprint.inscribed_radius,
            doubt=Doubt(returns.map_tolerance, memory.margin, returns.heading_tolerance, memory.same, memory.standing),
            cut=Cut(*astuple(cut)),
            shape=Shape(*astuple(shape)),
            pose_doubt=PoseDoubt(position_doubt, heading_doubt),
            legs=Legs(legs.width, legs.apart or 0.0),
        )
        alignment = Alignment(align.position, align.heading, shape.noise, align.baseline, align.outlier, align.points)
        self._detector = Detector(rules, alignment, memory.scans, memory.interval)
        self._returns = returns
        self._margin = memory.margin
        self._gate = gate
        self._noise = shape.noise
        self._motion = motion
        self._life = life
        self.reset(None)

    def reset(self, grid: OccupancyGrid | None) -> None:
        """Begin an episode without tracks."""
        self._detector.reset(grid)
        self._belief = Belief.none()
        self._stamp = -np.inf
        self._next_id = 0

    def update(self, scan: LaserScan, pose: Pose, stamp: float) -> Tracks:
        """Take in the scan, seen from ``pose`` (base_link in ``map`` at the scan's stamp), if it is new; return the tracks at ``stamp``."""
        if scan.stamp > self._stamp:
            beams = Beams.of(scan, pose)
            self._predict(beams.stamp)
            self._detector.align(beams, self._belief)
            discs = self._detector.discs(beams, self._belief)
            matches = self._correct(discs)
            self._end_tracks(beams, matches)
            self._begin_tracks(discs, matches)
        return self._published(stamp)

    def _predict(self, stamp: float) -> None:
        """Move all tracks to the scan's stamp."""
        if len(self._belief.ids):
            predict(self._belief.states, self._belief.covariances, stamp - self._stamp, self._motion.acceleration_density)
        self._stamp = stamp

    def _correct(self, discs: Discs) -> NDArray[np.int64]:
        """Give each track its disc and take it in; return the matches (N,), -1 for none."""
        belief = self._belief
        matches = matched(belief.states, belief.covariances, belief.radii, discs.positions, discs.covariances, self._gate)
        positions, noises = np.zeros((len(matches), 2)), np.zeros((len(matches), 2, 2))
        place_by_radii(matches, discs, belief.radii, belief.radius_variances, self._noise, positions, noises)
        own = np.where(matches >= 0, np.arange(len(matches)), -1)
        correct(belief.states, belief.covariances, own, positions, noises, POSITION)
        self._hold_still(discs, matches)
        correct_radii(belief.radii, belief.radius_variances, matches, discs.radii, discs.radius_variances)
        return matches

    def _hold_still(self, discs: Discs, matches: NDArray[np.int64]) -> None:
        """Measure zero velocity of what stands where it stood: what is seen of it may shift as the robot drives by."""
        standing = np.where((matches >= 0) & discs.standing[matches].astype(np.bool_), matches, -1) if len(discs.radii) else matches
        count = len(discs.radii)
        still = np.tile(self._motion.standing_std**2 * np.eye(2), (count, 1, 1))
        correct(self._belief.states, self._belief.covariances, standing, np.zeros((count, 2)), still, VELOCITY)

    def _end_tracks(self, beams: Beams, matches: NDArray[np.int64]) -> None:
        """Count hits and misses, and drop the tracks that have ended."""
        belief, life = self._belief, self._life
        sight = np.empty(len(belief.ids), np.uint8)
        judge_sight(beams, belief.states, belief.radii, matches, self._returns.range, self._margin, sight)
        belief.hits[sight == SEEN] += 1
        belief.misses[sight == SEEN] = 0
        belief.seen_at[sight == SEEN] = beams.stamp
        belief.misses[sight == GONE] += 1
        allowed = np.where(belief.hits >= life.confirm_hits, life.misses, 1)
        uncertain = np.maximum(belief.covariances[:, 0, 0], belief.covariances[:, 1, 1]) > life.position_std**2
        hidden = beams.stamp - belief.seen_at > np.minimum(life.hidden_for, belief.seen_at - belief.born_at)
        ended = (belief.misses >= allowed) | hidden | uncertain
        self._belief = belief.where(~ended)

    def _begin_tracks(self, discs: Discs, matches: NDArray[np.int64]) -> None:
        """Begin a track at every disc that is no track's, and whose middle is in no body that was seen now: that is another side of it."""
        free = np.ones(len(discs.radii), np.bool_)
        free[matches[matches >= 0]] = False
        free &= ~self._inside_seen(discs)
        chosen = np.flatnonzero(free)
        speeds = np.where(discs.round[chosen], self._motion.speed_std, self._motion.standing_std)
        self._belief = self._belief.with_born(discs, chosen, self._next_id, speeds, self._stamp)
        self._next_id += len(chosen)

    def _published(self, stamp: float) -> Tracks:
        """Return the tracks that are believed, moved to ``stamp``."""
        told = self._belief.where(self._belief.hits >= self._life.confirm_hits)
        if len(told.ids) and stamp > self._stamp:
            predict(told.states, told.covariances, stamp - self._stamp, self._motion.acceleration_density)
        return Tracks(told.ids, told.states[:, :2].copy(), told.states[:, 2:].copy(), told.radii, told.covariances)

    def _inside_seen(self, discs: Discs) -> NDArray[np.bool_]:
        seen = self._belief.where(self._belief.seen_at == self._stamp)
        away = np.hypot(*(discs.positions[:, None] - seen.states[:, :2]).transpose(2, 0, 1))
        return np.asarray((away < seen.radii).any(axis=1))
