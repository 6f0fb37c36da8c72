"""When the navigator replans, and which path it then follows."""

import math
from dataclasses import replace

import pytest

from arena_core import GlobalPlanner, NoValidCommand, Pose
from arena_core.hosting import OFF_PATH, WAYPOINT_TIMEOUT
from arena_core.loop.guide import ReplanRules
from arena_core.loop.navigator import BRAKE
from arena_core.testing import free_costmap, room, straight_path
from tests.brain import NO_RECOVERIES, at, block, drive, reasons


def test_replans_every_period():
    navigator = drive(rules=ReplanRules(0.5, False, None, 0.0, 0.0))
    stamps = [k for k in range(21) if navigator.decide(at(0.0, 0.1 * k)).events]
    assert stamps == [0, 5, 10, 15, 20]


@pytest.mark.parametrize(("status", "reason"), [(OFF_PATH, "off_path"), (WAYPOINT_TIMEOUT, "waypoint_timeout")])
def test_replans_when_the_waypoint_generator_asks(status, reason):
    navigator = drive()
    navigator.decide(at(0.0))
    navigator.waypoints.status = status
    decision = navigator.decide(at(1.0, 0.1))
    assert reasons(decision) == [("replan", reason)]
    assert decision.planned.poses[0, 0] == 1.0


def test_a_new_path_resets_the_waypoint_generator():
    navigator = drive(rules=ReplanRules(0.1, False, None, 0.0, 0.0))
    before = navigator.waypoints.resets
    navigator.decide(at(0.0))
    navigator.global_planner.detour = 2.0
    navigator.decide(at(0.0, 0.1))
    assert navigator.waypoints.resets == before + 2


@pytest.mark.parametrize(("detour", "kept"), [(1.0, True), (1.2, True), (1.3, False), (math.inf, False)])
def test_a_periodic_plan_replaces_the_old_path_only_if_that_is_blocked_or_costs_notably_more(detour, kept):
    navigator = drive(rules=ReplanRules(0.5, False, None, 0.0, 0.2))
    navigator.decide(at(0.0))
    navigator.global_planner.detour = detour
    decision = navigator.decide(at(1.0, 0.5))
    assert reasons(decision) == [("replan", "period: little to gain, keeping the old one" if kept else "period")]
    assert (decision.planned is None) == kept
    assert (navigator.planner.seen[-1].path is navigator.planner.seen[0].path) == kept


def test_only_what_is_left_of_the_old_path_counts():
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


def test_requests_are_ignored_where_the_rules_say_so():
    navigator = drive(rules=ReplanRules(None, False, None, 0.0, 0.0))
    navigator.decide(at(0.0))
    navigator.waypoints.status = OFF_PATH
    assert not navigator.decide(at(0.0, 0.1)).events


def test_requests_wait_for_the_least_time_between_two_plans():
    navigator = drive(rules=ReplanRules(None, True, None, 0.5, 0.0))
    planned = []
    for k in range(11):
        navigator.waypoints.status = OFF_PATH
        planned += [k for _ in navigator.decide(at(0.0, 0.1 * k)).events]
    assert planned == [0, 5, 10]


def test_replans_on_what_the_scans_show_when_blocked_for_long_enough():
    navigator = drive(rules=ReplanRules(None, False, 0.3, 0.0, 0.0))
    block(navigator, 2.0)
    replans = {k: reasons(d) for k in range(7) if (d := navigator.decide(at(0.0, 0.1 * k))).events}
    assert replans == {0: [("replan", "start")], 4: [("replan", "blocked")]}
    assert navigator.global_planner.grids[-1] is navigator.local_map.grid
    assert navigator.global_planner.grids[0] is navigator.mission.map


def test_marks_that_may_be_walls_are_left_out_only_where_there_is_no_other_way():
    navigator = drive(rules=ReplanRules(None, False, 0.3, 0.0, 0.0))
    navigator.global_planner.closed = [navigator.local_map.grid]
    block(navigator, 2.0)
    decisions = [navigator.decide(at(0.0, 0.1 * k)) for k in range(7)]
    assert reasons(decisions[4]) == [("replan", "blocked")]
    assert [grid is navigator.local_map.lenient for grid in navigator.global_planner.grids] == [False, False, True]


