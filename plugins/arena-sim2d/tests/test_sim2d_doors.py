"""Doors in the plane: they open and close at their ticks, are seen and met while closed, and close on no one."""

from dataclasses import replace

import numpy as np
import pytest

from arena_core import Branches, Pose
from arena_core.scenes import Door, is_open
from arena_core.testing import robot, scenario
from arena_core.testing.samples import person

NOW, TICK = np.zeros((1, 3)), 0.01
STAY = np.array([[0.0, 0.0, 0.0]])


def door(*intervals, period=None, x=1.0, half=1.0):
    """A door 0.1 m thick across the robot's way, whose near side is at x."""
    return Door(np.array([[x, -half], [x + 0.1, -half], [x + 0.1, half], [x, half]]), np.array(intervals), period)


def behind(*doors, start=None, people=()):
    return replace(scenario(start=start or Pose(0.0, 0.0, 0.0), people=people), doors=doors)


def states(simulator, ticks):
    """Return which doors are open after each of so many ticks."""
    return np.array([simulator.advance(STAY, 1).doors_open[0] for _ in range(ticks)])


@pytest.mark.parametrize(("intervals", "period"), [([(0.05, 0.2)], None), ([(0.0, 0.07), (0.1, 0.16)], 0.3)])
def test_a_door_opens_and_closes_at_its_ticks(simulate, intervals, period):
    leaf, simulator = door(*intervals, period=period), simulate(robot())
    begun = simulator.reset([behind(leaf)])
    assert begun.doors_open.tolist() == [[is_open(leaf, 0.0)]]
    found = states(simulator, 100)[:, 0]
    assert found.tolist() == [is_open(leaf, TICK * tick) for tick in range(1, 101)]
    first, last = (5, 19) if period is None else (10, 15)
    assert (found[first - 2], found[first - 1], found[last - 1], found[last]) == (False, True, True, False)


def test_a_lidar_sees_a_closed_door_and_none_that_is_open(simulate, alter):
    body = alter(robot(), "lidar", noise_std=0.0)
    simulator, ahead = simulate(body), body.lidar.beams // 2
    closed = simulator.reset([behind(door((0.5, 1.0)))]).ranges[0, ahead]
    opened = simulator.advance(STAY, 50).ranges[0, ahead]
    again = simulator.advance(STAY, 50).ranges[0, ahead]
    away = simulate(body).reset([behind()]).ranges[0]
    assert closed == again == pytest.approx(1.0 - body.lidar.mount.x, abs=1e-5)
    assert opened == away[ahead] > 4.0


def test_a_robot_that_pushes_a_closed_door_touches_it_once_and_drives_on_once_it_opens(simulate):
    simulator = simulate(robot())
    start = simulator.reset([behind(door((4.0, 9.0)))])
    radius = robot().footprint.radius
    assert start.clearances[0] == pytest.approx(1.0 - radius)
    drive = np.array([[0.5, 0.0, 0.0]])
    before = [simulator.advance(drive, 10) for _ in range(39)]
    contacts = [contact for snapshot in before for contact in snapshot.contacts[0]]
    assert [contact.kind for contact in contacts] == ["obstacle"]
    assert contacts[0].stamp == pytest.approx(2.0 * (1.0 - radius), abs=0.5)
    assert before[-1].in_contact[0]
    assert before[-1].poses[0, 0] == pytest.approx(1.0 - radius, abs=1e-3)
    after = [simulator.advance(drive, 10) for _ in range(50)]
    assert not after[1].in_contact[0]
    assert not any(snapshot.contacts[0] for snapshot in after)
    assert after[-1].poses[0, 0] > 2.0


