"""Several robots in one world: bodies to each other, as in the plane, and each with senses and noise of its own."""

import math
from dataclasses import replace

import numpy as np
import pytest
from shapely.affinity import rotate, translate
from shapely.geometry import Point, Polygon

from arena_core import Branches, ConfigurationError, Footprint, OdometryModel, Pose
from arena_core.tasks import Member
from arena_core.testing import component, robot, scenario
from arena_core.testing.samples import person

BOX = Footprint.polygon([[0.25, -0.2], [0.25, 0.2], [-0.25, 0.2], [-0.25, -0.2]])
RADIUS = robot().footprint.radius
DEEPEST = 0.005  # m; of what touches
DRIVES = pytest.mark.parametrize("drive", ["planar", "wheels"])
QUIET = replace(robot(), lidar=replace(robot().lidar, noise_std=0.0))
AHEAD = round(-QUIET.lidar.angle_min / QUIET.lidar.angle_increment)


def team(*starts, name="team", people=()):
    """Return a scenario with a robot at each start, (x, y, theta)."""
    poses = [Pose(*start) for start in starts]
    mates = tuple(Member(f"robot{k}", pose, Pose(0.0, 4.0)) for k, pose in enumerate(poses[1:], 1))
    return replace(scenario(start=poses[0], people=people, name=name), team=mates)


def ring(count, size=1.5):
    """Return starts on a circle, headed for its middle."""
    angles = 2.0 * np.pi * np.arange(count) / count
    return [(size * math.cos(a), size * math.sin(a), a + np.pi) for a in angles]


def drive(simulator, commands, steps):
    return [simulator.advance(np.array(commands, float), 10) for _ in range(steps)]


def contacts(snapshots, row):
    return [contact for snapshot in snapshots for contact in snapshot.contacts[row]]


@DRIVES
def test_two_robots_head_on_touch_where_their_outlines_meet_and_both_caused_it(simulate, drive):
    simulator = simulate(robot(), f"simulator.drive={drive}")
    simulator.reset([team((-1.0, 0.0, 0.0), (1.0, 0.0, np.pi))])
    snapshots = [simulator.advance(np.array([(0.5, 0.0, 0.0)] * 2), 10) for _ in range(30)]
    apart = snapshots[-1].poses[1, 0] - snapshots[-1].poses[0, 0]
    assert apart == pytest.approx(2.0 * RADIUS, abs=DEEPEST)
    for row in range(2):
        contact = contacts(snapshots, row)[0]
        assert (contact.kind, contact.person, contact.caused) == ("robot", 1 - row, True)
        assert contact.speed == pytest.approx(1.0, abs=0.05)


def test_only_the_robot_that_closes_the_gap_causes_a_contact_and_both_note_it(simulate):
    simulator = simulate(robot())
    simulator.reset([team((-1.0, 0.0, 0.0), (0.0, 0.0, 1.0))])
    snapshots = drive(simulator, [(0.5, 0.0, 0.0), (0.0, 0.0, 0.0)], 25)
    (moved,), (stood,) = contacts(snapshots, 0), contacts(snapshots, 1)
    assert (moved.caused, stood.caused) == (True, False)
    assert moved.stamp == stood.stamp
    assert moved.speed == pytest.approx(0.5, abs=0.02)
    pushed = snapshots[-1].poses[1, :2]
    assert 0.0 < np.hypot(*pushed) < 0.15  # bodies of equal mass: who stands is bumped, and brakes


@pytest.mark.parametrize("count", [2, 4])
def test_robots_that_meet_in_the_middle_do_so_as_in_the_plane(simulate, count):
    problem, commands = team(*ring(count)), [(0.5, 0.0, 0.0)] * count
    nobody = component("pedestrians", "none", [])
    plane = component("simulator", "sim2d", [], robot=robot(), pedestrians=nobody)
    solid = simulate(robot())
    driven = []
    for simulator in (plane, solid):
        simulator.reset([problem])
        driven.append(drive(simulator, commands, 40))
    for row in range(count):
        flat, deep = (contacts(snapshots, row) for snapshots in driven)
        assert {contact.person for contact in flat} == {contact.person for contact in deep}
        assert deep[0].stamp == pytest.approx(flat[0].stamp, abs=0.03)
        assert deep[0].caused
    before = int(min(contact.stamp for contact in contacts(driven[0], 0)) / 0.1) - 1
    for step in range(before):
        assert driven[1][step].poses == pytest.approx(driven[0][step].poses, abs=0.01)
        assert driven[1][step].clearances == pytest.approx(driven[0][step].clearances, abs=0.02)
    assert driven[1][-1].poses[:, :2] == pytest.approx(driven[0][-1].poses[:, :2], abs=0.02)


@DRIVES
@pytest.mark.parametrize("footprint", [robot().footprint, BOX], ids=["discs", "boxes"])
def test_a_pile_of_robots_is_never_deeper_than_5_mm_in_each_other(simulate, drive, footprint):
    body = replace(robot(), footprint=footprint)
    simulator = simulate(body, f"simulator.drive={drive}")
    simulator.reset([team(*ring(5, size=1.0))])
    shape = Point(0.0, 0.0).buffer(RADIUS, 64) if footprint.is_circle else Polygon(footprint.vertices_xy)
    random, met = np.random.default_rng(3), 0
    for step in range(120):
        if step % 20 == 0:
            commands = np.column_stack((random.uniform(0.2, 0.8, 5), np.zeros(5), random.uniform(-1.0, 1.0, 5)))
        snapshot = simulator.advance(commands, 2)
        met += sum(map(len, snapshot.contacts))
        assert not snapshot.failures
        placed = [
            translate(rotate(shape, theta, origin=(0, 0), use_radians=True), x, y)
            for x, y, theta in snapshot.poses.tolist()
        ]
        for k, one in enumerate(placed):
            assert all(one.intersection(other.buffer(-DEEPEST)).area < 1e-6 for other in placed[:k])
    assert met > 0


