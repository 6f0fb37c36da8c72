import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arena_core import ConfigurationError, NoValidCommand, Pose, Twist

AHEAD = [(0.1 * k, 0.0) for k in range(30)]
ROBOTS = ["turtlebot3", "jackal", "robotino", "jackal_ackermann"]


def moved(pose, twist, time=0.1):
    middle = Pose(pose.x, pose.y, pose.theta + 0.5 * twist.wz * time).compose(Pose(twist.vx * time, twist.vy * time))
    return Pose(middle.x, middle.y, pose.theta + twist.wz * time)


def drive(planner, observe, costmap, path, people, walkers=(), steps=200, pose=None, window=None):
    """Drive among ``walkers`` (x, y, vx, vy) and return poses and the least distance of centres."""
    pose, twist, least, poses = pose or Pose(-1.5, 0.0, 0.0), Twist(0.0), math.inf, []
    window = window or costmap()
    for k in range(steps):
        rows = [(x + 0.1 * k * vx, y + 0.1 * k * vy, vx, vy) for x, y, vx, vy in walkers]
        try:
            twist = planner.compute_velocity(observe(window, pose, path, twist, 0.1 * k, people(*rows)))
        except NoValidCommand:
            twist = Twist(0.0)
        pose = moved(pose, twist)
        poses.append(pose)
        least = min([least, *(math.hypot(x + 0.1 * vx - pose.x, y + 0.1 * vy - pose.y) for x, y, vx, vy in rows)])
        if pose.distance(Pose(*path[-1])) < 0.25:
            break
    return poses, least


@pytest.mark.parametrize("name", ROBOTS)
def test_every_robot_drives_a_free_path_to_its_goal(name, build, observe, costmap, people):
    path = [(-1.5 + 0.1 * k, 0.0) for k in range(31)]
    poses, _ = drive(build(name), observe, costmap, path, people)
    assert poses[-1].distance(Pose(1.5, 0.0)) < 0.25


@pytest.mark.parametrize("name", ROBOTS)
def test_every_robot_goes_round_a_person_who_comes_head_on_and_ignores_it(name, build, observe, costmap, people, robot):
    path = [(-1.5 + 0.1 * k, 0.0) for k in range(31)]
    poses, least = drive(build(name), observe, costmap, path, people, walkers=[(1.5, 0.05, -0.3, 0.0)])
    assert least > 0.3 + robot(name).footprint.inscribed_radius
    assert poses[-1].distance(Pose(1.5, 0.0)) < 0.25


def test_person_out_of_the_way_changes_nothing(build, observe, costmap, people):
    free = build().compute_velocity(observe(costmap(), Pose(0.0, 0.0), AHEAD, Twist(0.2)))
    beside = build().compute_velocity(
        observe(costmap(), Pose(0.0, 0.0), AHEAD, Twist(0.2), tracks=people((0.0, 2.0, 0.0, 0.3)))
    )
    assert beside == free


def test_mirrored_scene_gives_the_mirrored_command(build, observe, costmap, people):
    left = build().compute_velocity(
        observe(costmap(), Pose(0.0, 0.0), AHEAD, Twist(0.2), tracks=people((1.2, 0.1, -0.3, 0.0)))
    )
    right = build().compute_velocity(
        observe(costmap(), Pose(0.0, 0.0), AHEAD, Twist(0.2), tracks=people((1.2, -0.1, -0.3, 0.0)))
    )
    assert left.wz < -0.05
    assert (left.vx, left.wz) == pytest.approx((right.vx, -right.wz))


def test_robot_leaves_less_of_the_avoiding_to_people_who_cooperate(build, observe, costmap, people):
    view = observe(costmap(), Pose(0.0, 0.0), AHEAD, Twist(0.2), tracks=people((1.2, 0.1, -0.3, 0.0)))
    alone = build("turtlebot3", "planner.people.reciprocity=1.0").compute_velocity(view)
    shared = build("turtlebot3", "planner.people.reciprocity=0.5").compute_velocity(view)
    assert alone.vx + 0.05 < shared.vx <= 0.22


def test_slow_robot_moves_out_of_the_way_of_a_person_who_walks_into_it(build, observe, costmap, people):
    planner, pose, twist = build(), Pose(0.0, 0.0, 0.0), Twist(0.0)
    for k in range(60):
        walker = people((1.5 - 0.03 * k, 0.02, -0.3, 0.0))
        twist = planner.compute_velocity(observe(costmap(), pose, [(0.0, 0.0), (0.05, 0.0)], twist, tracks=walker))
        pose = moved(pose, twist)
        assert math.hypot(1.5 - 0.03 * k - pose.x, 0.02 - pose.y) > 0.113 + 0.3


def test_robot_stops_before_a_wall_that_closes_the_way(build, observe, costmap, people):
    path = [(-1.5 + 0.1 * k, 0.0) for k in range(41)]
    poses, _ = drive(build("jackal"), observe, costmap, path, people, steps=25, window=costmap((1.0, 1.2, -3.0, 3.0)))
    assert 0.3 < max(pose.x for pose in poses) < 1.0 - 0.21


