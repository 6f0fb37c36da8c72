"""Guidance of N robots in a few compiled calls: a pose error, a model of the tracker, and one path with detours."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from arena_core import (
    ConfigurationError,
    NoPath,
    Path,
    PathBatch,
    Pose,
    ReferenceLocalizer,
    Snapshot,
    WaypointGenerator,
    random_generator,
)
from arena_core.hosting import WAYPOINT_FOUND, Guide
from arena_core.parameters import Fraction, read_settings
from arena_gym.detours import DetourRules, Detours, LocalGround
from arena_gym.guidance import Floats, Guidance, GuidanceOutput, Ranges, Slots
from arena_gym.modelled_tracks import ModelledTracks, ScanNumbers, TrackModel, expect_straight, scans_of
from arena_gym.pool import Problem

STRAIGHT = "constant_velocity"


@dataclass(frozen=True, slots=True)
class GuidanceModel:
    """What stands for a robot's tracker and for its replanning in training, but in the last share ``real_share`` of the
    steps, in which robots have the real parts.
    """

    real_share: Fraction
    tracks: TrackModel
    detours: DetourRules


def read_model(guide: Mapping[str, Any]) -> GuidanceModel | None:
    """Return the model of a configuration's ``guide``, None where robots have the real parts; raise ConfigurationError.

    A model stands for one tracker and for tracks that go straight on.
    """
    node = guide.get("model")
    if node is None:
        return None
    model = read_settings(node, GuidanceModel, "guide.model")
    tracker = guide["tracker"]
    if tracker["name"] not in ("kalman", "none") or tracker.get("legs", {}).get("apart") is not None:
        raise ConfigurationError(
            f"guide.tracker is {tracker['name']}{' of legs' if 'legs' in tracker else ''}; allowed with guide.model: "
            "kalman, whose errors it has, or none"
        )
    if tracker["name"] == "kalman" and guide["predictor"]["name"] != STRAIGHT:
        raise ConfigurationError(
            f"guide.predictor is {guide['predictor']['name']}; allowed with guide.model: {STRAIGHT}"
        )
    return model


class BatchedGuidance(Guidance):
    """Robots that believe to stand and see what a ``model`` of the real parts says, on the path of their problem.

    The path is left where the scan has shown something on it for as long as the real stack waits, or where the waypoint
    generator asks for a new one; it leads round within a small window, or else is planned on the map alone.
    """

    def __init__(
        self,
        guide: Guide,
        model: GuidanceModel,
        tracks: ModelledTracks | None,
        waypoints: WaypointGenerator,
        worlds: int,
    ) -> None:
        if not isinstance(guide.localizer, ReferenceLocalizer):
            raise ConfigurationError(
                "guide.localizer filters scans; allowed with guide.model: gauss_markov or ground_truth"
            )
        self._localizer, self._planner, self._rules = guide.localizer, guide.global_planner, guide.replan
        self._robot, self._waypoints, self._tracks = guide.robot, waypoints, tracks
        self._detours = Detours(model.detours, guide.robot.footprint.inscribed_radius)
        self._problems: list[Problem | None] = [None] * worlds
        self._ways: list[Path | None] = [None] * worlds
        self._grounds: list[LocalGround | None] = [None] * worlds
        self._goals, self._radii = np.zeros((worlds, 2)), np.zeros(worlds)
        self._planned_at, self._blocked_since = np.zeros(worlds), np.full(worlds, np.inf)
        self._all = np.arange(worlds)

    def begin(self, slots: Slots, problems: Sequence[Problem], snapshot: Snapshot, ranges: Ranges) -> GuidanceOutput:
        """Begin at the start of each problem's path."""
        scenarios = [problem.scenario for problem in problems]
        for slot, problem in zip(slots.tolist(), problems, strict=True):
            scenario = problem.scenario
            self._problems[slot], self._ways[slot] = problem, problem.path
            self._grounds[slot] = LocalGround.of(scenario.world.grid if scenario.world.known else None)
            self._goals[slot], self._radii[slot] = (scenario.goal.x, scenario.goal.y), scenario.goal_radius
        self._planned_at[slots], self._blocked_since[slots] = snapshot.stamps[slots], np.inf
        keys = [
            random_generator(one.seed, one.name, "localizer").integers(2**64, size=1, dtype=np.uint64)[0]
            for one in scenarios
        ]
        self._localizer.begin(np.array(keys), slots, len(self._all))
        self._waypoints.reset(slots, len(self._all))
        if self._tracks is not None:
            self._tracks.begin(slots, scenarios)
        self._pack_ways()
        poses = self._localizer.estimates(snapshot.poses[slots], slots)
        paths = PathBatch.of([problem.path for problem in problems])
        waypoints = self._waypoints.next(paths, poses, snapshot.stamps[slots], slots).poses
        return self._output((slots, poses, waypoints, paths), snapshot, ranges, {})

    def look(self, snapshot: Snapshot, ranges: Ranges) -> GuidanceOutput:
        """Localise all robots, lead those round that have to be, and choose all waypoints, each in one call."""
        poses = self._localizer.estimates(snapshot.poses, self._all)
        scans = scans_of(self._robot.lidar, snapshot, ranges)
        away = np.hypot(poses[:, 0] - self._goals[:, 0], poses[:, 1] - self._goals[:, 1])
        may = (away > self._radii) & (snapshot.stamps - self._planned_at >= self._rules.min_interval - 1e-9)
        new = self._lead_round(self._due(poses, snapshot.stamps, scans) & may, poses, snapshot.stamps, scans)
        found = self._waypoints.next(self._paths, poses, snapshot.stamps)
        asking = (found.status != WAYPOINT_FOUND) & may & (self._planned_at < snapshot.stamps)
        if self._rules.on_request and asking.any():
            new |= self._lead_round(asking, poses, snapshot.stamps, scans)
            for slot in np.flatnonzero(asking):
                at, way = np.array((slot,)), self._ways[slot]
                assert way is not None
                again = self._waypoints.next(PathBatch.of([way]), poses[at], snapshot.stamps[at], at)
                found.poses[slot] = again.poses[0]
        return self._output((self._all, poses, found.poses, self._paths), snapshot, ranges, new)

    def _due(self, poses: Floats, stamps: Floats, scans: ScanNumbers) -> NDArray[np.bool_]:
        """Return whose path has been blocked for long enough."""
        if self._rules.blocked_for is None:
            return np.zeros(len(poses), np.bool_)
        blocked = self._detours.blocked(self._paths, poses, scans)
        self._blocked_since = np.where(blocked, np.minimum(self._blocked_since, stamps), np.inf)
        return np.asarray(stamps - self._blocked_since >= self._rules.blocked_for - 1e-9)

    def _lead_round(self, due: NDArray[np.bool_], poses: Floats, stamps: Floats, scans: ScanNumbers) -> dict[int, Path]:
        """Give these robots new paths where there are any; return them."""
        new: dict[int, Path] = {}
        for slot in np.flatnonzero(due).tolist():
            self._planned_at[slot], self._blocked_since[slot] = stamps[slot], np.inf
            way = self._new_way(slot, poses[slot], scans)
            if way is not None:
                self._ways[slot] = new[slot] = way
        if new:
            self._waypoints.reset(np.array(list(new)), len(self._all))
            self._pack_ways()
        return new

    def _new_way(self, slot: int, pose: Floats, scans: ScanNumbers) -> Path | None:
        way, ground, problem = self._ways[slot], self._grounds[slot], self._problems[slot]
        assert way is not None
        assert ground is not None
        assert problem is not None
        round_it = self._detours.way_round(way, pose, slot, scans, ground)
        if round_it is not None:
            return round_it
        scenario = problem.scenario
        if not scenario.world.known:
            return None
        try:
            return self._planner.plan(scenario.world.grid, Pose.of(pose), scenario.goal)
        except NoPath:
            return None

    def _pack_ways(self) -> None:
        self._paths = PathBatch.of([way for way in self._ways if way is not None])

    def _output(
        self, where: tuple[Slots, Floats, Floats, PathBatch], snapshot: Snapshot, ranges: Ranges, new: dict[int, Path]
    ) -> GuidanceOutput:
        slots, poses, waypoints, paths = where
        away = np.hypot(poses[:, 0] - self._goals[slots, 0], poses[:, 1] - self._goals[slots, 1])
        tracks = () if self._tracks is None else tuple(self._tracks.follow(slots, snapshot, ranges, poses))
        return GuidanceOutput(poses, waypoints, paths, away <= self._radii[slots], new, tracks, expect_straight(tracks))
