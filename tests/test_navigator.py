import math
from dataclasses import replace

import numpy as np
import pytest

from arena_core import (
    INSCRIBED,
    NO_TRACKS,
    OFF_PATH,
    WAYPOINT_FOUND,
    WAYPOINT_TIMEOUT,
    GlobalPlanner,
    InvalidCommand,
    Localizer,
    LocalMap,
    NoPath,
    NoValidCommand,
    Odometry,
    Planner,
    Pose,
    PoseEstimate,
    Tracker,
    Twist,
    WaypointGenerator,
    Waypoints,
)
from arena_core.navigator import BRAKE, Mission, Navigator, ReplanRules
from arena_core.recovery import RecoveryRules
from arena_core.testing import free_costmap, robot, room, sensors, straight_path

GOAL = Pose(3.0, 0.0)
WHEN_ASKED = ReplanRules(None, True, None, 0.0, 0.0)
NO_RECOVERIES = RecoveryRules([], 0.5, 10.0, 3.0, 3.0, 5.0, 1.57, 1.0, 0.3, 0.15, 0.5, 0.4, 60.0)


class Odometer(Localizer):
    """Believes its odometry."""

    def reset(self, grid, start, random):
        pass

    def update(self, sensors):
        return PoseEstimate(sensors.odometry.pose, np.zeros((3, 3)))


class Straight(GlobalPlanner):
    """Plans straight lines, unless there is no way; ``detour`` times its length is what the old path costs."""

    def __init__(self):
        self.grids, self.no_way, self.closed, self.paths, self.detour = [], False, [], [], 1.0
        self.refuses_obstacles = False

    def plan(self, grid, start, goal):
        self.grids.append(grid)
        detour = self.refuses_obstacles and grid.occupied.sum() > room().occupied.sum()
        if self.no_way or detour or any(grid is closed for closed in self.closed):
            raise NoPath("walled in")
        self.paths.append(straight_path(start, goal))
        return self.paths[-1]

    def cost(self, grid, path):
        return path.length if path is self.paths[-1] else self.detour * path.length


class Ahead(WaypointGenerator):
    """Puts the waypoint at the path's end and says what it is told to say, once."""

    def __init__(self):
        self.status, self.resets = WAYPOINT_FOUND, 0

    def reset(self, slots, total):
        self.resets += 1

    def next(self, paths, poses, stamps):
        status, self.status = self.status, WAYPOINT_FOUND
        return Waypoints(paths.poses[-1:], np.array((status,), np.int8))


class Window(LocalMap):
    """Shows a given costmap and counts how often it was asked."""

    def __init__(self):
        self.costmap, self.asked, self.poses = free_costmap(Pose(0.0, 0.0)), 0, []
        self.grid, self.lenient, self.cleared = room(), room(), []

    def reset(self, grid):
        pass

    def update(self, scan, pose):
        self.asked += 1
        self.poses.append(pose)
        return self.costmap

    def planning_grid(self, goal, all_marks):
        assert goal == GOAL
        return self.grid if all_marks else self.lenient

    def clear(self, pose, beyond):
        self.cleared.append((pose, beyond, self.asked))


class Nobody(Tracker):
    def reset(self, grid):
        pass

    def update(self, scan, pose, stamp):
        return NO_TRACKS


class Says(Planner):
    """Returns, or raises, what it is told, and keeps what it saw."""

    def __init__(self, answer):
        self.answer, self.seen, self.started = answer, [], None

    def reset(self, episode):
        self.started = episode

    def compute_velocity(self, observation):
        self.seen.append(observation)
        if isinstance(self.answer, Exception):
            raise self.answer
        return self.answer(observation) if callable(self.answer) else self.answer


@pytest.fixture
def drive():
    """Make a navigator that stands ready in the walled room; keyword ``map`` None: an unknown world."""

    def make(answer=Twist(0.5), rules=WHEN_ASKED, map=room(), recoveries=NO_RECOVERIES):  # noqa: B008 - both are frozen
        navigator = Navigator(robot(), Odometer(), Straight(), Ahead(), Window(), Nobody(), Says(answer), rules, recoveries, 0.1)
        navigator.reset(Mission(map, Pose(0.0, 0.0), GOAL, 0.3, 7, "sample/0"))
        return navigator

    return make


