"""Guides of N robots that do in one call what they all do at every step, and alone
what a robot does now and then: plan.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache, partial

import numpy as np
from numpy.typing import NDArray

from arena_core import (
    Costmap,
    LaserScan,
    NoPath,
    Observation,
    PathBatch,
    Pose,
    Predictions,
    ReferenceLocalizer,
    Snapshot,
    Tracks,
    Twist,
    WaypointGenerator,
    Window,
    random_generator,
)
from arena_core.hosting import (
    REPLAN_REASONS,
    WAYPOINT_FOUND,
    EpisodeLoop,
    Guide,
    WorldTruth,
    foresee,
    mission_of,
    pose_at_scan,
    straight_predictions,
)
from arena_gym.guidance import Floats, Guidance, GuidanceOutput, Ranges, Slots
from arena_gym.pool import Problem

CERTAIN = np.zeros((3, 3))


@dataclass(frozen=True, slots=True, eq=False)
class Stand:
    """Where robots in K ``slots`` believe to be, ``poses`` (K, 3), and their ``waypoints`` (K, 3)."""

    slots: Slots
    poses: Floats
    waypoints: Floats

    def rows(self) -> Iterator[tuple[int, Pose, Pose]]:
        """Yield each robot's slot, pose and waypoint."""
        for slot, pose, waypoint in zip(self.slots.tolist(), self.poses, self.waypoints, strict=True):
            yield slot, Pose.of(pose), Pose.of(waypoint)


