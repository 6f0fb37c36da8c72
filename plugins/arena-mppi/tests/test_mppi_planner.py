import math
import subprocess
import sys

import numpy as np
import pytest

from arena_core import NO_TRACKS, ConfigurationError, EpisodeStart, NoValidCommand, Pose, Tracks, Twist

AHEAD = [(0.1 * k, 0.0) for k in range(40)]


def drive(
    planner, costmap, observe, pose, path, steps, tracks=lambda time: NO_TRACKS, twist=None, done=lambda pose: False
):
    """Return the poses of a robot that does exactly what it is told, within its accelerations,
    for control periods of 0.1 s.
    """
    poses, twist = [pose], twist or Twist(0.0)
    for k in range(steps):
        try:
            twist = planner.compute_velocity(observe(costmap, pose, path, twist, 0.1 * k, tracks(0.1 * k)))
        except NoValidCommand:
            twist = Twist(0.0)
        turn = twist.wz * 0.1
        middle = Pose(0.0, 0.0, 0.5 * turn).compose(Pose(twist.vx * 0.1, twist.vy * 0.1))
        pose = pose.compose(Pose(middle.x, middle.y, turn))
        poses.append(pose)
        if done(pose):
            break
    return poses


@pytest.mark.parametrize("robot", ["turtlebot3", "jackal", "robotino", "jackal_ackermann", "stranger"])
def test_every_robot_drives_a_free_path_to_its_goal(robot, build, costmap, observe):
    path, goal = [(-2.0 + 0.1 * k, 0.0) for k in range(36)], Pose(1.5, 0.0)
    poses = drive(
        build(robot), costmap(), observe, Pose(-2.0, 0.0, 0.4), path, 250, done=lambda pose: pose.distance(goal) < 0.3
    )
    assert poses[-1].distance(goal) < 0.3


@pytest.mark.parametrize("robot", ["jackal", "robotino", "stranger"])
def test_as_nav2_drives_a_free_path_to_its_goal(robot, build, costmap, observe):
    path, goal = [(-2.0 + 0.1 * k, 0.0) for k in range(36)], Pose(1.5, 0.0)
    planner = build(robot, "mppi_as_nav2")
    assert (
        drive(
            planner, costmap(), observe, Pose(-2.0, 0.0, 0.4), path, 150, done=lambda pose: pose.distance(goal) < 0.3
        )[-1].distance(goal)
        < 0.3
    )


def test_as_nav2_predicts_nobody(build, costmap, observe, people):
    tracks, planners = people((1.0, 0.0, -1.0, 0.0)), [build("jackal", "mppi_as_nav2") for _ in range(2)]
    commands = [
        planner.compute_velocity(observe(costmap(), Pose(0.0, 0.0), AHEAD, tracks=seen))
        for planner, seen in zip(planners, (tracks, NO_TRACKS), strict=True)
    ]
    assert commands[0] == commands[1]


def test_free_straight_path_is_driven_near_full_speed(build, costmap, observe):
    planner, twist = build(), Twist(0.2)
    for k in range(5):
        twist = planner.compute_velocity(observe(costmap(), Pose(0.02 * k, 0.0), AHEAD, twist, 0.1 * k))
    assert twist.vx > 0.9 * 0.22
    assert abs(twist.wz) < 0.5


def test_robot_turns_towards_a_path_behind_it(build, costmap, observe):
    poses = drive(build(), costmap(), observe, Pose(0.0, 0.0), [(-x, y) for x, y in AHEAD], 60)
    assert poses[-1].x < -0.1
    assert math.cos(poses[-1].theta) < -0.8


def test_obstacle_on_the_path_is_gone_round(build, costmap, observe):
    path, goal = [(-2.0 + 0.1 * k, 0.0) for k in range(41)], Pose(2.0, 0.0)
    box = costmap((-0.2, 0.2, -0.3, 0.4))
    poses = drive(build("jackal"), box, observe, Pose(-2.0, 0.0), path, 80, done=lambda pose: pose.distance(goal) < 0.3)
    assert poses[-1].distance(goal) < 0.3
    cells = [np.floor((np.array((p.y, p.x)) - box.origin_xy[::-1]) / 0.05).astype(int) for p in poses]
    assert min(box.distance[tuple(cell)] for cell in cells) > 0.165


