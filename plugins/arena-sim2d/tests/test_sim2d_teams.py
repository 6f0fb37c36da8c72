"""Several robots in one world: bodies to each other, each with senses and noise of its own."""

import math
from dataclasses import replace

import numpy as np
import pytest
from shapely.affinity import rotate, translate
from shapely.geometry import Point, Polygon

from arena_core import Branches, ConfigurationError, Footprint, ImpossibleScenario, Pose
from arena_core.tasks import Member
from arena_core.testing import component, robot, scenario

BOX = Footprint.polygon([[0.25, -0.2], [0.25, 0.2], [-0.25, 0.2], [-0.25, -0.2]])
RADIUS = robot().footprint.radius


def team(*starts, name="team", people=()):
    """Return a scenario with a robot at each start, (x, y, theta)."""
    poses = [Pose(*start) for start in starts]
    mates = tuple(Member(f"robot{k}", pose, Pose(0.0, 4.0)) for k, pose in enumerate(poses[1:], 1))
    return replace(scenario(start=poses[0], people=people, name=name), team=mates)


def alone(body):
    """Return a simulator without people."""
    timing = ["simulator.inner_step=0.01", "simulator.crowd_period=0.05"]
    return component("simulator", "sim2d", timing, robot=body, pedestrians=component("pedestrians", "none", []))


def drive(simulator, commands, steps):
    return [simulator.advance(np.array(commands, float), 10) for _ in range(steps)]


def contacts(snapshots, row):
    return [contact for snapshot in snapshots for contact in snapshot.contacts[row]]


def ring(count, size=1.2, seed=0):
    """Return starts on a circle, headed for its middle, somewhat off."""
    random = np.random.default_rng(seed)
    angles = 2.0 * np.pi * np.arange(count) / count
    return [(size * math.cos(a), size * math.sin(a), a + np.pi + random.uniform(-0.3, 0.3)) for a in angles]


def outlines(snapshot, footprint):
    """Return the bodies of all robots as shapes."""
    shape = Polygon(footprint.vertices_xy) if len(footprint.vertices_xy) else Point(0.0, 0.0).buffer(footprint.radius)
    return [
        translate(rotate(shape, theta, origin=(0, 0), use_radians=True), x, y)
        for x, y, theta in snapshot.poses.tolist()
    ]


def test_two_robots_head_on_touch_once_each_where_their_outlines_meet():
    simulator = alone(robot())
    simulator.reset([team((-1.0, 0.0, 0.0), (1.0, 0.0, np.pi))])
    snapshots = drive(simulator, [(0.5, 0.0, 0.0), (0.5, 0.0, 0.0)], 30)
    apart = snapshots[-1].poses[1, 0] - snapshots[-1].poses[0, 0]
    assert apart == pytest.approx(2.0 * RADIUS, abs=1e-3)
    for row in range(2):
        (contact,) = contacts(snapshots, row)
        assert (contact.kind, contact.person, contact.caused) == ("robot", 1 - row, True)
        assert contact.speed == pytest.approx(1.0, abs=0.02)
        assert snapshots[-1].clearances[row] == pytest.approx(0.0, abs=1e-3)
        assert snapshots[-1].in_contact[row]


def test_only_the_robot_that_closes_the_gap_causes_a_contact_and_both_note_it():
    simulator = alone(robot())
    simulator.reset([team((-1.0, 0.0, 0.0), (0.0, 0.0, 1.0))])
    snapshots = drive(simulator, [(0.5, 0.0, 0.0), (0.0, 0.0, 0.0)], 20)
    (moved,), (stood,) = contacts(snapshots, 0), contacts(snapshots, 1)
    assert (moved.caused, stood.caused) == (True, False)
    assert moved.stamp == stood.stamp
    assert moved.speed == stood.speed == pytest.approx(0.5)