class SharedGuidance(Guidance):
    """Robots that localise and replan as in a benchmark, bit for bit, at a fraction of the cost of N guides.

    They share a localiser that needs the true pose alone, and a waypoint generator. Each has its own guide for its
    plans and its local map, which takes in scans only where the rules of replanning look at it, and where robots are
    ``tracked`` its own tracker. There are no recoveries.
    """

    def __init__(
        self,
        make_guide: Callable[[], Guide],
        waypoints: WaypointGenerator,
        loop: EpisodeLoop,
        *,
        tracked: bool,
    ) -> None:
        self._loop, worlds = loop, loop.robots
        self._guides = [make_guide() for _ in range(worlds)]
        self._tracked = tracked
        for guide in self._guides:  # plans depend on what is asked alone: one planner needs the memory of one
            guide.global_planner = self._guides[0].global_planner
        localizer = self._guides[0].localizer
        assert isinstance(localizer, ReferenceLocalizer)
        self._localizer, self._waypoints = localizer, waypoints
        self._rules = self._guides[0].replan
        self._looks = self._rules.period is not None or self._rules.blocked_for is not None
        self._goals, self._radii = np.zeros((worlds, 2)), np.zeros(worlds)
        self._all = np.arange(worlds)

    @staticmethod
    def can_share(guide: Guide) -> bool:
        """Return whether robots with such guides can be led so."""
        return isinstance(guide.localizer, ReferenceLocalizer) and not guide.rules.behaviours

    def begin(self, slots: Slots, problems: Sequence[Problem], snapshot: Snapshot, ranges: Ranges) -> GuidanceOutput:
        """Plan each robot's first path from where it believes to stand."""
        for slot, problem in zip(slots.tolist(), problems, strict=True):
            scenario = problem.scenario
            mission = mission_of(scenario)
            self._guides[slot].see(WorldTruth(self._loop, slot, scenario))
            self._guides[slot].begin(mission)
            self._guides[slot].tracker.reset(mission.map)
            self._goals[slot], self._radii[slot] = (scenario.goal.x, scenario.goal.y), scenario.goal_radius
        keys = [
            random_generator(p.scenario.seed, p.scenario.name, "localizer").integers(2**64, size=1, dtype=np.uint64)[0]
            for p in problems
        ]
        self._localizer.begin(np.array(keys), slots, len(self._guides))
        self._waypoints.reset(slots, len(self._guides))
        poses = self._localizer.estimates(snapshot.poses[slots], slots)
        for slot, pose, problem in zip(slots.tolist(), poses, problems, strict=True):
            self._plan_first(slot, Pose.of(pose), float(snapshot.stamps[slot]), problem)
        self._paths = PathBatch.of([guide.path for guide in self._guides if guide.path is not None])
        paths = PathBatch.of([guide.path for guide in (self._guides[slot] for slot in slots) if guide.path is not None])
        waypoints = self._waypoints.next(paths, poses, snapshot.stamps[slots], slots).poses
        return GuidanceOutput(
            poses,
            waypoints,
            paths,
            self._has_arrived(poses, slots),
            {},
            *self._follow_people(snapshot, ranges, Stand(slots, poses, waypoints), {}),
        )

    def look(self, snapshot: Snapshot, ranges: Ranges) -> GuidanceOutput:
        """Localise all robots, let those plan that have to, and choose the waypoints of all in one call."""
        poses = self._localizer.estimates(snapshot.poses, self._all)
        arrived = self._has_arrived(poses, self._all)
        windows: dict[int, Callable[[], Window]] = {}
        planned = self._replan_due(snapshot, ranges, poses, arrived, windows) if self._looks else []
        self._renew_paths(planned)
        found = self._waypoints.next(self._paths, poses, snapshot.stamps)
        asking = np.flatnonzero((found.status != WAYPOINT_FOUND) & ~arrived) if self._rules.on_request else ()
        for slot in (int(slot) for slot in asking):
            stamp = float(snapshot.stamps[slot])
            guide = self._guides[slot]
            if not guide.may_replan(stamp):
                continue
            before = guide.path
            window = windows.setdefault(slot, self._window_getter(slot, snapshot, ranges, Pose.of(poses[slot])))
            guide.plan_anew(Pose.of(poses[slot]), stamp, REPLAN_REASONS[int(found.status[slot])], window)
            if guide.path is not before:
                planned.append(slot)
                self._renew_paths([slot])
            at = np.array((slot,))
            path = guide.path
            assert path is not None
            found.poses[slot] = self._waypoints.next(PathBatch.of([path]), poses[at], snapshot.stamps[at], at).poses[0]
        new = {slot: path for slot in planned if (path := self._guides[slot].path) is not None}
        people = self._follow_people(snapshot, ranges, Stand(self._all, poses, found.poses), windows)
        return GuidanceOutput(poses, found.poses, self._paths, arrived, new, *people)

    def _has_arrived(self, poses: Floats, slots: Slots) -> NDArray[np.bool_]:
        """Tell who believes to be within the goal's radius, as guides do."""
        offsets = poses[:, :2] - self._goals[slots]
        away = np.array([math.hypot(x, y) for x, y in offsets.tolist()])
        return away <= self._radii[slots]

    def _plan_first(self, slot: int, pose: Pose, stamp: float, problem: Problem) -> None:
        guide = self._guides[slot]
        try:
            guide.plan_anew(pose, stamp, "start", _no_window)
        except NoPath:  # its estimate may lie too near to a wall
            guide.follow(problem.path)

    def _replan_due(
        self,
        snapshot: Snapshot,
        ranges: Ranges,
        poses: Floats,
        arrived: NDArray[np.bool_],
        windows: dict[int, Callable[[], Window]],
    ) -> list[int]:
        """Show each robot's local map the scan, and let those plan whose path is blocked or old;
        return who has a new path.
        """
        planned = []
        for slot in np.flatnonzero(~arrived).tolist():
            guide, pose, stamp = self._guides[slot], Pose.of(poses[slot]), float(snapshot.stamps[slot])
            windows[slot] = window = self._window_getter(slot, snapshot, ranges, pose)
            reason = guide.why_replan(pose, stamp, window)
            if reason is not None:
                before = guide.path
                guide.plan_anew(pose, stamp, reason, window)
                if guide.path is not before:
                    planned.append(slot)
        return planned

    def _window_getter(self, slot: int, snapshot: Snapshot, ranges: Ranges, pose: Pose) -> Callable[[], Window]:
        """Return what lets a robot's local map take in its scan, once, when it is asked for."""
        return cache(lambda: self._guides[slot].local_map.take_in(*_scan_of(slot, snapshot, ranges[slot], pose)))

    def _follow_people(
        self, snapshot: Snapshot, ranges: Ranges, stand: Stand, windows: dict[int, Callable[[], Window]]
    ) -> tuple[tuple[Tracks, ...], tuple[Predictions, ...]]:
        """Return whom robots track where they believe to stand, and where those will be; nothing where no one asks."""
        tracks: list[Tracks] = []
        ahead: list[Predictions] = []
        for slot, pose, waypoint in stand.rows() if self._tracked else ():
            guide, stamp = self._guides[slot], float(snapshot.stamps[slot])
            scan, then = _scan_of(slot, snapshot, ranges[slot], pose)
            tracks.append(guide.tracker.update(scan, then, stamp))
            window = windows.setdefault(slot, self._window_getter(slot, snapshot, ranges, pose))
            if guide.predictor is None or guide.path is None:
                ahead.append(straight_predictions(tracks[-1]))
                continue
            way = guide.mission.goal, waypoint, guide.path, guide.mission.map
            twist = Twist.of(snapshot.odometry_twists[slot])
            seen = Observation(
                stamp, pose, CERTAIN, twist, scan, *way, _costmap_of(window), partial(_given, tracks[-1])
            )
            ahead.append(foresee(guide.predictor, seen))
        return tuple(tracks), tuple(ahead)

    def _renew_paths(self, slots: Sequence[int]) -> None:
        """Take these robots' new paths for theirs."""
        if slots:
            self._waypoints.reset(np.array(slots), len(self._guides))
            self._paths = PathBatch.of([guide.path for guide in self._guides if guide.path is not None])


def _scan_of(slot: int, snapshot: Snapshot, ranges: Ranges, pose: Pose) -> tuple[LaserScan, Pose]:
    """Return a robot's scan with these ranges (B,), and where it believes to have been then, now being at ``pose``."""
    head, stamp = snapshot.scan_header, float(snapshot.scan_stamps[slot])
    age = float(snapshot.stamps[slot]) - stamp
    if age > 0.0:
        pose = pose_at_scan(pose, Twist.of(snapshot.odometry_twists[slot]), age)
    return LaserScan(
        stamp, head.angle_min, head.angle_increment, head.range_min, head.range_max, ranges, head.mount
    ), pose


def _costmap_of(window: Callable[[], Window]) -> Callable[[], Costmap]:
    return lambda: window().costmap()


def _given(tracks: Tracks) -> Tracks:
    return tracks


def _no_window() -> Window:
    raise AssertionError("a first path is planned on the map alone")