def at(x, stamp=0.0, **changes):
    return replace(sensors(Pose(x, 0.0), robot(), stamp), **changes)


def reasons(decision):
    return [(event.kind, event.detail) for event in decision.events]


def test_the_first_step_plans_and_later_ones_keep_the_path(drive):
    navigator = drive()
    first = navigator.decide(at(0.0))
    assert reasons(first) == [("replan", "start")]
    assert first.planned.length == pytest.approx(3.0)
    later = [navigator.decide(at(0.1 * k, 0.1 * k)) for k in range(1, 20)]
    assert all(not d.events and d.planned is None for d in later)


def test_the_planner_sees_estimate_goal_waypoint_path_map_and_what_was_measured(drive):
    navigator = drive()
    view = at(0.5, 0.2)
    navigator.decide(view)
    (seen,) = navigator.planner.seen
    assert (seen.stamp, seen.pose, seen.goal, seen.waypoint) == (0.2, Pose(0.5, 0.0), GOAL, Pose(3.0, 0.0))
    assert seen.scan is view.scan
    assert seen.path.poses[0].tolist() == [0.5, 0.0, 0.0]
    assert seen.map is navigator.mission.map


def test_the_planner_is_told_map_goal_period_and_a_stream_of_its_own(drive):
    told = drive().planner.started
    assert (told.goal, told.control_period) == (GOAL, 0.1)
    assert told.random.random() == drive().planner.started.random.random()


def test_local_map_and_tracks_are_computed_only_when_asked_for_and_once(drive):
    lazy = drive()
    lazy.decide(at(0.0))
    assert lazy.local_map.asked == 0
    eager = drive(lambda seen: Twist(float(seen.local_map is seen.local_map and seen.tracks is seen.tracks)))
    assert eager.decide(at(0.0)).command.vx == 1.0
    assert eager.local_map.asked == 1


def test_replans_every_period(drive):
    navigator = drive(rules=ReplanRules(0.5, False, None, 0.0, 0.0))
    stamps = [k for k in range(21) if navigator.decide(at(0.0, 0.1 * k)).events]
    assert stamps == [0, 5, 10, 15, 20]


@pytest.mark.parametrize(("status", "reason"), [(OFF_PATH, "off_path"), (WAYPOINT_TIMEOUT, "waypoint_timeout")])
def test_replans_when_the_waypoint_generator_asks(drive, status, reason):
    navigator = drive()
    navigator.decide(at(0.0))
    navigator.waypoints.status = status
    decision = navigator.decide(at(1.0, 0.1))
    assert reasons(decision) == [("replan", reason)]
    assert decision.planned.poses[0, 0] == 1.0


def test_a_new_path_resets_the_waypoint_generator(drive):
    navigator = drive(rules=ReplanRules(0.1, False, None, 0.0, 0.0))
    before = navigator.waypoints.resets
    navigator.decide(at(0.0))
    navigator.global_planner.detour = 2.0
    navigator.decide(at(0.0, 0.1))
    assert navigator.waypoints.resets == before + 2


@pytest.mark.parametrize(("detour", "kept"), [(1.0, True), (1.2, True), (1.3, False), (math.inf, False)])
def test_a_periodic_plan_replaces_the_old_path_only_if_that_is_blocked_or_costs_notably_more(drive, detour, kept):
    navigator = drive(rules=ReplanRules(0.5, False, None, 0.0, 0.2))
    old = navigator.decide(at(0.0)).planned
    navigator.global_planner.detour = detour
    decision = navigator.decide(at(1.0, 0.5))
    assert reasons(decision) == [("replan", "period: little to gain, keeping the old one" if kept else "period")]
    assert (decision.planned is None) == kept
    assert (navigator.planner.seen[-1].path is old) == kept