def test_robots_that_part_and_meet_again_have_a_second_contact():
    simulator = alone(robot())
    simulator.reset([team((-0.5, 0.0, 0.0), (0.5, 0.0, np.pi))])
    together, apart = [(0.5, 0.0, 0.0)] * 2, [(-0.5, 0.0, 0.0)] * 2
    snapshots = [*drive(simulator, together, 10), *drive(simulator, apart, 10), *drive(simulator, together, 20)]
    assert [len(contacts(snapshots, row)) for row in range(2)] == [2, 2]


@pytest.mark.parametrize("footprint", [robot().footprint, BOX], ids=["discs", "boxes"])
def test_a_pile_of_robots_never_overlaps_and_clearances_are_the_gaps_between_outlines(footprint):
    body = replace(robot(), footprint=footprint)
    simulator = alone(body)
    simulator.reset([team(*ring(6))])
    random, met = np.random.default_rng(3), 0
    for _ in range(60):
        commands = np.column_stack((random.uniform(0.0, 0.8, 6), np.zeros(6), random.uniform(-1.0, 1.0, 6)))
        snapshot = simulator.advance(commands, 10)
        met += sum(map(len, snapshot.contacts))
        shapes = outlines(snapshot, footprint)
        for k, shape in enumerate(shapes):
            gap = min(shape.distance(other) for n, other in enumerate(shapes) if n != k)
            wall = 4.95 - max(np.abs(shape.bounds).max(), 0.0)
            assert snapshot.clearances[k] == pytest.approx(min(gap, wall), abs=2e-3)
            deep = [shape.intersection(other).area for n, other in enumerate(shapes) if n != k]
            assert max(deep) < 1e-4
    assert met > 0


def test_lidar_sees_the_outline_of_a_teammate():
    body = replace(robot(), footprint=BOX, lidar=replace(robot().lidar, noise_std=0.0))
    simulator = alone(body)
    ahead = round(-body.lidar.angle_min / body.lidar.angle_increment)
    snapshot = simulator.reset([team((-1.0, 0.0, 0.0), (1.0, 0.0, 0.0))])
    mount = body.lidar.mount.x
    assert snapshot.ranges[0, ahead] == pytest.approx(2.0 - 0.25 - mount, abs=5e-3)
    turned = simulator.reset([team((-1.0, 0.0, 0.0), (1.0, 0.0, np.pi / 2))])
    assert turned.ranges[0, ahead] == pytest.approx(2.0 - 0.2 - mount, abs=5e-3)


def test_first_robot_with_teammates_out_of_reach_does_what_it_does_alone():
    body = replace(robot(), lidar=replace(robot().lidar, range_max=1.0))
    simulator, command = alone(body), (0.3, 0.0, 0.4)
    simulator.reset([team((-3.0, -3.0, 0.2))])
    one = drive(simulator, [command], 20)[-1]
    simulator.reset([team((-3.0, -3.0, 0.2), (3.0, 3.0, 0.2))])
    two = drive(simulator, [command, command], 20)[-1]
    for name in ("poses", "twists", "odometry_poses", "odometry_twists", "ranges"):
        assert np.array_equal(getattr(one, name)[0], getattr(two, name)[0])


def test_each_robot_has_noise_of_its_own():
    simulator = alone(robot())
    simulator.reset([team((-2.0, 0.0, 0.0), (2.0, 0.0, 0.0))])
    last = drive(simulator, [(0.3, 0.0, 0.0)] * 2, 10)[-1]
    assert not np.array_equal(last.odometry_poses[0], last.odometry_poses[1])


def test_a_world_of_a_team_among_others_is_what_it_is_alone():
    body, commands = replace(robot(), footprint=BOX), np.tile((0.5, 0.0, 0.1), (4, 1))
    first, second = team(*ring(4), name="a"), team(*ring(4, 1.0, 5), name="b")
    simulator = alone(body)
    simulator.reset([second])
    own = drive(simulator, commands, 30)
    simulator.reset([first, second])
    both = drive(simulator, np.tile(commands, (2, 1)), 30)
    assert any(contacts(own, row) for row in range(4))
    for row in range(4):
        assert contacts(own, row) == contacts(both, 4 + row)
    for name in ("poses", "ranges", "odometry_poses", "clearances", "contact_times"):
        assert np.array_equal(getattr(own[-1], name), getattr(both[-1], name)[4:])


