import math
from dataclasses import replace

import numpy as np
import pytest

from arena_core import ConfigurationError, Pose, Twist
from arena_core.config.registry import load_registry
from arena_core.hosting import compose, to_plain
from arena_core.loop.recovery import STAND, Recoveries, RecoveryRules, count_touched, footprint_points
from arena_core.runs.jobs.benchmark import build_benchmark
from arena_core.testing import free_costmap, robot
from arena_core.values.world import LETHAL

RULES = RecoveryRules(
    ["clear", "clear_far", "turn", "back_up", "wait"],
    0.5,
    10.0,
    3.0,
    3.0,
    5.0,
    1.5,
    1.0,
    0.3,
    0.15,
    0.5,
    0.4,
    60.0,
    0.3,
    2.0,
    None,
    None,
)
HERE, AHEAD = Pose(0.0, 0.0, 0.0), Pose(0.0, 2.0)  # the waypoint is to the left
PERIOD = 0.1


def only(*behaviours, body=None, **changes):
    return Recoveries(replace(RULES, behaviours=list(behaviours), **changes), body or robot())


def window(pose=HERE, blocked_xy=()):
    """Return the local map around a pose, with cells at these places occupied."""
    costmap = free_costmap(pose)
    for position in blocked_xy:
        column, row = np.floor((np.array(position) - costmap.origin_xy) / costmap.resolution).astype(int)
        costmap.costs[row, column] = LETHAL
    return costmap


def stand(recoveries, seconds, pose=HERE):
    """Let the robot stand and return what began: (stamp, behaviour)."""
    begun = [(0.1 * k, recoveries.begin(pose, 0.1 * k)) for k in range(round(seconds / PERIOD) + 1)]
    return [(round(stamp, 1), b.event.detail.split(":")[0], b.clear_beyond) for stamp, b in begun if b is not None]


def drive(recoveries, costmap=None, begin=10.0):
    """Do what the behaviour that is due commands, exactly, and return the poses."""
    pose, poses = HERE, [HERE]
    recoveries.begin(pose, 0.0)
    assert recoveries.begin(pose, begin) is not None
    for k in range(200):
        command = recoveries.command(pose, begin + PERIOD * k, lambda: costmap or window(), AHEAD)
        if command is None:
            return poses
        pose = pose.compose(Pose(command.vx * PERIOD, 0.0, command.wz * PERIOD))
        poses.append(pose)
    raise AssertionError("the behaviour never ended")


def test_behaviours_are_tried_in_turn_while_the_robot_stays_where_it_is():
    assert stand(only("clear", "clear_far"), 17.0) == [
        (10.0, "clear", 0.0),
        (13.0, "clear_far", 3.0),
        (16.0, "clear", 0.0),
    ]


def test_progress_begins_the_list_anew():
    recoveries = only("clear", "clear_far")
    assert [b[1] for b in stand(recoveries, 10.0)] == ["clear"]
    assert recoveries.begin(Pose(0.6, 0.0), 10.5) is None
    assert recoveries.begin(Pose(0.7, 0.0), 20.4) is None
    assert recoveries.begin(Pose(0.7, 0.0), 20.5).event.detail == "clear: no progress for 10.0 s"


def test_a_robot_that_drives_on_needs_none():
    recoveries = only("clear")
    assert all(recoveries.begin(Pose(0.06 * k, 0.0), 1.0 * k) is None for k in range(100))


def test_no_behaviours_mean_no_recoveries():
    assert stand(only(), 60.0) == []


def test_wait_stands_for_its_time():
    recoveries = only("wait")
    poses = drive(recoveries)
    assert len(poses) - 1 == pytest.approx(50)
    assert all(pose == HERE for pose in poses)


def test_turn_turns_to_the_waypoints_side_by_its_angle():
    assert drive(only("turn"))[-1].theta == pytest.approx(1.5, abs=0.11)
    recoveries = only("turn")
    recoveries.begin(HERE, 0.0)
    recoveries.begin(HERE, 10.0)
    assert recoveries.command(HERE, 10.0, window, Pose(0.0, -2.0)).wz == -1.0


def test_a_turn_keeps_its_side_though_the_waypoint_moves():
    recoveries = only("turn")
    recoveries.begin(HERE, 0.0)
    recoveries.begin(HERE, 10.0)
    assert [
        recoveries.command(HERE, 10.0 + PERIOD * k, window, Pose(0.0, y)).wz for k, y in enumerate((2.0, -2.0))
    ] == [1.0, 1.0]


def test_a_whole_turn_is_possible():
    poses = drive(only("turn", turn_angle=2.0 * math.pi))
    assert len(poses) - 1 == pytest.approx(2.0 * math.pi / PERIOD, abs=2)