def test_only_what_is_left_of_the_old_path_counts(drive):
    navigator = drive(rules=ReplanRules(0.5, False, None, 0.0, 0.2))
    navigator.decide(at(0.0))
    asked = []
    navigator.global_planner.cost = lambda grid, path: asked.append(path.poses[:, 0].copy()) or 1.0
    navigator.decide(at(1.04, 0.5))
    assert asked[0][0] == 1.04
    assert asked[0][1:].min() > 1.04
    assert asked[0][-1] == 3.0


def test_a_planner_that_prices_no_paths_goes_by_length_and_occupied_cells():
    class Plain(GlobalPlanner):
        def plan(self, grid, start, goal):
            raise NotImplementedError

    through_the_wall = straight_path(Pose(0.02, 0.0), Pose(20.02, 0.0))
    assert Plain().cost(room(), straight_path(Pose(0.0, 0.0), Pose(3.0, 0.0))) == pytest.approx(3.0)
    assert Plain().cost(room(), through_the_wall) == math.inf


def test_requests_are_ignored_where_the_rules_say_so(drive):
    navigator = drive(rules=ReplanRules(None, False, None, 0.0, 0.0))
    navigator.decide(at(0.0))
    navigator.waypoints.status = OFF_PATH
    assert not navigator.decide(at(0.0, 0.1)).events


def test_requests_wait_for_the_least_time_between_two_plans(drive):
    navigator = drive(rules=ReplanRules(None, True, None, 0.5, 0.0))
    planned = []
    for k in range(11):
        navigator.waypoints.status = OFF_PATH
        planned += [k for _ in navigator.decide(at(0.0, 0.1 * k)).events]
    assert planned == [0, 5, 10]


def block(navigator, x):
    """Put an obstacle on the path at ``x``."""
    costs = np.zeros_like(navigator.local_map.costmap.costs)
    window = navigator.local_map.costmap
    column = int((x - window.origin_xy[0]) / window.resolution)
    costs[:, column] = INSCRIBED
    navigator.local_map.costmap = replace(window, costs=costs)


def test_replans_on_what_the_scans_show_when_blocked_for_long_enough(drive):
    navigator = drive(rules=ReplanRules(None, False, 0.3, 0.0, 0.0))
    block(navigator, 2.0)
    replans = {k: reasons(d) for k in range(7) if (d := navigator.decide(at(0.0, 0.1 * k))).events}
    assert replans == {0: [("replan", "start")], 4: [("replan", "blocked")]}
    assert navigator.global_planner.grids[-1] is navigator.local_map.grid
    assert navigator.global_planner.grids[0] is navigator.mission.map


def test_marks_that_may_be_walls_are_left_out_only_where_there_is_no_other_way(drive):
    navigator = drive(rules=ReplanRules(None, False, 0.3, 0.0, 0.0))
    navigator.global_planner.closed = [navigator.local_map.grid]
    block(navigator, 2.0)
    decisions = [navigator.decide(at(0.0, 0.1 * k)) for k in range(7)]
    assert reasons(decisions[4]) == [("replan", "blocked")]
    assert [grid is navigator.local_map.lenient for grid in navigator.global_planner.grids] == [False, False, True]


def test_without_progress_the_navigator_clears_plans_anew_and_then_turns_itself(drive):
    rules = replace(NO_RECOVERIES, behaviours=["clear", "turn"])
    navigator = drive(recoveries=rules, answer=NoValidCommand("boxed in"))
    decisions = [navigator.decide(at(0.0, 0.1 * k)) for k in range(160)]
    told = [(round(e.stamp, 1), e.kind, e.detail) for d in decisions for e in d.events if e.kind != "no_valid_command"]
    assert told[:3] == [(0.0, "replan", "start"), (10.0, "recovery", "clear: no progress for 10.0 s"), (10.0, "replan", "recovery")]
    assert told[3:] == [(13.0, "recovery", "turn: no progress for 13.0 s"), (13.0, "replan", "recovery")]
    ((pose, beyond, asked_before),) = navigator.local_map.cleared
    assert (pose, beyond) == (Pose(0.0, 0.0), 0.0)
    assert navigator.local_map.asked > asked_before  # the scan of the same step is taken in after the marks are gone
    turning = [k for k, d in enumerate(decisions) if d.command.wz]
    assert turning == list(range(130, 160))
    assert decisions[129].command == BRAKE
    assert decisions[135].spent.planner == 0.0