def test_without_progress_the_navigator_clears_plans_anew_and_then_turns_itself():
    rules = replace(NO_RECOVERIES, behaviours=["clear", "turn"])
    navigator = drive(recoveries=rules, answer=NoValidCommand("boxed in"))
    decisions = [navigator.decide(at(0.0, 0.1 * k)) for k in range(160)]
    told = [(round(e.stamp, 1), e.kind, e.detail) for d in decisions for e in d.events if e.kind != "no_valid_command"]
    assert told[:3] == [
        (0.0, "replan", "start"),
        (10.0, "recovery", "clear: no progress for 10.0 s"),
        (10.0, "replan", "recovery"),
    ]
    assert told[3:] == [(13.0, "recovery", "turn: no progress for 13.0 s"), (13.0, "replan", "recovery")]
    ((pose, beyond, asked_before),) = navigator.local_map.cleared
    assert (pose, beyond) == (Pose(0.0, 0.0), 0.0)
    assert navigator.local_map.asked > asked_before  # the scan of the same step is taken in after the marks are gone
    turning = [k for k, d in enumerate(decisions) if d.command.wz]
    assert turning == list(range(130, 160))
    assert decisions[129].command == BRAKE
    assert decisions[135].spent.planner == 0.0


def test_a_detour_is_planned_round_the_place_ahead_where_the_robot_stands_until_its_time_is_over():
    rules = replace(NO_RECOVERIES, behaviours=["detour"], detour_time=20.0, retry_time=100.0)
    navigator = drive(rules=ReplanRules(5.0, False, None, 0.0, 0.0), recoveries=rules)
    for k in range(400):
        navigator.decide(at(0.0, 0.1 * k))
    occupied = [bool(grid.occupied[tuple(grid.cells((0.5, 0.0)))]) for grid in navigator.global_planner.grids]
    assert occupied == [False, False, True, True, True, True, False, False]  # every 5 s; the detour begins at 10 s
    assert not navigator.global_planner.grids[3].occupied[tuple(navigator.local_map.grid.cells((0.0, 0.0)))]


def test_where_a_detour_leaves_no_way_the_path_is_as_before():
    rules = replace(NO_RECOVERIES, behaviours=["detour"])
    navigator = drive(recoveries=rules)
    navigator.global_planner.refuses_obstacles = True
    decisions = [navigator.decide(at(0.0, 0.1 * k)) for k in range(101)]
    closed = "detour: no progress for 10.0 s; (0.50, 0.00) is closed for 60 s"
    assert reasons(decisions[100]) == [("recovery", closed), ("replan", "recovery")]
    assert navigator.global_planner.grids[-1] is navigator.local_map.grid


def test_what_blocks_the_path_behind_the_robot_does_not_count():
    navigator = drive(rules=ReplanRules(None, False, 0.3, 0.0, 0.0))
    navigator.decide(at(0.0))
    block(navigator, 0.5)
    assert not any(navigator.decide(at(1.0, 0.1 * k)).events for k in range(1, 12))


def test_a_path_that_is_free_again_in_time_is_kept():
    navigator = drive(rules=ReplanRules(None, False, 0.3, 0.0, 0.0))
    navigator.decide(at(0.0))
    for k in range(1, 12):
        navigator.local_map.costmap = free_costmap(Pose(0.0, 0.0))
        if k % 3:
            block(navigator, 2.0)
        assert not navigator.decide(at(0.0, 0.1 * k)).events


def test_the_old_path_is_kept_when_there_is_no_new_one():
    navigator = drive(rules=ReplanRules(0.5, False, None, 0.0, 0.0))
    navigator.decide(at(0.0))
    navigator.global_planner.no_way = True
    decision = navigator.decide(at(0.2, 0.5))
    assert reasons(decision) == [("replan", "period: no path, keeping the old one")]
    assert decision.planned is None
    assert navigator.planner.seen[-1].path is navigator.planner.seen[0].path
