"""Doors in 3-D: as in the plane they open at their ticks, are seen and met while closed, and close on no one."""

from dataclasses import replace

import numpy as np
import pytest

from arena_core import Branches, Pose
from arena_core.scenes import Door, is_open
from arena_core.testing import robot, scenario
from arena_core.testing.samples import person

STAY, DRIVE = np.array([[0.0, 0.0, 0.0]]), np.array([[0.5, 0.0, 0.0]])
RADIUS = robot().footprint.radius


def door(*intervals, period=None, x=1.0):
    """A door 0.1 m thick across the robot's way, whose near side is at x."""
    return Door(np.array([[x, -1.0], [x + 0.1, -1.0], [x + 0.1, 1.0], [x, 1.0]]), np.array(intervals), period)


def behind(*doors, start=None, people=()):
    return replace(scenario(start=start or Pose(0.0, 0.0, 0.0), people=people), doors=doors)


def test_a_door_opens_and_closes_at_its_ticks(simulate):
    leaf, simulator = door((0.1, 0.3), period=0.5), simulate(robot())
    simulator.reset([behind(leaf)])
    found = [bool(simulator.advance(STAY, 1).doors_open[0, 0]) for _ in range(100)]
    assert found == [is_open(leaf, 0.01 * tick) for tick in range(1, 101)]


@pytest.mark.parametrize("lidar", ["slice", "rays"])
def test_a_lidar_sees_a_closed_door_and_none_that_is_open(simulate, lidar):
    body = replace(robot(), lidar=replace(robot().lidar, noise_std=0.0))
    simulator, ahead = simulate(body, f"simulator.lidar={lidar}"), body.lidar.beams // 2
    closed = simulator.reset([behind(door((0.5, 1.0)), people=[person(1, -3.0, 3.0)])]).ranges[0, ahead]
    opened = simulator.advance(STAY, 50).ranges[0, ahead]
    again = simulator.advance(STAY, 50).ranges[0, ahead]
    assert closed == pytest.approx(1.0 - body.lidar.mount.x, abs=1e-4)
    assert again == pytest.approx(closed, abs=1e-4)
    assert opened > 4.0


@pytest.mark.parametrize("drive", ["planar", "wheels"])
def test_a_robot_that_pushes_a_closed_door_touches_it_and_drives_on_once_it_opens(simulate, drive):
    simulator = simulate(robot(), f"simulator.drive={drive}")
    simulator.reset([behind(door((4.0, 20.0)), people=[person(1, -3.0, 3.0)])])
    before = [simulator.advance(DRIVE, 10) for _ in range(39)]
    contacts = [contact for snapshot in before for contact in snapshot.contacts[0]]
    assert {contact.kind for contact in contacts} == {"obstacle"}
    assert len(contacts) == (1 if drive == "planar" else 2)  # tyres rebound once, as from any obstacle
    assert before[-1].in_contact[0]
    assert before[-1].poses[0, 0] == pytest.approx(1.0 - RADIUS, abs=5e-3)
    after = [simulator.advance(DRIVE, 10) for _ in range(50)]
    assert not any(snapshot.contacts[0] for snapshot in after)
    assert after[-1].poses[0, 0] > 2.0


def test_a_door_stays_open_while_the_robot_stands_in_it(simulate):
    simulator = simulate(robot())
    simulator.reset([behind(door((0.0, 0.1)), start=Pose(1.05, 0.0, 0.0))])
    assert all(simulator.advance(STAY, 1).doors_open[0, 0] for _ in range(100))
    left = [simulator.advance(DRIVE, 1) for _ in range(200)]
    closed = next(snapshot for snapshot in left if not snapshot.doors_open[0, 0])
    assert closed.poses[0, 0] == pytest.approx(1.1 + RADIUS, abs=0.011)
    assert not any(snapshot.contacts[0] for snapshot in left)


def test_forks_go_on_bit_for_bit_with_the_doors_as_they_are(simulate):
    simulator = simulate(robot())
    two = behind(door((0.0, 0.5), (1.0, 1.5), period=2.0), people=[person(1, 1.05, 0.5)])
    simulator.reset([behind(), two])
    drive = np.array([[0.3, 0.0, 0.1], [0.4, 0.0, -0.1]])
    simulator.advance(drive, 70)
    forked = simulator.fork(Branches.of([1, 0], [0, 0]))
    for _ in range(30):
        own, other = simulator.advance(drive, 10), forked.advance(drive[::-1], 10)
        assert (own.doors_open == other.doors_open[::-1]).all()
        for name in ("poses", "clearances", "ranges", "odometry_poses"):
            assert (getattr(own, name) == getattr(other, name)[::-1]).all(), name


def test_a_depth_camera_sees_a_closed_door_and_none_that_is_open(simulate):
    camera = ["simulator.depth_camera.enabled=true", "simulator.depth_camera.noise=0"]
    simulator = simulate(robot(), *camera)
    closed = simulator.reset([behind(door((0.5, 1.0)))])
    opened = simulator.advance(STAY, 60)
    nearest = [np.nanmin(seen.sensors(0).depth.points()[12:18, :, 0]) for seen in (closed, opened)]
    assert nearest[0] == pytest.approx(1.0, abs=0.05)
    assert nearest[1] > 1.5