def test_a_detour_is_planned_round_the_place_ahead_where_the_robot_stands_until_its_time_is_over(drive):
    rules = replace(NO_RECOVERIES, behaviours=["detour"], detour_time=20.0, retry_time=100.0)
    navigator = drive(rules=ReplanRules(5.0, False, None, 0.0, 0.0), recoveries=rules)
    for k in range(400):
        navigator.decide(at(0.0, 0.1 * k))
    occupied = [bool(grid.occupied[tuple(grid.cells((0.5, 0.0)))]) for grid in navigator.global_planner.grids]
    assert occupied == [False, False, True, True, True, True, False, False]  # every 5 s; the detour begins at 10 s
    assert not navigator.global_planner.grids[3].occupied[tuple(navigator.local_map.grid.cells((0.0, 0.0)))]


def test_where_a_detour_leaves_no_way_the_path_is_as_before(drive):
    rules = replace(NO_RECOVERIES, behaviours=["detour"])
    navigator = drive(recoveries=rules)
    navigator.global_planner.refuses_obstacles = True
    decisions = [navigator.decide(at(0.0, 0.1 * k)) for k in range(101)]
    assert reasons(decisions[100]) == [("recovery", "detour: no progress for 10.0 s"), ("replan", "recovery")]
    assert navigator.global_planner.grids[-1] is navigator.local_map.grid


def test_what_blocks_the_path_behind_the_robot_does_not_count(drive):
    navigator = drive(rules=ReplanRules(None, False, 0.3, 0.0, 0.0))
    navigator.decide(at(0.0))
    block(navigator, 0.5)
    assert not any(navigator.decide(at(1.0, 0.1 * k)).events for k in range(1, 12))


def test_a_path_that_is_free_again_in_time_is_kept(drive):
    navigator = drive(rules=ReplanRules(None, False, 0.3, 0.0, 0.0))
    navigator.decide(at(0.0))
    for k in range(1, 12):
        navigator.local_map.costmap = free_costmap(Pose(0.0, 0.0))
        if k % 3:
            block(navigator, 2.0)
        assert not navigator.decide(at(0.0, 0.1 * k)).events


def test_the_old_path_is_kept_when_there_is_no_new_one(drive):
    navigator = drive(rules=ReplanRules(0.5, False, None, 0.0, 0.0))
    path = navigator.decide(at(0.0)).planned
    navigator.global_planner.no_way = True
    decision = navigator.decide(at(0.2, 0.5))
    assert reasons(decision) == [("replan", "period: no path, keeping the old one")]
    assert decision.planned is None
    assert navigator.planner.seen[-1].path is path


def test_without_a_first_path_the_episode_cannot_begin(drive):
    navigator = drive()
    navigator.global_planner.no_way = True
    with pytest.raises(NoPath, match="walled in"):
        navigator.decide(at(0.0))


def test_in_an_unknown_world_plans_on_what_scans_have_shown_and_the_planner_gets_no_map(drive):
    navigator = drive(map=None)
    navigator.decide(at(0.0))
    assert navigator.global_planner.grids == [navigator.local_map.grid]
    assert navigator.local_map.asked == 1
    assert navigator.planner.seen[0].map is None


def test_a_planner_without_a_command_brakes_the_robot_and_that_is_an_event(drive):
    decision = drive(NoValidCommand("boxed in")).decide(at(0.0))
    assert decision.command == BRAKE
    assert reasons(decision)[-1] == ("no_valid_command", "boxed in")


@pytest.mark.parametrize(
    ("answer", "message"),
    [
        (Twist(math.nan), r"Says.compute_velocity returned Twist\(vx=nan"),
        (Twist(0.0, math.inf), r"allowed: finite numbers"),
        (Twist("fast"), r"allowed: finite numbers"),
        (Twist(None), r"allowed: finite numbers"),
        (None, r"returned NoneType; allowed: a Twist"),
        ((0.1, 0.0, 0.0), r"returned tuple; allowed: a Twist"),
        (np.zeros(3), r"returned ndarray; allowed: a Twist"),
    ],
)
def test_what_is_no_finite_twist_is_refused(drive, answer, message):
    with pytest.raises(InvalidCommand, match=message):
        drive(answer).decide(at(0.0))