def test_a_door_stays_open_while_the_robot_stands_in_it(simulate):
    simulator = simulate(robot())
    simulator.reset([behind(door((0.0, 0.1)), start=Pose(1.05, 0.0, 0.0))])
    assert states(simulator, 100).all()
    drive, radius = np.array([[0.5, 0.0, 0.0]]), robot().footprint.radius
    left = [simulator.advance(drive, 1) for _ in range(200)]
    closed = next(snapshot for snapshot in left if not snapshot.doors_open[0, 0])
    assert closed.poses[0, 0] == pytest.approx(1.1 + radius, abs=0.011)  # two ticks at the most
    assert not any(snapshot.contacts[0] for snapshot in left)


def test_a_door_stays_open_while_a_person_stands_in_it(simulate):
    stands, simulator = person(1, 1.05, 0.5), simulate(robot())
    simulator.reset([behind(door((0.0, 0.1)), people=[stands])])
    assert states(simulator, 200).all()
    walks = person(1, 1.05, 0.5, (3.0, 0.5), speed=1.0)
    simulator.reset([behind(door((0.0, 0.1)), people=[walks])])
    snapshots = [simulator.advance(STAY, 1) for _ in range(300)]
    closed = next(snapshot for snapshot in snapshots if not snapshot.doors_open[0, 0])
    assert closed.crowd.positions[0, 0, 0] == pytest.approx(1.1 + 0.3, abs=0.02)


def test_a_person_waits_before_a_closed_door_and_goes_through_once_it_opens(simulate):
    walks, simulator = person(1, 2.5, 0.0, (-3.0, 0.0), speed=1.0), simulate(robot())
    simulator.reset([behind(door((4.0, 20.0), half=4.9), people=[walks], start=Pose(0.0, 3.0, 0.0))])
    waiting = simulator.advance(STAY, 399)
    assert waiting.crowd.positions[0, 0, 0] >= 1.4 - 1e-6
    assert simulator.advance(STAY, 500).crowd.positions[0, 0, 0] < 0.0


def test_forks_go_on_bit_for_bit_with_the_doors_as_they_are(simulate):
    simulator = simulate(robot())
    two = behind(door((0.0, 0.5), (1.0, 1.5), period=2.0), door((0.3, 0.4), x=-1.0), people=[person(1, 1.05, 0.5)])
    simulator.reset([behind(), two])
    drive = np.array([[0.3, 0.0, 0.1], [0.4, 0.0, -0.1]])
    simulator.advance(drive, 70)
    forked = simulator.fork(Branches.of([1, 0], [0, 0]))
    for _ in range(30):
        own, other = simulator.advance(drive, 10), forked.advance(drive[::-1], 10)
        assert (own.doors_open == other.doors_open[::-1]).all()
        for name in ("poses", "clearances", "ranges", "odometry_poses"):
            assert (getattr(own, name) == getattr(other, name)[::-1]).all(), name


def test_a_world_among_others_has_the_doors_that_it_has_alone(simulate):
    worlds = [behind(), behind(door((0.2, 0.6)), door((0.0, 0.3), period=0.5, x=-1.0)), behind(door((0.4, 0.5)))]
    together, drive = simulate(robot()), np.array([[0.4, 0.0, 0.0]])
    together.reset(worlds)
    many = [together.advance(np.repeat(drive, 3, axis=0), 10) for _ in range(20)]
    for slot, world in enumerate(worlds):
        alone = simulate(robot())
        alone.reset([world])
        for snapshot in many:
            one = alone.advance(drive, 10)
            assert (one.ranges[0] == snapshot.ranges[slot]).all()
            assert snapshot.doors_open[slot, : len(world.doors)].tolist() == one.state(0).doors_open.tolist()


def test_worlds_that_begin_again_lose_the_doors_of_before(simulate):
    simulator = simulate(robot())
    simulator.reset([behind(door((5.0, 6.0))), behind(door((5.0, 6.0)))])
    simulator.reset([behind()], np.array([0]))
    drive = np.repeat(np.array([[1.0, 0.0, 0.0]]), 2, axis=0)
    for _ in range(20):
        last = simulator.advance(drive, 10)
    assert (last.poses[:, 0] > 1.0).tolist() == [True, False]
