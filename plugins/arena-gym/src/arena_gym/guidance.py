"""What leads N robots to their goals in training: the path planned at first, or all that a navigator has."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from arena_core import NO_TRACKS, NoPath, Path, PathBatch, Predictions, Sensors, Snapshot, Tracks, WaypointGenerator
from arena_core.hosting import EpisodeLoop, Guide, View, WorldTruth, mission_of, straight_predictions
from arena_gym.pool import Problem

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]
Slots = NDArray[np.int64]
Ranges = NDArray[np.float32]


@dataclass(frozen=True, slots=True, eq=False)
class GuidanceOutput:
    """What K robots know of their way: estimated ``poses`` and ``waypoints`` (K, 3) in ``map``, and ``paths``.

    ``arrived`` (K,) is their belief; ``new_paths`` holds, by slot, the paths that were planned in this step; ``tracks``
    (K) and ``predictions`` (K) of where they will be, none where no one asks for them.
    """

    poses: Floats
    waypoints: Floats
    paths: PathBatch
    arrived: Flags
    new_paths: dict[int, Path]
    tracks: tuple[Tracks, ...] = ()
    predictions: tuple[Predictions, ...] = ()


class Guidance(ABC):
    """Leads N robots; slot k depends on its own episode alone."""

    @abstractmethod
    def begin(self, slots: Slots, problems: Sequence[Problem], snapshot: Snapshot, ranges: Ranges) -> GuidanceOutput:
        """Begin episodes in K slots, whose ``snapshot`` and ``ranges`` (N, B) are the first;
        return what is known there.
        """

    @abstractmethod
    def look(self, snapshot: Snapshot, ranges: Ranges) -> GuidanceOutput:
        """Return what all N robots know now."""


class PathGuidance(Guidance):
    """Robots that know where they are and follow the path that was planned at first: what costs least."""

    def __init__(self, waypoints: WaypointGenerator, worlds: int) -> None:
        self._waypoints = waypoints
        self._problems: list[Problem | None] = [None] * worlds
        self._goals, self._radii = np.zeros((worlds, 2)), np.zeros(worlds)

    def begin(self, slots: Slots, problems: Sequence[Problem], snapshot: Snapshot, ranges: Ranges) -> GuidanceOutput:
        """Begin at the start of each problem's path."""
        for slot, problem in zip(slots.tolist(), problems, strict=True):
            self._problems[slot] = problem
            goal = problem.scenario.goal
            self._goals[slot], self._radii[slot] = (goal.x, goal.y), problem.scenario.goal_radius
        self._paths = PathBatch.of([problem.path for problem in self._problems if problem is not None])
        self._waypoints.reset(slots, len(self._problems))
        waypoints = np.array([problem.waypoint for problem in problems])
        paths = PathBatch.of([problem.path for problem in problems])
        return GuidanceOutput(snapshot.poses[slots], waypoints, paths, np.zeros(len(slots), np.bool_), {})

    def look(self, snapshot: Snapshot, ranges: Ranges) -> GuidanceOutput:
        """Choose the next waypoints of all robots in one call."""
        waypoints = self._waypoints.next(self._paths, snapshot.poses, snapshot.stamps).poses
        off = np.hypot(snapshot.poses[:, 0] - self._goals[:, 0], snapshot.poses[:, 1] - self._goals[:, 1])
        return GuidanceOutput(snapshot.poses, waypoints, self._paths, off <= self._radii, {})


class NavigatorGuidance(Guidance):
    """Robots that localise themselves and replan as they do in a benchmark, each by a guide of its own."""

    def __init__(self, make_guide: Callable[[], Guide], loop: EpisodeLoop, *, tracked: bool) -> None:
        self._loop, worlds = loop, loop.robots
        self._guides = [make_guide() for _ in range(worlds)]
        self._tracked = tracked
        self._problems: list[Problem | None] = [None] * worlds
        self._paths: list[Path | None] = [None] * worlds

    def begin(self, slots: Slots, problems: Sequence[Problem], snapshot: Snapshot, ranges: Ranges) -> GuidanceOutput:
        """Tell each robot of its mission and let it look for the first time."""
        for slot, problem in zip(slots.tolist(), problems, strict=True):
            scenario = problem.scenario
            self._guides[slot].reset(mission_of(scenario), WorldTruth(self._loop, slot, scenario))
            self._problems[slot], self._paths[slot] = problem, problem.path
        return self._update_robots(slots.tolist(), snapshot, ranges)

    def look(self, snapshot: Snapshot, ranges: Ranges) -> GuidanceOutput:
        """Let one robot after the other look."""
        return self._update_robots(range(len(self._guides)), snapshot, ranges)

    def _update_robots(self, slots: Sequence[int], snapshot: Snapshot, ranges: Ranges) -> GuidanceOutput:
        views = {slot: self._robot_view(slot, snapshot, ranges) for slot in slots}
        new = {slot: view.planned for slot, view in views.items() if view is not None and view.planned is not None}
        for slot, path in new.items():
            self._paths[slot] = path
        paths = PathBatch.of([path for path in (self._paths[slot] for slot in slots) if path is not None])
        poses = [snapshot.poses[slot] if view is None else view.estimate.pose.array() for slot, view in views.items()]
        waypoints = [
            self._first_waypoint(slot) if view is None else view.waypoint.array() for slot, view in views.items()
        ]
        arrived = [view is not None and view.arrived for view in views.values()]
        seen = views.values() if self._tracked else ()
        both = tuple(map(_tracks_of, seen)), tuple(map(_predictions_of, seen))
        return GuidanceOutput(np.array(poses), np.array(waypoints), paths, np.array(arrived), new, *both)

    def _robot_view(self, slot: int, snapshot: Snapshot, ranges: Ranges) -> View | None:
        """Return what one robot knows; None where it finds no first path, as its
        estimate may lie too near to a wall.
        """
        try:
            return self._guides[slot].look(robot_sensors(snapshot, slot, ranges))
        except NoPath:
            return None

    def _first_waypoint(self, slot: int) -> Floats:
        problem = self._problems[slot]
        assert problem is not None
        return problem.waypoint


def _tracks_of(view: View | None) -> Tracks:
    """Return whom a robot tracks; no one where it sees nothing any more."""
    return NO_TRACKS if view is None or view.tracks is None else view.tracks()


def _predictions_of(view: View | None) -> Predictions:
    """Return where those will be whom a robot tracks."""
    seen = None if view is None else view.observation
    return straight_predictions(_tracks_of(view)) if seen is None else seen.predictions


def robot_sensors(snapshot: Snapshot, slot: int, ranges: Ranges) -> Sensors:
    """Return what the robot of world ``slot`` measures, with these ranges (N, B) instead of the simulator's."""
    sensors = snapshot.sensors(slot)
    return replace(sensors, scan=replace(sensors.scan, ranges=ranges[slot].copy()))
