"""The planner as a whole, driven in scenes made by hand."""

import math

import numpy as np
import pytest

from arena_core import ConfigurationError, NoValidCommand, Pose, Twist
from arena_teb.model import speed_limits
from arena_teb.motion import saturate_velocity

PATH = [(-2.0 + 0.1 * k, 0.0) for k in range(46)]
ROBOTS = ["turtlebot3", "jackal", "robotino", "jackal_ackermann"]


def moved(pose, twist, time=0.1):
    turn = twist.wz * time
    middle = Pose(0.0, 0.0, 0.5 * turn).compose(Pose(twist.vx * time, twist.vy * time))
    return pose.compose(Pose(middle.x, middle.y, turn))


def drive(planner, observe, costmap, pose, steps=300, path=PATH, tracks=None):
    """Return the poses driven until the goal is near."""
    twist, driven = Twist(0.0), [pose]
    for step in range(steps):
        options = {} if tracks is None else {"tracks": tracks(0.1 * step)}
        try:
            twist = planner.compute_velocity(observe(costmap, pose, path, twist, 0.1 * step, **options))
        except NoValidCommand:
            twist = Twist(0.0)
        pose = moved(pose, twist)
        driven.append(pose)
        if pose.distance(Pose(*path[-1])) < 0.3:
            break
    return driven


@pytest.mark.parametrize("robot", ROBOTS)
def test_every_robot_drives_a_free_path_to_its_goal(robot, build, observe, costmap):
    driven = drive(build(robot), observe, costmap(), Pose(-2.0, 0.0, 0.4))
    assert driven[-1].distance(Pose(2.5, 0.0)) < 0.3


@pytest.mark.parametrize("robot", ROBOTS)
def test_as_released_drives_too(robot, build, observe, costmap):
    driven = drive(build(robot, preset="teb_as_released"), observe, costmap(), Pose(-2.0, 0.0), 600)
    assert driven[-1].distance(Pose(2.5, 0.0)) < 0.3


@pytest.mark.parametrize("robot", ["jackal", "robotino"])
def test_obstacle_on_the_path_is_gone_round(robot, build, observe, costmap):
    box = costmap((-0.2, 0.2, -0.3, 0.35))
    driven = drive(build(robot), observe, box, Pose(-2.0, 0.0))
    assert driven[-1].distance(Pose(2.5, 0.0)) < 0.3
    gaps = [math.hypot(max(abs(p.x) - 0.2, 0.0), max(abs(p.y - 0.025) - 0.325, 0.0)) for p in driven]
    assert min(gaps) > 0.165


def test_jackal_passes_a_gap_little_wider_than_itself(build, observe, costmap):
    wall = costmap((-0.1, 0.1, 0.3, 3.0), (-0.1, 0.1, -3.0, -0.3))
    assert drive(build("jackal"), observe, wall, Pose(-2.0, 0.0))[-1].distance(Pose(2.5, 0.0)) < 0.3


def test_robot_turns_toward_a_path_behind_it(build, observe, costmap):
    driven = drive(build("jackal"), observe, costmap(), Pose(-2.0, 0.0, math.pi), 200)
    assert driven[-1].distance(Pose(2.5, 0.0)) < 0.3
    assert math.cos(driven[-1].theta) > 0.8


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_class_that_becomes_blocked_is_left_for_another(side, build, observe, costmap):
    """The box reaches twice as far across on the side that the path avoids: midway, a tuned
    robot finds both ways equally good.
    """

    def box(low, high):
        return costmap((-0.2, 0.2, *sorted((side * low, side * high))))

    planner, pose, twist = build("jackal"), Pose(-1.5, 0.0), Twist(0.0)
    path = [(x, side * y) for x, y in ((-1.5, 0.0), (-0.75, 0.45), (0.0, 0.9), (0.75, 0.45), (1.5, 0.0))]
    open_both, shut = box(-0.6, 0.3), box(-0.6, 3.1)
    for step in range(5):
        twist = planner.compute_velocity(observe(open_both, pose, path, Twist(0.0), 0.1 * step))
        assert side * twist.wz > 0.0
    lowest = 0.0
    for step in range(200):
        try:
            twist = planner.compute_velocity(observe(shut, pose, path, twist, 0.5 + 0.1 * step))
        except NoValidCommand:
            twist = Twist(0.0)
        pose = moved(pose, twist)
        lowest = min(lowest, side * pose.y)
        if pose.distance(Pose(1.5, 0.0)) < 0.3:
            break
    assert pose.distance(Pose(1.5, 0.0)) < 0.3
    assert lowest < -0.8