def test_numpy_numbers_become_plain_ones(drive):
    command = drive(Twist(np.float32(0.5), np.int64(0), np.float64(0.25))).decide(at(0.0)).command
    assert command == Twist(0.5, 0.0, 0.25)
    assert {type(v) for v in (command.vx, command.vy, command.wz)} == {float}


def test_arrival_is_judged_on_the_estimate(drive):
    elsewhere = at(0.0, odometry=Odometry(0.0, Pose(2.8, 0.0), Twist(0.0)))
    decision = drive().decide(elsewhere)
    assert decision.arrived
    assert decision.command == BRAKE
    assert not drive().decide(at(2.6)).arrived


def test_commands_do_not_depend_on_the_reference_pose(drive):
    clean, poisoned = drive(lambda seen: Twist(seen.pose.x)), drive(lambda seen: Twist(seen.pose.x))
    nowhere = Pose(math.nan, math.nan, math.nan)
    for k in range(5):
        assert clean.command(at(0.1 * k, 0.1 * k)) == poisoned.command(at(0.1 * k, 0.1 * k, reference=nowhere))


def test_a_scan_is_taken_in_where_it_was_made(drive):
    navigator = drive(lambda seen: Twist(seen.local_map.resolution))
    turning = Odometry(1.0, Pose(1.0, 0.0, 0.5), Twist(1.0, 0.0, 0.0))
    view = at(1.0, 1.0, odometry=turning)
    navigator.decide(replace(view, scan=replace(view.scan, stamp=0.9)))
    (pose,) = navigator.local_map.poses
    assert (pose.x, pose.y, pose.theta) == pytest.approx((1.0 - 0.1 * math.cos(0.5), -0.1 * math.sin(0.5), 0.5))


def test_a_scan_made_while_turning_is_turned_back(drive):
    navigator = drive(lambda seen: Twist(seen.local_map.resolution))
    view = at(1.0, 1.0, odometry=Odometry(1.0, Pose(1.0, 0.0, 0.5), Twist(0.0, 0.0, 2.0)))
    navigator.decide(replace(view, scan=replace(view.scan, stamp=0.9)))
    assert navigator.local_map.poses[0].theta == pytest.approx(0.3)


def test_nothing_of_one_episode_is_kept_for_the_next(drive):
    navigator = drive()
    navigator.decide(at(0.0))
    navigator.reset(Mission(room(), Pose(0.0, 0.0), Pose(0.0, 3.0), 0.3, 7, "sample/1"))
    decision = navigator.decide(at(0.0))
    assert reasons(decision) == [("replan", "start")]
    assert decision.waypoint.y == 3.0


def test_a_planner_that_compiles_decides_once_for_nothing_before_its_first_episode_only(drive, monkeypatch):
    navigator = drive()
    navigator.rehearse(at(0.0))
    assert navigator.planner.seen == []
    monkeypatch.setattr(Says, "compiles", True)
    navigator = drive()
    navigator.rehearse(at(0.0))
    assert len(navigator.planner.seen) == 1
    assert reasons(navigator.decide(at(0.0))) == [("replan", "start")]
    navigator.reset(navigator.mission)
    navigator.rehearse(at(0.0))
    assert len(navigator.planner.seen) == 2


def test_what_goes_wrong_in_the_rehearsal_is_reported_in_the_episode():
    class Broken(Says):
        compiles = True

    navigator = Navigator(
        robot(), Odometer(), Straight(), Ahead(), Window(), Nobody(), Broken(RuntimeError("lost")), WHEN_ASKED, NO_RECOVERIES, 0.1
    )
    navigator.reset(Mission(room(), Pose(0.0, 0.0), GOAL, 0.3, 7, "sample/0"))
    navigator.rehearse(at(0.0))
    with pytest.raises(RuntimeError, match="lost"):
        navigator.decide(at(0.0))