def test_back_up_goes_back_its_distance():
    assert drive(only("back_up"))[-1].x == pytest.approx(-0.3, abs=0.016)


def test_back_up_stops_before_what_stands_behind():
    poses = drive(only("back_up"), window(blocked_xy=[(-0.33, 0.0)]))
    assert -0.12 < poses[-1].x < -0.02


def test_a_robot_that_touches_something_may_back_away_from_it():
    poses = drive(only("back_up"), window(blocked_xy=[(0.18, 0.0)]))
    assert poses[-1].x == pytest.approx(-0.3, abs=0.016)


def test_cars_do_not_turn_on_the_spot():
    assert [b[1] for b in stand(only("turn", "clear", body=robot("ackermann")), 10.0)] == ["clear"]


def test_a_new_episode_begins_without_a_past():
    recoveries = only("wait")
    stand(recoveries, 10.0)
    recoveries.reset()
    assert recoveries.command(HERE, 0.0, window, AHEAD) is None
    assert stand(recoveries, 9.9) == []


def test_standing_is_braking():
    assert STAND.array().tolist() == [0.0, 0.0, 0.0]


@pytest.mark.parametrize("shape", ["circle", "polygon"])
def test_the_body_is_tried_out_to_the_footprints_outline(shape):
    footprint = robot().footprint if shape == "circle" else robot("ackermann").footprint
    points = footprint_points(footprint)
    assert np.hypot(*points.T).max() == pytest.approx(footprint.radius)
    assert count_touched(window(), points, HERE) == 0


def composed(*overrides):
    return to_plain(
        compose(["planner=pure_pursuit", "world=empty", "pedestrians=none", "localizer=ground_truth", *overrides])
    )


def test_a_planners_own_rules_take_the_place_of_the_runs_key_by_key():
    config = composed(
        "replan.gain=0.3",
        "+planner.replan={period: 1.0}",
        "+planner.recoveries={behaviours: []}",
        "+planner.control_period=0.05",
    )
    navigator = build_benchmark(config, load_registry()).navigator
    assert (navigator.replan.period, navigator.replan.gain, navigator.control_period) == (1.0, 0.3, 0.05)
    assert stand(navigator.recoveries, 30.0) == []


@pytest.mark.parametrize(
    ("override", "words"),
    [
        ("+planner.replan={perod: 1.0}", "planner.replan has no parameter perod"),
        ("+planner.recoveries=3", "planner.recoveries is 3; allowed: a mapping"),
        ("+planner.recoveries={behaviours: [dance]}", "recoveries.behaviours[0] is 'dance'; allowed: one of clear"),
        ("recoveries.progress_time=0", "recoveries.progress_time is 0"),
    ],
)
def test_wrong_rules_are_one_line(override, words):
    with pytest.raises(ConfigurationError) as error:
        build_benchmark(composed(override), load_registry())
    assert words in str(error.value)
    assert "\n" not in str(error.value)


def test_drive_on_turns_to_the_waypoint_first_and_then_drives_its_distance():
    poses = drive(only("drive_on"))
    turned = next(k for k, pose in enumerate(poses) if pose.distance(HERE) > 1e-9)
    assert poses[turned - 1].theta > 1.0  # the waypoint is to the left
    assert poses[-1].distance(HERE) == pytest.approx(RULES.drive_on_distance, abs=0.02)
    assert poses[-1].y > 0.25


def test_drive_on_stops_before_a_wall():
    wall = window(blocked_xy=[(x, 0.45) for x in np.arange(-0.5, 0.5, 0.05)])
    assert 0.1 < drive(only("drive_on"), wall)[-1].y < RULES.drive_on_distance - 0.05


def circling(recoveries, radius, seconds):
    """Let the robot drive in a circle at 0.5 m/s; return what began: (stamp, what its event says)."""
    angles = [0.05 * k / radius for k in range(round(seconds / PERIOD) + 1)]
    begun = [
        (0.1 * k, recoveries.begin(Pose(radius * math.cos(a), radius * math.sin(a)), 0.1 * k))
        for k, a in enumerate(angles)
    ]
    return [(round(stamp, 1), b.event.detail) for stamp, b in begun if b is not None]


def test_robot_that_drives_in_circles_tries_the_behaviours_in_turn():
    said = circling(only("clear", "detour", circle_time=30.0), 0.7, 45.0)
    assert said == [(30.0, "clear: drives in circles"), (40.0, "detour: drives in circles")]


@pytest.mark.parametrize(("radius", "circle_time"), [(0.7, None), (2.1, 30.0)])
def test_robot_that_drives_in_wide_circles_or_may_do_so_is_left_alone(radius, circle_time):
    assert circling(only("clear", circle_time=circle_time), radius, 100.0) == []