@pytest.mark.parametrize("lidar", ["slice", "rays"])
def test_lidar_sees_the_outline_of_a_teammate_and_not_its_own(simulate, lidar):
    simulator = simulate(replace(QUIET, footprint=BOX), f"simulator.lidar={lidar}")
    simulator.reset([team((-1.0, 0.0, 0.0), (1.0, 0.0, np.pi / 2))])
    snapshot = simulator.advance(np.zeros((2, 3)), 10)
    assert snapshot.ranges[0, AHEAD] == pytest.approx(2.0 - 0.2, abs=5e-3)
    assert snapshot.ranges.min() > 1.0
    over = simulator.reset([team((-1.0, 0.0, 0.0), (1.0, 1.5, 0.0))])
    assert over.ranges[0, AHEAD] > 5.0


def test_each_robot_draws_noise_of_its_own_and_the_first_that_which_it_draws_alone(simulate):
    noisy = replace(robot(), lidar=replace(robot().lidar, noise_std=0.02, range_max=1.0))
    simulator = simulate(replace(noisy, odometry=OdometryModel(0.1, 0.02, 0.02, 0.02, 0.02)))
    pair = simulator.reset([team((-3.0, 0.0, 0.0), (3.0, 0.0, 0.0))])
    commands = np.array([(0.5, 0.0, 0.3)] * 2)
    pair = [simulator.advance(commands, 10) for _ in range(15)][-1]
    simulator.reset([scenario(start=Pose(-3.0, 0.0), name="team")])
    alone = [simulator.advance(commands[:1], 10) for _ in range(15)][-1]
    assert (pair.poses[0] == alone.poses[0]).all()
    assert (pair.ranges[0] == alone.ranges[0]).all()
    assert (pair.odometry_poses[0] == alone.odometry_poses[0]).all()
    assert not np.array_equal(pair.odometry_twists[0], pair.odometry_twists[1])


def test_a_world_of_a_team_among_others_gives_what_it_gives_alone(simulate):
    simulator = simulate(robot())
    problems, commands = [team(*ring(3), name=str(k)) for k in range(2)], np.array([(0.5, 0.0, 0.1)] * 6)
    simulator.reset(problems)
    both = [simulator.advance(commands, 10) for _ in range(30)][-1]
    simulator.reset(problems[1:])
    one = [simulator.advance(commands[:3], 10) for _ in range(30)][-1]
    assert (both.poses[3:] == one.poses).all()
    assert (both.ranges[3:] == one.ranges).all()


def test_a_fork_of_a_team_goes_on_as_the_original_and_without_robots_nobody_is_in_the_way(simulate):
    simulator = simulate(robot())
    commands = np.array([(0.5, 0.0, 0.0)] * 2)
    simulator.reset([team((-1.0, 0.0, 0.0), (1.0, 0.0, np.pi))])
    drive(simulator, commands, 5)
    copy = simulator.fork(Branches.of([0]))
    first = simulator.fork(Branches(np.zeros(1, np.int64), np.zeros(1, np.uint64), np.array([[True, False]])))
    ahead, own = drive(copy, commands, 15)[-1], drive(simulator, commands, 15)[-1]
    assert (ahead.poses == own.poses).all()
    through = drive(first, commands, 25)
    assert not contacts(through, 0)
    assert through[-1].poses[0, 0] > 0.1


def test_people_walk_round_every_robot_of_a_team(simulate):
    simulator = simulate(robot())
    walker = person(7, 0.0, 2.5, (0.0, -2.5), (0.0, 2.5), speed=1.0)
    simulator.reset([team((-2.0, 0.0, 0.0), (0.0, 0.0, 0.0), people=[walker])])
    snapshots = drive(simulator, np.zeros((2, 3)), 30)
    assert {contact.person for contact in contacts(snapshots, 1)} == {7}
    assert not contacts(snapshots, 0)
    gaps = [np.hypot(*(s.crowd.positions[0, 0] - s.poses[1, :2])) - 0.3 - RADIUS for s in snapshots]
    assert min(gaps) > -DEEPEST


def test_a_depth_camera_is_for_a_robot_alone(simulate):
    simulator = simulate(robot(), "simulator.depth_camera.enabled=true")
    with pytest.raises(ConfigurationError, match="only a robot alone has a depth camera; allowed: simulator"):
        simulator.reset([team((-1.0, 0.0, 0.0), (1.0, 0.0, 0.0))])


def test_a_team_of_two_types_is_refused(simulate):
    mixed = team((-1.0, 0.0, 0.0), (1.0, 0.0, 0.0))
    other = replace(mixed.team[0], robot="other", body=replace(robot(), name="other"))
    with pytest.raises(ConfigurationError, match="has a other among robots of type sample; allowed with simulator"):
        simulate(robot()).reset([replace(mixed, team=(other,))])