def test_blocked_robot_can_drive_away(build, observe, costmap, people):
    corner = costmap((0.35, 0.5, -0.6, 0.6), (-0.3, 0.6, 0.3, 0.4), (-0.3, 0.6, -0.4, -0.3))
    path = [(0.0, 0.0), (-0.1, 0.0), (-1.0, 0.0), (-2.0, 0.0)]
    poses, _ = drive(build("jackal"), observe, costmap, path, people, pose=Pose(0.0, 0.0, 0.0), window=corner)
    assert poses[-1].x < -1.0


def test_car_turns_round_in_several_moves(build, observe, costmap, people):
    walls = costmap((-3.0, 3.0, 0.8, 0.9), (-3.0, 3.0, -0.9, -0.8))
    path = [(-0.1 * k, 0.0) for k in range(20)]
    poses, _ = drive(
        build("jackal_ackermann"), observe, costmap, path, people, pose=Pose(0.0, 0.0, 0.0), window=walls, steps=600
    )
    assert poses[-1].distance(Pose(*path[-1])) < 0.3


@settings(derandomize=True, deadline=None, max_examples=30)
@given(
    name=st.sampled_from(ROBOTS),
    boxes=st.lists(st.tuples(st.floats(-2.5, 2.5), st.floats(-2.5, 2.5), st.floats(0.1, 0.6)), max_size=15),
    theta=st.floats(-math.pi, math.pi),
    share=st.floats(-1.0, 1.0),
    turn=st.floats(-1.0, 1.0),
)
def test_chosen_command_can_always_be_braked_before_a_collision(
    name, build, robot, observe, costmap, boxes, theta, share, turn
):
    body, window = (
        robot(name),
        costmap(*[(x, x + side, y, y + side) for x, y, side in boxes if max(abs(x), abs(y), abs(x + side)) > 0.6]),
    )
    limits = body.limits
    twist = Twist(share * limits.vx_max, 0.0, 0.3 * turn * limits.wz_max)
    try:
        command = build(name).compute_velocity(observe(window, Pose(0.0, 0.0, theta), AHEAD, twist))
    except NoValidCommand:
        return
    pose, now, bent = Pose(0.0, 0.0, theta), twist.array(), twist.wz
    rate = np.array((limits.ax_max, limits.ay_max, limits.alpha_max)) * 0.01
    started_clear = least_distance(window, body, pose) > 0.03
    for step in range(200):
        wanted = command.array() if step < 10 else np.zeros(3)
        before = now[0]
        now = now + np.clip(wanted - now, -rate, rate)
        if body.kinematics == "ackermann" and step >= 10:
            now[2] = 0.0 if before == 0.0 else bent * now[0] / before
        bent = now[2]
        if step >= 10 and not now.any():
            break
        pose = moved(pose, Twist.of(now), 0.01)
        if started_clear:
            assert least_distance(window, body, pose) > 0.0


def least_distance(window, body, pose):
    """Return how far the lethal cells' edges are at least from the footprint's edge, seen as points along it."""
    ring = body.footprint.radius * np.column_stack((np.cos(np.linspace(0, 6.3, 40)), np.sin(np.linspace(0, 6.3, 40))))
    vertices = (
        ring
        if body.footprint.is_circle
        else np.vstack(
            [
                np.linspace(a, b, 10)
                for a, b in zip(
                    body.footprint.vertices_xy, np.roll(body.footprint.vertices_xy, -1, axis=0), strict=True
                )
            ]
        )
    )
    c, s = math.cos(pose.theta), math.sin(pose.theta)
    points = vertices @ np.array(((c, s), (-s, c))) + (pose.x, pose.y)
    cells = np.clip(((points - window.origin_xy) / window.resolution).astype(int), 0, 120)
    return float(window.distance[cells[:, 1], cells[:, 0]].min()) - 0.5 * window.resolution * math.sqrt(2.0)


def test_empty_path_and_blinded_robot_are_no_crash(build, observe, costmap, people):
    with pytest.raises(NoValidCommand, match="path is empty"):
        build().compute_velocity(observe(costmap(), Pose(0.0, 0.0), []))
    single = build().compute_velocity(observe(costmap(), Pose(0.0, 0.0), [(0.0, 0.0)]))
    assert single == Twist(0.0, 0.0, 0.0)


def test_two_hundred_tracks_are_no_trouble(build, observe, costmap, people):
    generator = np.random.default_rng(3)
    rows = np.column_stack((generator.uniform(-3.0, 3.0, (200, 2)), generator.uniform(-0.5, 0.5, (200, 2))))
    command = build("jackal").compute_velocity(
        observe(costmap(), Pose(0.0, 0.0), AHEAD, Twist(0.2), tracks=people(*rows))
    )
    assert math.isfinite(command.vx)


def test_share_below_a_half_is_refused(build):
    with pytest.raises(ConfigurationError, match=r"reciprocity is 0\.2"):
        build("turtlebot3", "planner.people.reciprocity=0.2")