def leaning(recoveries, seconds, touches=True):
    """Let the robot stand and touch something; return what began: (stamp, what its event says)."""
    begun = [(0.1 * k, recoveries.begin(HERE, 0.1 * k, lambda: touches)) for k in range(round(seconds / PERIOD) + 1)]
    return [(round(stamp, 1), b.event.detail) for stamp, b in begun if b is not None]


def test_robot_that_leans_on_something_moves_off_at_once():
    assert leaning(only("clear", "back_up", lean_time=3.0), 4.0) == [(3.0, "back_up: leans on something")]


@pytest.mark.parametrize(
    ("behaviours", "lean_time", "touches"),
    [(("back_up",), None, True), (("back_up",), 3.0, False), (("clear",), 3.0, True)],
)
def test_robot_that_does_not_lean_or_may_not_move_waits_for_its_turn(behaviours, lean_time, touches):
    assert leaning(only(*behaviours, lean_time=lean_time), 9.0, touches) == []


def held(recoveries, command, seconds, drives=0.0, touches=False):
    """Let a robot stand that is told to drive, by its planner or a behaviour; return what began, and what it was told.

    It obeys the first ``drives`` m, and ``touches`` something or does not.
    """
    begun, told, pose, moved = [], [], HERE, 0.0
    for k in range(round(seconds / PERIOD) + 1):
        start = recoveries.begin(pose, PERIOD * k, lambda: touches)
        if start is not None:
            begun.append((round(PERIOD * k, 1), start.event.detail))
        told.append(recoveries.command(pose, PERIOD * k, window, AHEAD) or command)
        recoveries.tell(told[-1])
        if moved < drives:
            moved += abs(told[-1].vx) * PERIOD
            pose = pose.compose(Pose(told[-1].vx * PERIOD, 0.0, 0.0))
    return begun, told


BACK = Twist(-0.2)


def test_robot_that_is_told_to_drive_backwards_and_stands_drives_on_straight():
    begun, told = held(only("back_up", lean_time=3.0), BACK, 3.4)
    assert begun == [(3.0, "drive_on: its commands move nothing")]
    assert told[-1] == Twist(RULES.back_up_speed)


def test_robot_that_is_told_to_drive_forwards_and_stands_backs_up():
    assert held(only("turn", "back_up", lean_time=3.0), Twist(0.2), 3.4)[0] == [
        (3.0, "back_up: its commands move nothing")
    ]


def test_back_up_that_moves_nothing_is_followed_by_drive_on_at_once():
    begun, told = held(only("back_up", lean_time=3.0), STAND, 11.4)
    assert begun == [(10.0, "back_up: no progress for 10.0 s"), (11.0, "drive_on: back_up moved nothing")]
    assert told[-1] == Twist(RULES.back_up_speed)


def test_back_up_out_of_a_lean_that_moves_nothing_is_followed_by_drive_on_at_once():
    begun, told = held(only("back_up", lean_time=3.0), STAND, 4.4, touches=True)
    assert begun == [(3.0, "back_up: leans on something"), (4.0, "drive_on: back_up moved nothing")]
    assert told[-1] == Twist(RULES.back_up_speed)


def test_back_up_that_moves_ends_as_ever():
    begun, _ = held(only("back_up", lean_time=3.0), STAND, 12.5, drives=1.0)
    assert begun == [(10.0, "back_up: no progress for 10.0 s")]


@pytest.mark.parametrize(
    ("command", "lean_time", "behaviours"),
    [
        (STAND, 3.0, ("back_up",)),  # told to stand
        (Twist(-0.02), 3.0, ("back_up",)),  # so slowly that it cannot be told from standing yet
        (BACK, None, ("back_up",)),
        (BACK, 3.0, ("clear",)),
    ],
)
def test_robot_that_is_not_held_or_may_not_move_is_left_alone(command, lean_time, behaviours):
    assert held(only(*behaviours, lean_time=lean_time), command, 6.0)[0] == []


def test_robot_that_turns_on_the_spot_as_told_is_not_held():
    recoveries = only("back_up", "turn", lean_time=3.0)
    for k in range(90):
        assert recoveries.begin(Pose(0.0, 0.0, 0.1 * k), PERIOD * k) is None
        recoveries.tell(Twist(0.0, 0.0, 1.0))


def test_robot_that_is_told_to_turn_and_does_not_is_held():
    begun, _ = held(only("back_up", "turn", lean_time=3.0), Twist(0.0, 0.0, 1.0), 3.0)
    assert begun == [(3.0, "drive_on: its commands move nothing")]


def creep(recoveries, speed, share, seconds=9.0):
    """Tell a robot that touches something to drive so slowly (m/s), and let it get on by this share of it."""
    begun = []
    for k in range(round(seconds / PERIOD) + 1):
        begun.append(recoveries.begin(Pose(share * speed * PERIOD * k, 0.0), PERIOD * k, lambda: True))
        recoveries.tell(Twist(speed))
    return [one.event.detail for one in begun if one is not None]