@pytest.mark.parametrize("speed", [0.2, 0.3])
def test_slow_robot_makes_way_for_who_walks_towards_it(speed, build, observe, costmap, people):
    def walker(time):
        return people((2.0 - speed * time, 0.0, -speed, 0.0))

    driven = drive(build("turtlebot3"), observe, costmap(), Pose(-1.0, 0.0), 140, tracks=walker)
    gaps = [pose.distance(Pose(2.0 - speed * 0.1 * step, 0.0)) - 0.3 - 0.113 for step, pose in enumerate(driven)]
    assert min(gaps) > 0.05


def test_same_observations_give_the_same_commands(build, observe, costmap, people):
    planner, box = build("robotino"), costmap((0.9, 1.2, 0.3, 0.7))
    views = [
        observe(box, Pose(0.05 * k, 0.0), PATH, Twist(0.4), 0.1 * k, people((1.5, 0.5, 0.0, -0.3))) for k in range(5)
    ]
    first = [planner.compute_velocity(view) for view in views]
    again = build("robotino")
    assert [again.compute_velocity(view) for view in views] == first


def test_empty_path_is_no_valid_command(build, observe):
    with pytest.raises(NoValidCommand, match="path is empty"):
        build().compute_velocity(observe(path_xy=[]))


@pytest.mark.parametrize("path", [[(0.0, 0.0)], [(1.0, 0.0)], [(0.0, 0.0)] * 5])
def test_path_of_one_place_gives_a_finite_command(path, build, observe):
    assert np.isfinite(build().compute_velocity(observe(path_xy=path)).array()).all()


@pytest.mark.parametrize("robot", ["turtlebot3", "jackal"])
def test_goal_on_an_obstacle_is_approached_without_touching_it(robot, build, observe, costmap):
    wall = costmap((2.0, 3.1, -3.1, 3.1))
    driven = drive(build(robot), observe, wall, Pose(-1.0, 0.0), 200)
    assert max(pose.x for pose in driven) < 2.0 - 0.1
    assert max(pose.x for pose in driven) > 1.0


def test_two_hundred_clusters_are_planned_among(build, observe, costmap):
    xs, ys = np.arange(-2.9, 3.0, 0.4), np.arange(-2.9, 3.0, 0.4)
    dots = costmap(*[(x, x + 0.01, y, y + 0.01) for x in xs for y in ys if math.hypot(x, y) > 0.3])
    try:
        assert np.isfinite(build("turtlebot3").compute_velocity(observe(dots)).array()).all()
    except NoValidCommand as refusal:
        assert "teb" in str(refusal)  # noqa: PT017 - either answer is right


def test_robot_walled_in_does_not_crash(build, observe, costmap):
    ring = costmap((-0.3, 0.3, 0.15, 0.3), (-0.3, 0.3, -0.3, -0.15), (0.15, 0.3, -0.3, 0.3), (-0.3, -0.15, -0.3, 0.3))
    planner = build("turtlebot3")
    for step in range(10):
        try:
            planner.compute_velocity(observe(ring, stamp=0.1 * step))
        except NoValidCommand as refusal:
            assert "no band is feasible" in str(refusal)  # noqa: PT017 - a way to turn on the spot would be right too


def test_tracks_without_a_position_are_left_out(build, observe, people):
    command = build().compute_velocity(observe(tracks=people((math.nan, 0.0, 0.0, 0.0), (1.0, 1.0, math.inf, 0.0))))
    assert np.isfinite(command.array()).all()


def test_too_fast_a_velocity_is_slowed_on_its_arc():
    command = saturate_velocity(
        np.array((2.0, 0.0, 1.0)), np.array((-1.0, 0.0, -2.0)), np.array((1.0, 0.0, 2.0)), 0.0, holonomic=False
    )
    assert (command.vx, command.wz) == (1.0, 0.5)


@pytest.mark.parametrize(
    ("override", "message"),
    [
        ("planner.limits.max_vel_x=0", "max_vel_x"),
        ("planner.limits.max_vel_theta=0", "max_vel_theta"),
        ("planner.trajectory.dt_hysteresis=0.5", r"dt_hysteresis is 0\.5"),
        ("planner.trajectory.min_samples=2", "min_samples is 2"),
        ("planner.obstacles.proximity_lower_bound=9", r"proximity_lower_bound is 9\.0"),
    ],
)
def test_impossible_values_are_refused(override, message, build):
    with pytest.raises(ConfigurationError, match=message):
        build("turtlebot3", override)


def test_turning_radius_below_the_robots_is_refused(build):
    with pytest.raises(ConfigurationError, match=r"min_turning_radius is 0\.1"):
        build("jackal_ackermann", "planner.limits.min_turning_radius=0.1")


def test_limits_that_are_null_are_the_robots(build):
    from arena_core.testing import component
    from arena_teb.parameters import Limits

    least, most, acceleration = speed_limits(component("robot", "robotino"), Limits(*[None] * 8))
    assert (least.tolist(), most.tolist(), acceleration.tolist()) == (
        [-2.78, -2.78, -1.0],
        [2.78, 2.78, 1.0],
        [2.5, 2.5, 3.2],
    )
