from dataclasses import replace

import numpy as np
import pytest
from shapely.geometry import Point, Polygon
from shapely.ops import unary_union

from arena_core import Footprint, Obstacle, Pose
from arena_core.testing import robot, scenario
from arena_core.testing.samples import person

WALL = 4.95  # m; the inner face of the room's walls
BOX = Footprint.polygon([[0.25, -0.2], [0.25, 0.2], [-0.25, 0.2], [-0.25, -0.2]])


def drive(simulator, command, seconds):
    return [simulator.advance(np.array([command], float), 10) for _ in range(round(seconds / 0.1))]


def contacts(snapshots):
    return [contact for snapshot in snapshots for contact in snapshot.contacts[0]]


def at(body, x, y=0.0, theta=0.0, people=(), obstacles=()):
    return replace(scenario(start=Pose(x, y, theta), people=people), obstacles=tuple(obstacles))


def test_robot_stops_where_it_touches_the_wall(simulate):
    simulator = simulate(robot())
    simulator.reset([at(robot(), 4.0)])
    snapshots = drive(simulator, (1.0, 0.0, 0.0), 3.0)
    assert snapshots[-1].poses[0, 0] == pytest.approx(WALL - 0.2, abs=1e-3)
    assert snapshots[-1].clearances[0] == pytest.approx(0.0, abs=1e-3)
    assert not snapshots[-1].twists[0].any()
    assert snapshots[-1].in_contact[0]


def test_one_long_touch_is_one_event(simulate):
    simulator = simulate(robot())
    simulator.reset([at(robot(), 4.0)])
    snapshots = drive(simulator, (1.0, 0.0, 0.0), 3.0)
    (contact,) = contacts(snapshots)
    assert (contact.kind, contact.person, contact.caused) == ("wall", -1, True)
    assert contact.speed == pytest.approx(1.0)
    assert (contact.x, contact.y) == pytest.approx((WALL - 0.2, 0.0), abs=0.02)
    pressed = sum(snapshot.contact_times[0] for snapshot in snapshots)
    assert pressed == pytest.approx(3.0 - contact.stamp, abs=0.011)


def test_blocked_robot_can_drive_away_and_touch_again(simulate):
    simulator = simulate(robot())
    simulator.reset([at(robot(), 4.6)])
    touching = drive(simulator, (1.0, 0.0, 0.0), 1.0)
    away = drive(simulator, (-0.5, 0.0, 0.0), 1.0)
    again = drive(simulator, (1.0, 0.0, 0.0), 1.5)
    assert away[-1].clearances[0] > 0.2
    assert not away[-1].in_contact[0]
    assert len(contacts(touching)) == len(contacts(again)) == 1
    assert not contacts(away)


def test_blocked_robot_can_turn_and_leave_forwards(simulate):
    for body in (robot(), robot("omnidirectional")):
        simulator = simulate(body)
        simulator.reset([at(body, 4.5)])
        drive(simulator, (1.0, 0.0, 0.0), 1.0)
        drive(simulator, (1.0, 0.0, 2.0), 1.6)
        assert drive(simulator, (1.0, 0.0, 0.0), 1.0)[-1].clearances[0] > 0.3


def test_box_that_is_pressed_against_a_wall_can_back_off(simulate):
    body = replace(robot(), footprint=BOX)
    simulator = simulate(body)
    simulator.reset([at(body, 4.5, theta=0.3)])
    pressed = drive(simulator, (1.0, 0.0, 1.0), 2.0)
    assert pressed[-1].clearances[0] < 2e-3
    assert drive(simulator, (-0.5, 0.0, 0.0), 1.0)[-1].clearances[0] > 0.1


def test_side_that_turns_into_an_obstacle_meets_it_with_the_speed_of_that_place(simulate):
    body = replace(robot(), footprint=BOX)
    simulator = simulate(body)
    simulator.reset([at(body, 0.0, obstacles=[Obstacle(np.array([[0.15, 0.32]]), 0.1)])])  # 0.02 m beside the box
    (contact,) = contacts(drive(simulator, (0.0, 0.0, 2.0), 1.0))
    turned = np.arccos(0.3 / np.hypot(0.15, 0.32)) - np.arctan2(0.15, 0.32)  # until the disc is 0.3 m from the axis
    along = 0.15 * np.cos(turned) + 0.32 * np.sin(turned)  # where on the side that is
    assert contact.kind == "obstacle"
    assert contact.speed == pytest.approx(along * np.sqrt(2.0 * body.limits.alpha_max * turned), rel=0.05)


@pytest.mark.parametrize(
    "obstacle",
    [Obstacle(np.array([[1.0, 0.0]]), 0.3), Obstacle(np.array([[0.7, -0.5], [1.2, -0.5], [1.2, 0.5], [0.7, 0.5]]))],
)
def test_robot_stops_at_an_obstacle(simulate, obstacle):
    simulator = simulate(robot())
    simulator.reset([at(robot(), 0.0, obstacles=[obstacle])])
    snapshots = drive(simulator, (1.0, 0.0, 0.0), 2.0)
    assert [contact.kind for contact in contacts(snapshots)] == ["obstacle"]
    assert snapshots[-1].poses[0, 0] == pytest.approx(0.5, abs=1e-3)