def test_what_surely_meets_nothing_moves_as_if_it_were_looked_at():
    body, commands = replace(robot(), footprint=BOX), np.tile((0.6, 0.0, 0.2), (5, 1))
    ends = []
    for period in (0.01, 0.1):  # every tick is looked at alone, or ten are taken together
        people = component("pedestrians", "none", [])
        timing = ["simulator.inner_step=0.01", f"simulator.crowd_period={period}"]
        simulator = component("simulator", "sim2d", timing, robot=body, pedestrians=people)
        simulator.reset([team(*ring(5, 2.5))])
        ends.append(drive(simulator, commands, 60))
    assert any(contacts(ends[0], row) for row in range(5))
    for name in ("poses", "twists", "ranges", "clearances"):
        assert np.array_equal(getattr(ends[0][-1], name), getattr(ends[1][-1], name))


def test_fork_of_a_team_goes_on_bit_for_bit():
    simulator, commands = alone(robot()), np.tile((0.5, 0.0, 0.1), (4, 1))
    simulator.reset([team(*ring(4))])
    drive(simulator, commands, 8)
    fork = simulator.fork(Branches.of([0, 0]))
    branches = drive(fork, np.tile(commands, (2, 1)), 20)
    own = drive(simulator, commands, 20)
    assert any(contacts(own, row) for row in range(4))
    for row in range(8):
        assert contacts(branches, row) == contacts(own, row % 4)
    for name in ("poses", "ranges", "odometry_poses", "clearances"):
        assert np.array_equal(getattr(branches[-1], name), np.tile(getattr(own[-1], name).T, 2).T)


def test_fork_may_leave_single_robots_out():
    simulator = alone(robot())
    simulator.reset([team((-1.0, 0.0, 0.0), (0.0, 0.0, 0.0))])
    without = Branches(np.zeros(1, np.int64), np.zeros(1, np.uint64), np.array([[True, False]]))
    fork = simulator.fork(without)
    snapshots = drive(fork, [(0.5, 0.0, 0.0), (0.0, 0.0, 0.0)], 30)
    assert not contacts(snapshots, 0)
    assert snapshots[-1].poses[0, 0] > 0.0
    assert np.isnan(snapshots[-1].poses[1]).all()


def test_a_smaller_team_lacks_robots_in_its_rows():
    simulator = alone(robot())
    snapshot = simulator.reset([team((-1.0, 0.0, 0.0)), team((-1.0, 0.0, 0.0), (1.0, 0.0, 0.0), name="two")])
    assert snapshot.team == 2
    assert np.isnan(snapshot.poses[1]).all()
    assert np.isfinite(snapshot.poses[[0, 2, 3]]).all()
    assert snapshot.clearances[0] == pytest.approx(3.95 - RADIUS, abs=1e-3)


def test_starts_that_overlap_are_refused():
    simulator = alone(robot())
    with pytest.raises(ImpossibleScenario, match=r"robot1's start .* overlaps another robot|first robot's start"):
        simulator.reset([team((0.0, 0.0, 0.0), (0.1, 0.0, 0.0))])


def test_a_world_cannot_begin_again_with_a_larger_team():
    simulator = alone(robot())
    simulator.reset([team((-1.0, 0.0, 0.0))])
    with pytest.raises(ConfigurationError, match="has 2 robots; allowed: up to 1"):
        simulator.reset([team((-1.0, 0.0, 0.0), (1.0, 0.0, 0.0))], np.array([0]))


def mixed(*starts, bodies):
    """Return a scenario with a robot at each start, teammates with bodies of their own."""
    problem = team(*starts)
    mates = (replace(mate, robot="other", body=body) for mate, body in zip(problem.team, bodies, strict=True))
    return replace(problem, team=tuple(mates))