def test_robot_stops_before_a_wall_that_closes_the_way(build, costmap, observe):
    poses = drive(build(), costmap((1.0, 1.2, -3.0, 3.0)), observe, Pose(0.0, 0.0), AHEAD, 100)
    assert 0.3 < max(p.x for p in poses) < 1.0 - 0.113


def test_robot_that_stands_too_near_to_a_wall_drives_away(build, costmap, observe):
    wall = costmap((0.1, 0.3, -3.0, 3.0))
    path = [(-0.1 * k, 0.0) for k in range(20)]
    assert drive(build(), wall, observe, Pose(0.0, 0.0, math.pi), path, 40)[-1].x < -0.3


def test_no_valid_command_when_every_roll_out_collides(build, costmap, observe):
    with pytest.raises(NoValidCommand, match="mppi: every roll-out collides before"):
        build("jackal").compute_velocity(observe(costmap((0.35, 0.6, -3.0, 3.0)), Pose(0.0, 0.0), AHEAD, Twist(2.0)))


def test_person_who_walks_towards_the_robot_is_let_past(build, costmap, observe, people):
    """The robot is slower than the person: only what the tracker predicts lets it clear the way in time."""

    def walker(time):
        return people((2.0 - 0.5 * time, 0.0, -0.5, 0.0))

    gaps = [
        min(pose.distance(Pose(2.0 - 0.05 * k, 0.0)) for k, pose in enumerate(poses)) - 0.413
        for poses in (
            drive(build(), costmap(), observe, Pose(0.0, 0.0), AHEAD, 70, tracks)
            for tracks in (walker, lambda time: NO_TRACKS)
        )
    ]
    assert gaps[0] > 0.05
    assert gaps[1] < 0.0


def test_cells_of_a_moving_person_do_not_stand_in_the_way(build, costmap, observe, people):
    """A person who walks ahead of the robot in a narrow aisle is followed, though the local map
    shows a body that fills it.
    """
    aisle = costmap((-3.0, 3.0, 0.4, 0.5), (-3.0, 3.0, -0.5, -0.4), (0.95, 1.45, -0.3, 0.3))
    speeds = []
    for tracks in (people((1.2, 0.0, 1.2, 0.0)), NO_TRACKS):
        planner, view = (
            build("jackal"),
            [observe(aisle, Pose(0.0, 0.0), AHEAD, Twist(1.0), 0.1 * k, tracks) for k in range(3)],
        )
        speeds.append([planner.compute_velocity(seen).vx for seen in view][-1])
    assert speeds[0] > 0.8
    assert speeds[1] < 0.6


def test_holonomic_robot_strafes_where_that_is_useful(build, costmap, observe):
    command = build("robotino").compute_velocity(
        observe(costmap(), Pose(0.0, 0.0), [(0.0, 0.1 * k) for k in range(20)])
    )
    assert command.vy > abs(command.vx)


def test_car_is_never_told_to_turn_tighter_than_it_can(build, costmap, observe):
    planner, pose, twist = build("jackal_ackermann"), Pose(0.0, 0.0), Twist(0.0)
    for k in range(30):
        twist = planner.compute_velocity(observe(costmap(), pose, [(-x, y) for x, y in AHEAD], twist, 0.1 * k))
        assert abs(twist.wz) <= abs(twist.vx) * math.tan(0.5) / 0.262 + 1e-4
        pose = pose.compose(Pose(twist.vx * 0.1, 0.0, twist.wz * 0.1))


@pytest.mark.parametrize("period", [0.03, 0.05, 0.1, 0.13])
def test_commands_keep_the_acceleration_limits_whatever_the_control_period(period, build, costmap, observe):
    planner, twist = build("stranger", period=period), Twist(0.0)
    for k in range(8):
        command = planner.compute_velocity(observe(costmap(), Pose(0.0, 0.0), AHEAD, twist, period * k))
        assert abs(command.vx - twist.vx) <= 0.8 * period * 1.3 + 1e-4
        twist = command
    assert twist.vx > 0.5 * 0.8 * period * 8


