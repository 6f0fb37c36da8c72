import math
from dataclasses import replace

import numpy as np
import pytest

from arena_core import InvalidCommand, NoPath, NoValidCommand, Odometry, Pose, Twist
from arena_core.base import stopwatch
from arena_core.base.pulse import pulse
from arena_core.loop.guide import GuideParts, Mission
from arena_core.loop.navigator import BRAKE, Navigator
from arena_core.testing import robot, room
from tests.brain import (
    GOAL,
    NO_RECOVERIES,
    WHEN_ASKED,
    Ahead,
    Nobody,
    Odometer,
    Says,
    Straight,
    Window,
    at,
    drive,
    reasons,
)


def test_the_first_step_plans_and_later_ones_keep_the_path():
    navigator = drive()
    first = navigator.decide(at(0.0))
    assert reasons(first) == [("replan", "start")]
    assert first.planned.length == pytest.approx(3.0)
    later = [navigator.decide(at(0.1 * k, 0.1 * k)) for k in range(1, 20)]
    assert all(not d.events and d.planned is None for d in later)


def test_the_planner_sees_estimate_goal_waypoint_path_map_and_what_was_measured():
    navigator = drive()
    view = at(0.5, 0.2)
    navigator.decide(view)
    (seen,) = navigator.planner.seen
    assert (seen.stamp, seen.pose, seen.goal, seen.waypoint) == (0.2, Pose(0.5, 0.0), GOAL, Pose(3.0, 0.0))
    assert np.array_equal(seen.scan.ranges, view.scan.ranges)
    assert (seen.scan.stamp, seen.scan.mount) == (view.scan.stamp, view.scan.mount)
    assert seen.path.poses[0].tolist() == [0.5, 0.0, 0.0]
    assert np.array_equal(seen.map.data, navigator.mission.map.data)


def test_the_planner_is_told_map_goal_period_and_a_stream_of_its_own():
    told = drive().planner.started
    assert (told.goal, told.control_period) == (GOAL, 0.1)
    assert told.random.random() == drive().planner.started.random.random()


def test_local_map_and_tracks_are_computed_only_when_asked_for_and_once():
    lazy = drive()
    lazy.decide(at(0.0))
    assert lazy.local_map.asked == 0
    eager = drive(lambda seen: Twist(float(seen.local_map is seen.local_map and seen.tracks is seen.tracks)))
    assert eager.decide(at(0.0)).command.vx == 1.0
    assert eager.local_map.asked == 1


def test_without_a_first_path_the_episode_cannot_begin():
    navigator = drive()
    navigator.global_planner.no_way = True
    with pytest.raises(NoPath, match="walled in"):
        navigator.decide(at(0.0))


def test_in_an_unknown_world_plans_on_what_scans_have_shown_and_the_planner_gets_no_map():
    navigator = drive(map=None)
    navigator.decide(at(0.0))
    assert navigator.global_planner.grids == [navigator.local_map.grid]
    assert navigator.local_map.asked == 1
    assert navigator.planner.seen[0].map is None


def test_a_planner_without_a_command_brakes_the_robot_and_that_is_an_event():
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
def test_what_is_no_finite_twist_is_refused(answer, message):
    with pytest.raises(InvalidCommand, match=message):
        drive(answer).decide(at(0.0))


def test_numpy_numbers_become_plain_ones():
    command = drive(Twist(np.float32(0.5), np.int64(0), np.float64(0.25))).decide(at(0.0)).command
    assert command == Twist(0.5, 0.0, 0.25)
    assert {type(v) for v in (command.vx, command.vy, command.wz)} == {float}


def test_arrival_is_judged_on_the_estimate():
    elsewhere = at(0.0, odometry=Odometry(0.0, Pose(2.8, 0.0), Twist(0.0)))
    decision = drive().decide(elsewhere)
    assert decision.arrived
    assert decision.command == BRAKE
    assert not drive().decide(at(2.6)).arrived