@pytest.mark.parametrize("speed", [0.008, 0.02, 0.03, -0.02])
def test_robot_that_creeps_beside_something_as_it_is_told_does_not_lean_on_it(speed):
    assert creep(only("back_up", lean_time=3.0), speed, 1.0) == []
    assert creep(only("back_up", lean_time=3.0), speed, 0.8) == []


@pytest.mark.parametrize(("speed", "share"), [(0.02, 0.0), (0.03, 0.2), (0.002, 1.0)])
def test_robot_that_gets_on_far_less_than_it_is_told_or_hardly_at_all_leans(speed, share):
    assert creep(only("back_up", lean_time=3.0), speed, share, 3.0) == ["back_up: leans on something"]


BEHIND = [(-0.24, y) for y in np.arange(-0.1, 0.1, 0.04)]  # a wall just behind the robot


def pinched(recoveries, seconds, blocked_xy, waypoint=AHEAD):
    """Let a robot touch something until it has got 5 cm away, told to stand; its recoveries move it, as far as the map
    lets them.

    Return what began: (stamp, what its event says).
    """
    begun, pose = [], HERE
    for k in range(round(seconds / PERIOD) + 1):
        start = recoveries.begin(pose, PERIOD * k, lambda here=pose: here.distance(HERE) < 0.05)
        if start is not None:
            begun.append((round(PERIOD * k, 1), start.event.detail))
        command = recoveries.command(pose, PERIOD * k, lambda: window(blocked_xy=blocked_xy), waypoint) or STAND
        recoveries.tell(command)
        pose = pose.compose(Pose(PERIOD * command.vx, 0.0, PERIOD * command.wz))
    return begun


def test_back_up_out_of_a_lean_that_the_map_refuses_is_followed_by_the_next_at_once():
    assert pinched(only("detour", "back_up", "drive_on", lean_time=3.0), 4.5, BEHIND) == [
        (3.0, "back_up: leans on something"),
        (3.1, "drive_on: back_up moved nothing"),
    ]


def test_robot_that_leans_drives_on_at_last_though_its_list_does_not_say_so():
    assert pinched(only("clear", "back_up", lean_time=3.0), 4.5, BEHIND)[1:] == [
        (3.1, "drive_on: back_up moved nothing")
    ]


def test_robot_that_no_behaviour_moves_tries_them_all_ever_more_rarely():
    between = [*BEHIND, *((-x, y) for x, y in BEHIND)]
    begun = pinched(only("back_up", lean_time=3.0, retry_time=60.0), 12.0, between, Pose(2.0, 0.0))
    once = ["back_up: leans on something", "drive_on: back_up moved nothing", "drive_on: drive_on moved nothing"]
    assert [detail for _, detail in begun] == 4 * [*once, "back_up: drive_on moved nothing"]
    stamps = [stamp for stamp, _ in begun]
    pauses = np.array(stamps[4::4]) - stamps[3:-1:4]  # what straight back takes, then 1 s, 2 s and lean_time
    assert pauses - (1.0, 2.0, 3.0) == pytest.approx(np.full(3, pauses[0] - 1.0))
    assert 0.0 < pauses[0] - 1.0 < 0.5


def test_what_frees_a_robot_from_what_it_does_not_see_and_moves_nothing_is_followed_by_the_next():
    begun, _ = held(only("back_up", "turn", lean_time=3.0), STAND, 5.9, touches=True)
    assert begun == [
        (3.0, "back_up: leans on something"),
        (4.0, "drive_on: back_up moved nothing"),
        (5.0, "turn: drive_on moved nothing"),
    ]


@pytest.mark.parametrize(("touches", "due"), [(False, ["wait", "back_up"]), (True, ["back_up"])])
def test_robot_that_leans_does_not_wait(touches, due):
    recoveries = only("wait", "back_up", progress_time=2.0, lean_time=3.0)
    begun = []
    for k in range(120):
        start = recoveries.begin(HERE, PERIOD * k, lambda: touches)
        begun += [] if start is None else [start.behaviour]
        recoveries.tell(recoveries.command(HERE, PERIOD * k, window, AHEAD) or STAND)
    assert begun[: len(due)] == due


def test_outline_touches_what_a_scan_marks_half_a_cell_behind_it():
    recoveries = only("back_up")
    radius = robot().footprint.radius
    assert recoveries.touches(window(blocked_xy=[(radius + 0.01, 0.0)]), HERE)
    assert not recoveries.touches(window(blocked_xy=[(radius + 0.15, 0.0)]), HERE)