@pytest.mark.parametrize("path", [[], [(math.nan, 0.0), (1.0, 0.0)]])
def test_path_without_sense_gives_no_valid_command(path, build, costmap, observe):
    with pytest.raises(NoValidCommand, match="mppi"):
        build().compute_velocity(observe(costmap(), Pose(0.0, 0.0), path))


def test_path_of_one_pose_is_driven_to(build, costmap, observe):
    assert build().compute_velocity(observe(costmap(), Pose(0.0, 0.0), [(1.0, 0.0)])).vx > 0.1


def test_goal_on_an_obstacle_is_approached_without_contact(build, costmap, observe):
    poses = drive(
        build(), costmap((0.8, 1.2, -0.2, 0.2)), observe, Pose(0.0, 0.0), [(0.1 * k, 0.0) for k in range(11)], 60
    )
    gaps = [math.hypot(max(0.775 - p.x, p.x - 1.225, 0.0), max(abs(p.y) - 0.225, 0.0)) - 0.113 for p in poses]
    assert min(gaps) > 0.0
    assert gaps[-1] < 0.5


def test_two_hundred_tracks_are_no_trouble(build, costmap, observe):
    n = 200
    generator = np.random.default_rng(3)
    tracks = Tracks(
        np.arange(n, dtype=np.int32),
        generator.uniform(-3.0, 3.0, (n, 2)),
        generator.uniform(-1.0, 1.0, (n, 2)),
        np.full(n, 0.3),
        np.tile(0.01 * np.eye(4), (n, 1, 1)),
    )
    command = build().compute_velocity(observe(costmap(), Pose(0.0, 0.0), AHEAD, tracks=tracks))
    assert math.isfinite(command.vx)


def test_nothing_of_an_episode_survives_a_reset(build, costmap, observe):
    first, again = build(), build()
    drive(again, costmap((0.5, 0.8, -0.1, 0.6)), observe, Pose(0.0, 0.0), AHEAD, 10)
    again.reset(EpisodeStart(None, Pose(0.0, 0.0), 0.1, np.random.default_rng(0)))
    views = [observe(costmap(), Pose(0.0, 0.0), AHEAD, stamp=0.1 * k) for k in range(3)]
    commands = [[planner.compute_velocity(view) for view in views] for planner in (first, again)]
    assert commands[0] == commands[1]


SCRIPT = """
from arena_core import Pose
from arena_core.testing import samples
body = samples.robot()
planner = samples.planner("mppi", body)
twists = [planner.compute_velocity(samples.observation(body=body, stamp=0.1 * k)) for k in range(4)]
print([value.hex() for twist in twists for value in (twist.vx, twist.vy, twist.wz)])
"""


@pytest.mark.slow
def test_two_processes_give_the_same_commands_bit_for_bit():
    runs = [
        subprocess.run([sys.executable, "-c", SCRIPT], capture_output=True, text=True, check=True).stdout
        for _ in range(2)
    ]
    assert runs[0] == runs[1]
    assert "0x" in runs[0]


@pytest.mark.parametrize(
    ("robot", "override", "message"),
    [
        (
            "jackal",
            "motion_model=Omni",
            r"motion_model is Omni; allowed for jackal \(differential\): DiffDrive, Ackermann",
        ),
        ("jackal_ackermann", "motion_model=DiffDrive", r"allowed for jackal_ackermann \(ackermann\): Ackermann"),
        ("jackal", "motion_model=Ackermann", r"turning_radius is None; allowed: > 0"),
        ("turtlebot3", "limits.vx_max=0.0", r"limits\.vx_max is 0\.0; allowed: > 0"),
        ("turtlebot3", "temperature=0", r"temperature is 0; allowed: > 0"),
    ],
)
def test_impossible_value_is_refused_in_one_line(robot, override, message, build):
    with pytest.raises(ConfigurationError, match=message):
        build(robot, "mppi", override)
