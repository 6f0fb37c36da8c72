import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arena_core import ConfigurationError, EpisodeStart, NoValidCommand, Pose, Twist
from arena_dwa.map_grid import cost_fields, map_grids
from arena_dwa.settings import Body, BodyOnWindow, Scales
from arena_kernels.costmap_window import outline_of, window_of

AHEAD = [(0.1 * k, 0.0) for k in range(40)]


def test_free_straight_path_is_driven_near_full_speed(build, costmap, observe):
    command = build().compute_velocity(observe(costmap(), Pose(0.0, 0.0), AHEAD, Twist(0.2)))
    assert command.vx > 0.95 * 0.22
    assert abs(command.wz) < 0.1


@pytest.mark.parametrize("robot", ["turtlebot3", "jackal", "robotino", "jackal_ackermann", "stranger"])
def test_every_robot_drives_a_free_path_to_its_goal(robot, build, costmap, observe):
    planner, pose, twist = build(robot), Pose(-2.0, 0.0, 0.4), Twist(0.0)
    path = [(-2.0 + 0.1 * k, 0.0) for k in range(36)]
    for _ in range(300):
        twist = planner.compute_velocity(observe(costmap(), pose, path, twist))
        pose = pose.compose(_arc(twist, 0.1))
        if pose.distance(Pose(1.5, 0.0)) < 0.3:
            return
    pytest.fail(f"still at {pose}")


def _arc(twist, time):
    turn = twist.wz * time
    middle = Pose(0.0, 0.0, 0.5 * turn).compose(Pose(twist.vx * time, twist.vy * time))
    return Pose(middle.x, middle.y, turn)


def test_scene_symmetric_about_the_path_is_driven_straight(build, costmap, observe):
    walls = costmap((-3.0, 3.0, 0.5, 0.6), (-3.0, 3.0, -0.6, -0.5))
    assert abs(build().compute_velocity(observe(walls, Pose(0.0, 0.0), AHEAD, Twist(0.2))).wz) < 1e-9


def test_mirrored_scene_gives_the_mirrored_command(build, costmap, observe):
    left = build().compute_velocity(observe(costmap((0.4, 0.7, 0.0, 0.4)), Pose(0.0, 0.0), AHEAD, Twist(0.2)))
    right = build().compute_velocity(observe(costmap((0.4, 0.7, -0.4, 0.0)), Pose(0.0, 0.0), AHEAD, Twist(0.2)))
    assert left.wz < -0.1
    assert (left.vx, left.wz) == pytest.approx((right.vx, -right.wz))


def test_robot_turns_toward_a_path_behind_it(build, costmap, observe):
    planner, pose, twist = build(turn_in_place={"begin": 1.8}), Pose(0.0, 0.0), Twist(0.0)
    for _ in range(50):
        twist = planner.compute_velocity(observe(costmap(), pose, [(-x, y) for x, y in AHEAD], twist))
        pose = pose.compose(_arc(twist, 0.1))
    assert math.cos(pose.theta) < -0.8
    assert pose.x < -0.1


def test_robot_stops_before_a_wall_that_closes_the_way(build, costmap, observe):
    planner, pose, twist = build(), Pose(0.0, 0.0), Twist(0.0)
    wall = costmap((1.0, 1.2, -3.0, 3.0))
    for _ in range(150):
        try:
            twist = planner.compute_velocity(observe(wall, pose, AHEAD, twist))
        except NoValidCommand:
            twist = Twist(0.0)
        pose = pose.compose(_arc(twist, 0.1))
        assert pose.x < 1.0 - 0.113
    assert pose.x > 0.3


def test_no_valid_command_when_every_sample_collides(build, costmap, observe):
    ring = costmap((-0.2, 0.2, 0.12, 0.3), (-0.2, 0.2, -0.3, -0.12), (0.12, 0.3, -0.3, 0.3), (-0.3, -0.12, -0.3, 0.3))
    planner = build(name="dwa_as_released")
    with pytest.raises(NoValidCommand, match="dwa"):
        planner.compute_velocity(observe(ring, Pose(0.0, 0.0), AHEAD, Twist(0.0)))