def test_commands_do_not_depend_on_the_reference_pose():
    clean, poisoned = drive(lambda seen: Twist(seen.pose.x)), drive(lambda seen: Twist(seen.pose.x))
    nowhere = Pose(math.nan, math.nan, math.nan)
    for k in range(5):
        assert clean.command(at(0.1 * k, 0.1 * k)) == poisoned.command(at(0.1 * k, 0.1 * k, reference=nowhere))


def test_a_scan_is_taken_in_where_it_was_made():
    navigator = drive(lambda seen: Twist(seen.local_map.resolution))
    turning = Odometry(1.0, Pose(1.0, 0.0, 0.5), Twist(1.0, 0.0, 0.0))
    view = at(1.0, 1.0, odometry=turning)
    navigator.decide(replace(view, scan=replace(view.scan, stamp=0.9)))
    (pose,) = navigator.local_map.poses
    assert (pose.x, pose.y, pose.theta) == pytest.approx((1.0 - 0.1 * math.cos(0.5), -0.1 * math.sin(0.5), 0.5))


def test_a_scan_made_while_turning_is_turned_back():
    navigator = drive(lambda seen: Twist(seen.local_map.resolution))
    view = at(1.0, 1.0, odometry=Odometry(1.0, Pose(1.0, 0.0, 0.5), Twist(0.0, 0.0, 2.0)))
    navigator.decide(replace(view, scan=replace(view.scan, stamp=0.9)))
    assert navigator.local_map.poses[0].theta == pytest.approx(0.3)


def test_nothing_of_one_episode_is_kept_for_the_next():
    navigator = drive()
    navigator.decide(at(0.0))
    navigator.reset(Mission(room(), Pose(0.0, 0.0), Pose(0.0, 3.0), 0.3, 7, "sample/1"))
    decision = navigator.decide(at(0.0))
    assert reasons(decision) == [("replan", "start")]
    assert decision.waypoint.y == 3.0


def test_a_planner_that_compiles_decides_once_for_nothing_before_its_first_episode_only(monkeypatch):
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
        GuideParts(robot(), Odometer(), Straight(), Ahead(), Window(), Nobody()),
        Broken(RuntimeError("lost")),
        WHEN_ASKED,
        NO_RECOVERIES,
        0.1,
    )
    navigator.reset(Mission(room(), Pose(0.0, 0.0), GOAL, 0.3, 7, "sample/0"))
    navigator.rehearse(at(0.0))
    with pytest.raises(RuntimeError, match="lost"):
        navigator.decide(at(0.0))


def test_local_map_and_tracker_count_apart_also_where_the_planner_asks_for_them(monkeypatch):
    time = [0.0]
    monkeypatch.setattr(stopwatch, "_current_time", lambda: stopwatch.Duration(time[0], 3.0 * time[0]))

    def lasting(seconds, answer):
        time[0] += seconds
        return answer

    def answer(observation):
        assert observation.local_map is not None
        assert len(observation.tracks.ids) == 0
        return lasting(1.0, Twist(0.1))

    navigator = drive(answer=answer)
    update, track = navigator.local_map.update, navigator.tracker.update
    navigator.local_map.update = lambda *given: lasting(10.0, update(*given))
    navigator.tracker.update = lambda *given: lasting(100.0, track(*given))
    spent = navigator.decide(at(0.0, 0.0)).spent
    assert (spent.planner, spent.local_map, spent.tracker, spent.navigator) == (1.0, 10.0, 100.0, 111.0)
    assert (spent.planner_cpu, spent.local_map_cpu, spent.tracker_cpu, spent.navigator_cpu) == (3.0, 30.0, 300.0, 333.0)


def test_a_decision_that_waited_for_a_compiler_says_so():
    def compiling(seen):
        if seen.stamp == 0.1:
            pulse.compile()  # as numba's listener does
        return Twist(0.1)

    navigator = drive(compiling)
    assert [navigator.decide(at(0.0, 0.1 * k)).compiled for k in range(3)] == [False, True, False]


def test_what_nobody_asks_for_takes_no_time():
    spent = drive(answer=Twist(0.1)).decide(at(0.0, 0.0)).spent
    assert (spent.local_map, spent.tracker) == (0.0, 0.0)
    assert 0.0 < spent.planner < spent.navigator
