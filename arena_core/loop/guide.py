"""What a robot knows at one control step: where it is, which way it goes, what is around it.

A planner decides by it.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np

from arena_core.base.errors import ConfigurationError, NoPath
from arena_core.base.frozen import freeze_array
from arena_core.base.once import Once
from arena_core.base.random_streams import random_generator
from arena_core.base.stopwatch import Timed
from arena_core.contracts.navigation import (
    REPLAN_REASONS,
    WAYPOINT_FOUND,
    GlobalPlanner,
    Localizer,
    LocalMap,
    Predictor,
    Tracker,
    WaypointGenerator,
    Window,
)
from arena_core.contracts.truth import BrainPart, Truth
from arena_core.loop.closed_places import ClosedPlaces
from arena_core.loop.followed_path import FollowedPath
from arena_core.loop.foreseeing import foresee
from arena_core.loop.hearing import add_heard
from arena_core.loop.observing import make_observation, shown_map
from arena_core.loop.recovery import Begun, Recoveries, RecoveryRules
from arena_core.values.episode import Event
from arena_core.values.geometry import Pose, Twist
from arena_core.values.obstacles import add_obstacles
from arena_core.values.parameters import Fraction, NonNegative, Positive
from arena_core.values.predictions import Predictions
from arena_core.values.robot import Robot
from arena_core.values.sensing import Observation, PoseEstimate, Sensors, Tracks
from arena_core.values.world import Costmap, Obstacle, OccupancyGrid, Path

T = TypeVar("T")
_SLOT = np.zeros(1, np.int64)
GOAL_TOLERANCE = 0.15  # m, half the usual goal radius: how far a goal may move from the path's end
GOAL_MOVED = "goal_moved"


@dataclass(frozen=True, slots=True, eq=False)
class Mission:
    """What a robot is told before it drives: the map (None in an unknown world), where it believes to stand, and where
    to go.

    ``seed`` and ``scenario`` key the random streams of its components; ``goal_radius`` in m.
    """

    map: OccupancyGrid | None
    start: Pose
    goal: Pose
    goal_radius: float
    seed: int
    scenario: str


@dataclass(frozen=True, slots=True)
class ReplanRules:
    """When the navigator replans: every ``period`` s, when the waypoint generator asks, when blocked for so long
    (s).

    A periodic plan takes the old one's place if it costs less than that by a share of more than ``gain``, or the old
    one is blocked.
    """

    period: Positive | None
    on_request: bool
    blocked_for: Positive | None
    min_interval: NonNegative
    gain: Fraction


@dataclass(frozen=True, slots=True, eq=False)
class View:
    """What a robot knows at one control step, before anything decides.

    ``arrived`` is judged on the estimate; the rest of a view is then empty: ``waypoint`` is the goal, ``observation``
    None. So it is where a goal that moves is reached for now, and the robot waits. ``planned`` is the path if it is
    new, else None. ``local_map`` and ``tracks`` are computed when first asked for.
    """

    estimate: PoseEstimate
    waypoint: Pose
    planned: Path | None
    arrived: bool
    events: tuple[Event, ...]
    observation: Observation | None
    local_map: Callable[[], Costmap]
    tracks: Once[Tracks] | None = None


def _call_untimed(part: str, compute: Callable[[], T]) -> T:
    return compute()


@dataclass(frozen=True, slots=True)
class GuideParts:
    """The robot, and one component of each kind that leads it; without a predictor tracks keep their velocity.

    ``privileged`` are those that see the truth, nested ones too.
    """

    robot: Robot
    localizer: Localizer
    global_planner: GlobalPlanner
    waypoints: WaypointGenerator
    local_map: LocalMap
    tracker: Tracker
    predictor: Predictor | None = None
    privileged: tuple[BrainPart, ...] = ()


class Guide:
    """Owns localiser, global planner, waypoint generator, local map, tracker and predictor of one robot: all of a
    navigator but its planner.
    """

    def __init__(
        self, parts: GuideParts, replan: ReplanRules, recoveries: RecoveryRules, control_period: float
    ) -> None:
        self.robot = parts.robot
        self.localizer = parts.localizer
        self.global_planner = parts.global_planner
        self.waypoints = parts.waypoints
        self.local_map = parts.local_map
        self.tracker = parts.tracker
        self.predictor = parts.predictor
        self.privileged = parts.privileged
        self._truth: Truth | None = None
        self.replan = replan
        self.rules = recoveries
        self.recoveries = Recoveries(recoveries, parts.robot)
        self.control_period = control_period

    def reset(self, mission: Mission, truth: Truth | None = None) -> None:
        """Begin an episode; nothing of the one before is kept. Privileged parts are shown the ``truth``."""
        self.see(truth)
        self.begin(mission)
        self.localizer.reset(mission.map, mission.start, self._random_stream("localizer"))
        self.waypoints.reset(_SLOT, 1)
        self.tracker.reset(mission.map)
        if self.predictor is not None:
            self.predictor.reset(mission.map)
        self._shown_map = mission.map.derive(shown_map) if mission.map is not None else None

    def see(self, truth: Truth | None) -> None:
        """Show privileged parts the truth of the world that the robot is in; raise ConfigurationError where there is
        none to show.
        """
        self._truth = truth
        for part in self.privileged:
            if truth is None:
                raise ConfigurationError(
                    f"{type(part).__name__} sees the truth, which only a simulator knows; allowed here: parts that "
                    "are not privileged"
                )
            part.see(truth)

    def begin(self, mission: Mission) -> None:
        """Begin an episode as far as planning goes: for who localises and chooses
        waypoints for several robots at once.
        """
        self.mission = mission
        self._way: FollowedPath | None = None
        self._planned_at = -math.inf
        self._blocked_since: float | None = None
        self._goal_moved = False
        self._closed = ClosedPlaces()
        self.local_map.reset(mission.map)
        self.recoveries.reset()

    def look(self, sensors: Sensors, timed: Timed = _call_untimed) -> View:
        """Localise, begin a recovery if there is no progress, plan where needed, and choose a waypoint.

        Raises NoPath where there is no first path.
        """
        estimate = _freeze_estimate(self.localizer.update(sensors))
        if sensors.goal is not None:
            self._move_goal(sensors.goal)
        scan_pose = pose_at_scan(estimate.pose, sensors.odometry.twist, sensors.stamp - sensors.scan.stamp)
        window: Callable[[], Window] = Once(
            lambda: timed("local_map", lambda: self.local_map.take_in(sensors.scan, scan_pose))
        )
        local_map: Callable[[], Costmap] = Once(lambda: timed("local_map", window().costmap))
        if estimate.pose.distance(self.mission.goal) <= self.mission.goal_radius:
            if sensors.goal is not None:
                self.recoveries.reset()
            return View(estimate, self.mission.goal, None, sensors.goal is None, (), None, local_map)
        begun = self._begin_recovery(
            estimate.pose, sensors.stamp, lambda: self.recoveries.touches(local_map(), estimate.pose)
        )
        before = self._way
        way, waypoint, events = self._plan_path(estimate.pose, sensors.stamp, window, begun)
        tracks = Once(lambda: timed("tracker", lambda: self._track(sensors, scan_pose)))
        observation = make_observation(
            sensors,
            estimate,
            self.mission.goal,
            waypoint,
            way.shown,
            self._shown_map,
            local_map,
            tracks,
            self._foreseer(timed),
        )
        return View(
            estimate, waypoint, way.path if way is not before else None, False, events, observation, local_map, tracks
        )

    def _track(self, sensors: Sensors, scan_pose: Pose) -> Tracks:
        """Return what the tracker believes in, and the teammates that were heard of."""
        return add_heard(self.tracker.update(sensors.scan, scan_pose, sensors.stamp), sensors.heard, sensors.stamp)

    def _foreseer(self, timed: Timed) -> Callable[[Observation], Predictions] | None:
        """Return what makes predictions of an observation, None without a predictor."""
        predictor = self.predictor
        if predictor is None:
            return None
        return lambda seen: timed("predictor", lambda: foresee(predictor, seen))

    def _move_goal(self, goal: Pose) -> None:
        """Take in where a goal that moves is now; a path is due that leads there, unless the last one ends near."""
        if goal != self.mission.goal:
            self.mission = replace(self.mission, goal=goal)
        end = None if self._way is None else self._way.path.poses[-1]
        self._goal_moved = end is not None and math.dist(end[:2], (goal.x, goal.y)) > GOAL_TOLERANCE

    def may_replan(self, stamp: float) -> bool:
        """Return whether the last plan is so long ago that another may be made."""
        return stamp - self._planned_at >= self.replan.min_interval - 1e-9

    def why_replan(self, pose: Pose, stamp: float, window: Callable[[], Window]) -> str | None:
        """Return why a new path is due now, None if none is."""
        if self._way is None:
            return "start"
        if self._goal_moved and self.may_replan(stamp):
            return GOAL_MOVED
        if self.replan.period is not None and stamp - self._planned_at >= self.replan.period - 1e-9:
            return "period"
        if self.replan.blocked_for is None:
            return None
        if not self._way.is_blocked(pose, window()):
            self._blocked_since = None
            return None
        self._blocked_since = stamp if self._blocked_since is None else self._blocked_since
        blocked_long = stamp - self._blocked_since >= self.replan.blocked_for - 1e-9
        return "blocked" if blocked_long and self.may_replan(stamp) else None

    def plan_anew(self, pose: Pose, stamp: float, reason: str, window: Callable[[], Window]) -> tuple[Event, ...]:
        """Replan and note it; keep the old path when there is no new one.

        Raises NoPath where there is no first path.
        """
        self._planned_at, self._blocked_since, self._goal_moved = stamp, None, False
        try:
            grid, path = self._new_path(pose, reason, window)
        except NoPath:
            if self._way is None:
                raise
            return (Event(stamp, "replan", f"{reason}: no path, keeping the old one"),)
        if reason == "period" and self._is_as_good(grid, pose, path):
            return (Event(stamp, "replan", "period: little to gain, keeping the old one"),)
        self.follow(path)
        return (Event(stamp, "replan", reason),)

    def follow(self, path: Path) -> None:
        """Follow this path from now on."""
        self._way = FollowedPath(path)
        self.waypoints.reset(_SLOT, 1)

    @property
    def path(self) -> Path | None:
        """Return the path that is followed, None before the first one."""
        return None if self._way is None else self._way.path

    def _random_stream(self, name: str) -> np.random.Generator:
        return random_generator(self.mission.seed, self.mission.scenario, name)

    def _begin_recovery(self, pose: Pose, stamp: float, touches: Callable[[], bool]) -> Begun | None:
        """Return the recovery behaviour that begins now; what it wipes off the local map is gone
        before the scan is taken in.
        """
        begun = self.recoveries.begin(pose, stamp, touches)
        if begun is not None and begun.clear_beyond is not None:
            self.local_map.clear(pose, begun.clear_beyond)
        if begun is not None and begun.closes and self._way is not None:
            return replace(
                begun, event=replace(begun.event, detail=f"{begun.event.detail}; {self._close_ahead(pose, stamp)}")
            )
        return begun

    def _close_ahead(self, pose: Pose, stamp: float) -> str:
        """Close the place ahead on the path for a while, and return what an event says of it."""
        assert self._way is not None
        place, rules = self._way.ahead(pose, self.rules.detour_ahead), self.rules
        time = self._closed.close(place, rules.detour_radius, stamp, rules.detour_time)
        return f"({place[0, 0]:.2f}, {place[0, 1]:.2f}) is closed for {time:.0f} s"

    def _plan_path(
        self, pose: Pose, stamp: float, window: Callable[[], Window], begun: Begun | None
    ) -> tuple[FollowedPath, Pose, tuple[Event, ...]]:
        """Return way, waypoint and the events that led there: a recovery, a due replan, and one
        that the waypoint asked for.
        """
        reason = "recovery" if begun is not None else self.why_replan(pose, stamp, window)
        events: tuple[Event, ...] = () if begun is None else (begun.event,)
        events += self.plan_anew(pose, stamp, reason, window) if reason else ()
        waypoint, status = self._next_waypoint(pose, stamp)
        if status != WAYPOINT_FOUND and self.replan.on_request and self.may_replan(stamp):
            events += self.plan_anew(pose, stamp, REPLAN_REASONS[status], window)
            waypoint, status = self._next_waypoint(pose, stamp)
        assert self._way is not None
        return self._way, waypoint, events

    def _new_path(self, pose: Pose, reason: str, window: Callable[[], Window]) -> tuple[OccupancyGrid, Path]:
        """Return a path and the grid that it was planned on: the static map first, later with what the scans have
        shown.

        All marks count, as they do for what blocks the robot, and so do closed places: unless they leave no way that is
        wide enough for the planner. Rather than through a narrow passage, a path leads where the map alone has room:
        what stands there now may walk on. Where there is no way at all, marks are left out that may be the map's own
        walls, seen from a pose that is a little off.
        """
        if self.mission.map is not None and reason == "start":
            return self.mission.map, self.global_planner.plan(self.mission.map, pose, self.mission.goal)
        window()
        closed = self._closed.at(self._planned_at)
        for places in (closed, []) if closed else ([],):
            grid = add_obstacles(self.local_map.planning_grid(self.mission.goal, all_marks=True), places)
            with suppress(NoPath):
                path = self.global_planner.plan(grid, pose, self.mission.goal)
                return (
                    self._plan_wide_path(pose, closed) or (grid, path)
                    if self.global_planner.is_narrow(grid, path)
                    else (grid, path)
                )
        grid = self.local_map.planning_grid(self.mission.goal, all_marks=False)
        return grid, self.global_planner.plan(grid, pose, self.mission.goal)

    def _plan_wide_path(self, pose: Pose, closed: list[Obstacle]) -> tuple[OccupancyGrid, Path] | None:
        """Return a path on the map alone, with ``closed`` places, that leads through no narrow
        passage; None if there is none.
        """
        if self.mission.map is None:
            return None
        grid = add_obstacles(self.mission.map, closed)
        with suppress(NoPath):
            path = self.global_planner.plan(grid, pose, self.mission.goal)
            return None if self.global_planner.is_narrow(grid, path) else (grid, path)
        return None

    def _is_as_good(self, grid: OccupancyGrid, pose: Pose, new: Path) -> bool:
        """Return whether what is left of the old path costs little more than the new one."""
        assert self._way is not None
        old = self.global_planner.cost(grid, self._way.rest(pose))
        return math.isfinite(old) and (1.0 - self.replan.gain) * old <= self.global_planner.cost(grid, new)

    def _next_waypoint(self, pose: Pose, stamp: float) -> tuple[Pose, int]:
        assert self._way is not None
        found = self.waypoints.next(self._way.batch, pose.array()[None], np.array((stamp,)))
        return Pose.of(found.poses[0]), int(found.status[0])


def _freeze_estimate(estimate: PoseEstimate) -> PoseEstimate:
    """Return an estimate that its localiser cannot change any more."""
    return PoseEstimate(estimate.pose, freeze_array(estimate.covariance))


def pose_at_scan(pose: Pose, twist: Twist, age: float) -> Pose:
    """Return where the robot was at its scan's stamp, ``age`` s ago: the estimate, moved back
    along the measured twist.
    """
    if age <= 0.0:
        return pose
    turned = Pose(pose.x, pose.y, pose.theta - 0.5 * twist.wz * age)
    moved = turned.compose(Pose(-twist.vx * age, -twist.vy * age))
    return Pose(moved.x, moved.y, pose.theta - twist.wz * age)