def test_holonomic_robot_strafes_where_that_is_useful(build, costmap, observe):
    command = build("robotino").compute_velocity(
        observe(costmap(), Pose(0.0, 0.0), [(0.0, 0.1 * k) for k in range(20)])
    )
    assert command.vy > 0.1
    assert command.vy > abs(command.vx)


def test_as_released_cannot_creep(build, costmap, observe):
    planner = build(name="dwa_as_released")
    for y in np.linspace(-0.4, 0.4, 9):
        box = costmap((0.35, 0.6, y - 0.2, y + 0.2))
        command = planner.compute_velocity(observe(box, Pose(0.0, 0.0), AHEAD, Twist(0.1)))
        assert abs(command.vx) >= 0.11 - 1e-4 or abs(command.wz) >= 1.37 - 1e-4


@settings(derandomize=True, deadline=None, max_examples=60)
@given(
    st.lists(st.tuples(st.integers(0, 120), st.integers(0, 120), st.integers(1, 12)), max_size=25),
    st.floats(-math.pi, math.pi),
    st.floats(-0.22, 0.22),
    st.floats(-2.84, 2.84),
)
def test_chosen_command_can_always_be_braked_before_a_collision(build, inflate, observe, boxes, theta, vx, wz):
    planner = build()
    lethal = np.zeros((121, 121), np.bool_)
    for row, column, size in boxes:
        lethal[row : row + size, column : column + size] = True
    lethal[55:66, 55:66] = False
    window = inflate(lethal)
    try:
        command = planner.compute_velocity(observe(window, Pose(0.0, 0.0, theta), AHEAD, Twist(vx, 0.0, wz)))
    except NoValidCommand:
        return
    pose, speed, turn = Pose(0.0, 0.0, theta), command.vx, command.wz
    for step in range(200):
        pose = pose.compose(_arc(Twist(speed, 0.0, turn), 0.01))
        cell = np.floor((np.array((pose.y, pose.x)) - window.origin_xy) / 0.05).astype(int)
        assert window.distance[tuple(cell)] >= 0.113
        if step >= 10:
            speed = math.copysign(max(0.0, abs(speed) - 0.025), speed)
            turn = math.copysign(max(0.0, abs(turn) - 0.032), turn)


def test_minimum_speed_above_the_maximum_is_refused(build):
    with pytest.raises(ConfigurationError, match=r"limits\.trans_min is 0\.3"):
        build(limits={"trans_min": 0.3})


def test_a_robotino_as_released_starts_because_its_window_is_longer_than_its_period(build, costmap, observe):
    at_20_hz = EpisodeStart(None, Pose(0.0, 0.0), 0.05, np.random.default_rng(0))
    planner, standing = (
        build("robotino", name="dwa_as_released"),
        build("robotino", name="dwa_as_released", roll_out={"sim_period": None}),
    )
    planner.reset(at_20_hz)
    standing.reset(at_20_hz)
    rest = observe(costmap(), Pose(0.0, 0.0), AHEAD, Twist(0.0))
    command = planner.compute_velocity(rest)
    assert abs(command.wz) >= 0.5 - 1e-4
    assert command.vx > 0.4
    with pytest.raises(NoValidCommand, match="too slow"):
        standing.compute_velocity(rest)


def test_the_alignment_critic_is_off_near_the_paths_end(costmap):
    scales, body = (
        Scales(32.0, 20.0, 0.0, True, 0.325, 0.0, 0.0, 0.0),
        Body(outline_of(None, 0.113, 0.113, 0.05), 0.01, 0.25, 0.2),
    )
    window = window_of(costmap((2.0, 2.1, 2.0, 2.1)))
    grids = map_grids(BodyOnWindow(window, body), np.array([(0.1 * k, 0.0, 0.0) for k in range(10)]), (0.0, 0.0), 0.325)
    on, off = (cost_fields(grids, window, scales, aligning)[1] for aligning in (True, False))
    beside = 70, 65  # half a metre off the path
    assert on[beside] - off[beside] == pytest.approx(0.5 * 32.0 * 0.05 * grids.path.reshape(123, 123)[71, 66])
    assert on[beside] > off[beside]