def test_robots_of_several_types_touch_where_their_own_outlines_meet():
    small, large = robot(), replace(robot(), footprint=BOX, name="large")
    simulator = alone(small)
    simulator.reset([mixed((-1.0, 0.0, 0.0), (1.0, 0.0, np.pi), bodies=[large])])
    snapshots = drive(simulator, [(0.5, 0.0, 0.0)] * 2, 30)
    apart = snapshots[-1].poses[1, 0] - snapshots[-1].poses[0, 0]
    assert apart == pytest.approx(RADIUS + 0.25, abs=1e-3)
    assert [len(contacts(snapshots, row)) for row in range(2)] == [1, 1]
    assert snapshots[-1].clearances == pytest.approx([0.0, 0.0], abs=1e-3)


def test_each_type_has_its_own_limits_and_lidar():
    fast = replace(
        robot(),
        name="fast",
        limits=replace(robot().limits, vx_max=2.0),
        lidar=replace(robot().lidar, beams=90, angle_increment=math.radians(4.0), range_max=2.0, noise_std=0.0),
    )
    simulator = alone(robot())
    simulator.reset([mixed((-3.0, -4.0, 0.0), (-3.0, 4.0, 0.0), bodies=[fast])])
    last = drive(simulator, [(5.0, 0.0, 0.0)] * 2, 20)[-1]
    assert last.twists[:, 0] == pytest.approx([robot().limits.vx_max, 2.0])
    own, other = last.sensors(0).scan, last.sensors(1).scan
    assert (len(own.ranges), len(other.ranges)) == (robot().lidar.beams, 90)
    assert other.range_max == 2.0
    assert other.ranges[np.isfinite(other.ranges)].max() <= 2.0


def test_a_type_among_others_does_what_it_does_alone():
    box = replace(robot(), name="box", footprint=BOX, lidar=replace(robot().lidar, beams=180, range_max=1.0))
    simulator = alone(box)
    simulator.reset([team((-3.0, -3.0, 0.2))])
    own = drive(simulator, [(0.3, 0.0, 0.4)], 20)[-1]
    simulator.reset([mixed((-3.0, -3.0, 0.2), (3.0, 3.0, 0.2), bodies=[robot()])])
    among = drive(simulator, [(0.3, 0.0, 0.4), (0.1, 0.0, 0.0)], 20)[-1]
    for name in ("poses", "twists", "odometry_poses"):
        assert np.array_equal(getattr(own, name)[0], getattr(among, name)[0])
    assert np.array_equal(own.sensors(0).scan.ranges, among.sensors(0).scan.ranges)


def test_fork_of_several_types_goes_on_bit_for_bit():
    box = replace(robot(), name="box", footprint=BOX)
    simulator, commands = alone(robot()), np.tile((0.5, 0.0, 0.1), (3, 1))
    simulator.reset([mixed(*ring(3), bodies=[box, box])])
    drive(simulator, commands, 8)
    branch = drive(simulator.fork(Branches.of([0])), commands, 20)[-1]
    own = drive(simulator, commands, 20)[-1]
    for name in ("poses", "ranges", "clearances"):
        assert np.array_equal(getattr(branch, name), getattr(own, name))


def test_a_world_that_begins_again_has_types_that_are_known():
    box = replace(robot(), name="box", footprint=BOX)
    simulator = alone(robot())
    simulator.reset([mixed((-1.0, 0.0, 0.0), (1.0, 0.0, 0.0), bodies=[box])])
    simulator.reset([mixed((-2.0, 0.0, 0.0), (1.0, 0.0, 0.0), bodies=[box])], np.array([0]))
    with pytest.raises(ConfigurationError, match="has a other; allowed:"):
        simulator.reset([mixed((-2.0, 0.0, 0.0), (1.0, 0.0, 0.0), bodies=[replace(box, name="new")])], np.array([0]))