def test_person_who_walks_into_a_standing_robot_caused_the_contact(simulate):
    simulator = simulate(robot())
    simulator.reset([at(robot(), 0.0, people=[person(7, 1.5, 0.0, (-3.0, 0.0), (3.0, 0.0), speed=1.0)])])
    (contact,) = contacts(drive(simulator, (0.0, 0.0, 0.0), 2.0))
    assert (contact.kind, contact.person, contact.caused) == ("person", 7, False)
    assert contact.speed == pytest.approx(1.0, abs=0.2)


def test_contact_names_who_walked_into_the_robot_also_where_that_is_not_the_first(simulate):
    simulator = simulate(robot())
    people = [person(3, -3.0, -3.0), person(7, 1.5, 0.0, (-3.0, 0.0), (3.0, 0.0), speed=1.0)]
    simulator.reset([at(robot(), 0.0, people=people)])
    (contact,) = contacts(drive(simulator, (0.0, 0.0, 0.0), 2.0))
    assert (contact.kind, contact.person) == ("person", 7)


def test_robot_that_drives_into_a_standing_person_caused_the_contact(simulate):
    simulator = simulate(robot())
    simulator.reset([at(robot(), -1.0, people=[person(3, 0.5, 0.0)])])
    snapshots = drive(simulator, (0.5, 0.0, 0.0), 3.0)
    (contact,) = contacts(snapshots)
    assert (contact.kind, contact.person, contact.caused) == ("person", 3, True)
    assert contact.speed == pytest.approx(0.5, abs=0.05)
    assert snapshots[-1].clearances_people[0] == pytest.approx(0.0, abs=1e-3)


def test_person_slips_past_a_robot_that_it_ignores(simulate):
    simulator = simulate(robot())
    simulator.reset([at(robot(), 0.0, people=[person(1, 1.5, 0.1, (-3.0, 0.1), (3.0, 0.1), speed=1.0)])])
    snapshots = drive(simulator, (0.0, 0.0, 0.0), 6.0)
    assert min(snapshot.crowd.positions[0, 0, 0] for snapshot in snapshots) < -1.0
    assert len(contacts(snapshots)) >= 1


def test_person_is_not_pushed_into_a_wall(simulate):
    simulator = simulate(robot())
    simulator.reset([at(robot(), 3.5, people=[person(1, 4.6, 0.0)])])
    snapshots = drive(simulator, (1.0, 0.0, 0.0), 3.0)
    assert snapshots[-1].crowd.positions[0, 0].tolist() == pytest.approx([4.6, 0.0], abs=0.06)
    assert snapshots[-1].poses[0, 0] < 4.6 - 0.5 + 0.06


@pytest.mark.parametrize("kinematics", ["differential", "omnidirectional", "ackermann"])
@pytest.mark.parametrize("footprint", [Footprint.circle(0.2), BOX])
def test_bodies_never_interpenetrate(simulate, crowded, kinematics, footprint):
    body = replace(robot(kinematics), footprint=footprint)
    simulator = simulate(body)
    worlds = [crowded(seed) for seed in range(6)]
    simulator.reset(worlds)
    random = np.random.default_rng(5)
    solids = unary_union([Point(1.2, 0.0).buffer(0.2, 64), Polygon([[-1.5, -0.4], [-1.0, 0.0], [-1.5, 0.4]])])
    hall = Polygon([(-WALL, -WALL), (WALL, -WALL), (WALL, WALL), (-WALL, WALL)])
    touched = 0
    for step in range(400):
        if step % 40 == 0:
            commands = random.uniform(-1.0, 1.0, (6, 3)) * (1.5, 1.0, 2.0)
        snapshot = simulator.advance(commands, 2)
        touched += sum(map(len, snapshot.contacts))
        for k in range(6):
            shape = Point(snapshot.poses[k, :2]).buffer(0.2, 64)
            if not footprint.is_circle:
                x, y, theta = snapshot.poses[k]
                c, s = np.cos(theta), np.sin(theta)
                shape = Polygon(footprint.vertices_xy @ np.array([[c, s], [-s, c]]) + (x, y))
            assert shape.difference(hall).area < 1e-9
            assert shape.intersection(solids).area < 1e-9
            gaps = [
                shape.distance(Point(xy)) - radius
                for xy, radius in zip(snapshot.crowd.positions[k], snapshot.crowd.radii[k], strict=True)
            ]
            assert min(gaps) > -1e-4  # the inscribed polygon that stands for the disc lies up to 1e-4 m inside it
            assert snapshot.clearances_people[k] == pytest.approx(max(min(gaps), 0.0), abs=2e-4)
            assert solids.distance(Point(snapshot.crowd.positions[k, 0])) > 0.3 - 1e-3
    assert touched > 10


def test_blocked_car_does_not_turn_on_the_spot(simulate, crowded):
    body = robot("ackermann")
    tightest = np.tan(body.steering_max) / body.wheelbase
    simulator = simulate(body)
    before = simulator.reset([crowded(seed) for seed in range(8)])
    touched = 0
    for _ in range(300):
        after = simulator.advance(np.tile((1.0, 0.0, 2.0), (8, 1)), 1)
        turned = np.abs((after.poses[:, 2] - before.poses[:, 2] + np.pi) % (2 * np.pi) - np.pi)
        moved = np.hypot(*(after.poses - before.poses)[:, :2].T)
        assert (turned <= tightest * moved * (1 + 1e-3) + 1e-12).all()
        touched += after.in_contact.sum()
        before = after
    assert touched > 0
