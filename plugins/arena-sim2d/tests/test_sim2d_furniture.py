"""Furniture in the plane: beams meet legs, low robots drive under tops, high ones and people are stopped by them."""

from dataclasses import replace

import numpy as np
import pytest

from arena_core import Furniture, Obstacle, Pose
from arena_core.testing import furniture, robot, scenario
from arena_core.testing.samples import person


def among(*pieces, start=None, people=()):
    drive = scenario(start=start or Pose(0.0, 0.0, 0.0), people=people)
    return replace(drive, world=replace(drive.world, furniture=pieces))


def run(simulator, vx, seconds):
    return [simulator.advance(np.array([[vx, 0.0, 0.0]]), 10) for _ in range(round(seconds / 0.1))]


def contacts(snapshots):
    return [contact for snapshot in snapshots for contact in snapshot.contacts[0]]


def test_beams_pass_under_a_table_between_its_legs(simulate):
    body = robot()
    table = furniture("table", 2.0, 0.0)
    ranges = simulate(body).reset([among(table)]).ranges[0]
    ahead = body.lidar.beams // 2
    assert ranges[ahead] == pytest.approx(4.95, abs=0.01)
    to_leg = np.hypot(2.0 - 0.73, 0.33) - 0.025
    assert ranges.min() == pytest.approx(to_leg, abs=0.01)


def test_lidar_above_the_top_sees_none_of_a_table(simulate):
    high, empty = simulate(robot(), "simulator.lidar_height=0.9"), simulate(robot())
    assert (high.reset([among(furniture("table", 2.0, 0.0))]).ranges == empty.reset([among()]).ranges).all()


def test_low_robot_drives_under_a_table(simulate):
    simulator = simulate(robot())
    simulator.reset([among(furniture("table", 2.0, 0.0))])
    snapshots = run(simulator, 1.0, 4.0)
    assert not contacts(snapshots)
    assert snapshots[-1].poses[0, 0] > 3.0


def test_high_robot_is_stopped_by_the_top_that_its_lidar_does_not_see(simulate):
    simulator = simulate(robot(), "simulator.robot_height=1.0")
    start = simulator.reset([among(furniture("table", 2.0, 0.0))])
    assert start.clearances[0] == pytest.approx(1.2 - 0.2)
    snapshots = run(simulator, 1.0, 4.0)
    assert {contact.kind for contact in contacts(snapshots)} == {"obstacle"}
    assert snapshots[-1].poses[0, 0] == pytest.approx(1.2 - 0.2, abs=1e-3)


def test_robot_touches_the_lowest_board_of_a_shelf(simulate):
    simulator = simulate(robot())
    simulator.reset([among(furniture("shelf", 2.0, 0.0, 0.5 * np.pi))])
    snapshots = run(simulator, 1.0, 4.0)
    assert snapshots[-1].poses[0, 0] == pytest.approx(2.0 - 0.2 - 0.2, abs=1e-3)
    assert contacts(snapshots)[0].kind == "obstacle"


def test_obstacle_is_touched_once_where_furniture_stands_elsewhere(simulate):
    simulator = simulate(robot())
    post = Furniture("post", Pose(3.0, 3.0, 0.0), np.empty((0, 7)), np.array([[0.0, 0.0, 0.2, 0.0, 2.5]]))
    simulator.reset([replace(among(post), obstacles=(Obstacle(np.array([[1.0, 0.0]]), 0.3),))])
    snapshots = run(simulator, 1.0, 2.0)
    assert [contact.kind for contact in contacts(snapshots)] == ["obstacle"]
    assert snapshots[-1].poses[0, 0] == pytest.approx(0.5, abs=1e-3)


def test_people_walk_round_a_table(simulate):
    simulator = simulate(robot())
    walker = person(1, 3.5, 0.0, (0.5, 0.0), (3.5, 0.0), speed=1.0)
    simulator.reset([among(furniture("table", 2.0, 0.0), start=Pose(-4.0, -4.0, 0.0), people=[walker])])
    at = np.array([snapshot.crowd.positions[0, 0] for snapshot in run(simulator, 0.0, 12.0)])
    inside = (np.abs(at[:, 0] - 2.0) < 0.8) & (np.abs(at[:, 1]) < 0.4)
    assert not inside.any()
    assert at[:, 0].min() < 1.0


def test_world_without_furniture_beside_one_with_it_is_as_alone(simulate):
    pair, alone = simulate(robot()), simulate(robot())
    pair.reset([among(furniture("chair", 2.0, 0.0)), among()])
    alone.reset([among()])
    commands = np.array([[0.5, 0.0, 0.3]])
    for _ in range(20):
        both, one = pair.advance(np.repeat(commands, 2, axis=0), 10), alone.advance(commands, 10)
    assert both.ranges[1].tobytes() == one.ranges[0].tobytes()
    assert both.poses[1].tobytes() == one.poses[0].tobytes()
