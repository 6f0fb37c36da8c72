from dataclasses import replace

import numpy as np
import pytest
from shapely.geometry import Point, Polygon
from shapely.ops import unary_union

from arena_core import Footprint, Obstacle, Pose
from arena_core.testing import robot, scenario
from arena_core.testing.samples import person

WALL = 4.95  # m; the inner face of the room's walls
DEEPEST = 0.005  # m; of what touches
BOX = Footprint.polygon([[0.25, -0.2], [0.25, 0.2], [-0.25, 0.2], [-0.25, -0.2]])
DRIVES = pytest.mark.parametrize("drive", ["planar", "wheels"])


def run(simulator, command, seconds):
    return [simulator.advance(np.array([command], float), 10) for _ in range(round(seconds / 0.1))]


def contacts(snapshots):
    return [contact for snapshot in snapshots for contact in snapshot.contacts[0]]


def at(x, y=0.0, theta=0.0, people=(), obstacles=()):
    return replace(scenario(start=Pose(x, y, theta), people=people), obstacles=tuple(obstacles))


@DRIVES
def test_robot_stops_where_it_touches_the_wall(simulate, drive):
    simulator = simulate(robot(), f"simulator.drive={drive}")
    simulator.reset([at(4.0)])
    snapshots = run(simulator, (1.0, 0.0, 0.0), 3.0)
    assert snapshots[-1].poses[0, 0] == pytest.approx(WALL - 0.2, abs=DEEPEST)
    assert snapshots[-1].in_contact[0]
    first = contacts(snapshots)[0]
    assert (first.kind, first.person, first.caused) == ("wall", -1, True)
    assert first.speed == pytest.approx(1.0, abs=0.02)
    assert (first.x, first.y) == pytest.approx((WALL - 0.2, 0.0), abs=0.02)


def test_one_long_touch_of_a_planar_base_is_one_event(simulate):
    simulator = simulate(robot())
    simulator.reset([at(4.0)])
    snapshots = run(simulator, (1.0, 0.0, 0.0), 3.0)
    (contact,) = contacts(snapshots)
    assert sum(snapshot.contact_times[0] for snapshot in snapshots) == pytest.approx(3.0 - contact.stamp, abs=0.011)


@DRIVES
def test_blocked_robot_can_drive_away(simulate, drive):
    simulator = simulate(robot(), f"simulator.drive={drive}")
    simulator.reset([at(4.6)])
    assert contacts(run(simulator, (1.0, 0.0, 0.0), 1.0))
    away = run(simulator, (-0.5, 0.0, 0.0), 1.5)
    assert away[-1].clearances[0] > 0.2
    assert not away[-1].in_contact[0]


@pytest.mark.parametrize(
    "obstacle",
    [
        Obstacle(np.array([[1.0, 0.0]]), 0.3),
        Obstacle(np.array([[0.7, -0.5], [1.2, -0.5], [1.2, 0.5], [0.7, 0.5]])),
        Obstacle(np.array([[0.7, -0.5], [1.5, -0.5], [1.5, 0.5], [0.7, 0.5], [1.2, 0.0]])),
    ],
)
def test_robot_stops_at_an_obstacle(simulate, obstacle):
    simulator = simulate(robot())
    simulator.reset([at(0.0, obstacles=[obstacle])])
    snapshots = run(simulator, (1.0, 0.0, 0.0), 2.5)
    assert {contact.kind for contact in contacts(snapshots)} == {"obstacle"}
    nook = 0.79 if len(obstacle.vertices_xy) == 5 else 0.5  # in the last one's nook the disc touches both sides
    assert snapshots[-1].poses[0, 0] == pytest.approx(nook, abs=0.2 if nook > 0.5 else DEEPEST)


def test_person_who_walks_into_a_standing_robot_caused_the_contact(simulate):
    simulator = simulate(robot())
    simulator.reset([at(0.0, people=[person(7, 1.5, 0.0, (-3.0, 0.0), (3.0, 0.0), speed=1.0)])])
    snapshots = run(simulator, (0.0, 0.0, 0.0), 2.0)
    (contact,) = contacts(snapshots)
    assert (contact.kind, contact.person, contact.caused) == ("person", 7, False)
    assert contact.speed == pytest.approx(1.0, abs=0.2)
    assert np.hypot(*snapshots[-1].poses[0, :2]) < DEEPEST  # people do not push robots


@DRIVES
def test_robot_that_drives_into_a_standing_person_caused_the_contact(simulate, drive):
    simulator = simulate(robot(), f"simulator.drive={drive}")
    simulator.reset([at(-1.0, people=[person(3, 0.5, 0.0)])])
    snapshots = run(simulator, (0.5, 0.0, 0.0), 3.0)
    contact = contacts(snapshots)[0]
    assert (contact.kind, contact.person, contact.caused) == ("person", 3, True)
    assert contact.speed == pytest.approx(0.5, abs=0.05)
    assert np.hypot(*(snapshots[-1].poses[0, :2] - snapshots[-1].crowd.positions[0, 0])) > 0.5 - DEEPEST


@DRIVES
@pytest.mark.parametrize("kinematics", ["differential", "omnidirectional", "ackermann"])
@pytest.mark.parametrize("footprint", [Footprint.circle(0.2), BOX])
def test_bodies_are_never_deeper_than_5_mm_in_each_other(simulate, crowded, drive, kinematics, footprint):
    body = replace(robot(kinematics), footprint=footprint)
    simulator = simulate(body, f"simulator.drive={drive}")
    simulator.reset([crowded(seed) for seed in range(4)])
    random = np.random.default_rng(5)
    solids = unary_union([Point(1.2, 0.0).buffer(0.2, 64), Polygon([[-1.5, -0.4], [-1.0, 0.0], [-1.5, 0.4]])])
    hall = Polygon([(-WALL, -WALL), (WALL, -WALL), (WALL, WALL), (-WALL, WALL)]).buffer(DEEPEST, join_style="mitre")
    touched = 0
    for step in range(200):
        if step % 40 == 0:
            commands = random.uniform(-1.0, 1.0, (4, 3)) * (1.5, 1.0, 2.0)
        snapshot = simulator.advance(commands, 2)
        touched += sum(map(len, snapshot.contacts))
        assert not snapshot.failures
        for k in range(4):
            shape = Point(snapshot.poses[k, :2]).buffer(0.2, 64)
            if not footprint.is_circle:
                x, y, theta = snapshot.poses[k]
                c, s = np.cos(theta), np.sin(theta)
                shape = Polygon(footprint.vertices_xy @ np.array([[c, s], [-s, c]]) + (x, y))
            assert shape.difference(hall).area < 1e-9
            assert shape.intersection(solids.buffer(-DEEPEST)).area < 1e-9
            apart = [shape.distance(Point(xy)) for xy in snapshot.crowd.positions[k]]
            assert min(np.array(apart) - snapshot.crowd.world(k).radii) > -DEEPEST
    assert touched > 5
