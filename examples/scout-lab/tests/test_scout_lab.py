import dataclasses

import numpy as np
import pytest
from scout_lab.vfh_plus import candidate_sectors, room_in

from arena_core import ConfigurationError, LaserScan, NoValidCommand, Pose
from arena_core.testing import check, component, observation, record, robot

SCOUT = component("robot", "scout")


def around(near=()):
    """Return a scan all round in which the beams of these (first, last) degrees meet something at so many metres."""
    values = np.full(360, np.inf, np.float32)
    for first, last, distance in near:
        values[np.arange(first, last) % 360] = distance
    return LaserScan(0.0, 0.0, np.deg2rad(1.0), 0.15, 12.0, values, Pose(0.0, 0.0))


def command(near=(), waypoint_y=0.0):
    planner = component("planner", "vfh_plus", robot=SCOUT)
    seen = dataclasses.replace(observation(waypoint=Pose(2.0, waypoint_y)), scan=around(near), pose=Pose(0.0, 0.0))
    return planner.compute_velocity(seen)


@pytest.mark.parametrize("kind", ["planner", "metrics"])
def test_each_part_keeps_its_contract(kind):
    name = {"planner": "vfh_plus", "metrics": "hesitation"}[kind]
    context = {"robot": SCOUT} if kind == "planner" else {}
    assert check(kind, component(kind, name, **context), SCOUT)


def test_a_free_way_is_driven_straight_to_the_waypoint():
    free = command()
    assert free.vx > 1.0
    assert free.wz == 0.0
    assert command(waypoint_y=1.0).wz > 0.0


def test_it_turns_to_the_side_with_room():
    assert command([(-10, 45, 1.5)]).wz < 0.0
    assert command([(-45, 10, 1.5)]).wz > 0.0


def test_it_does_not_drive_into_what_is_ahead():
    assert command([(-60, 60, 0.45)]).vx == pytest.approx(0.0, abs=0.05)


def test_without_a_free_direction_there_is_no_command():
    with pytest.raises(NoValidCommand):
        command([(0, 360, 0.6)])


def test_a_car_is_refused():
    with pytest.raises(ConfigurationError, match="turn on the spot"):
        component("planner", "vfh_plus", robot=robot("ackermann"))


def test_a_point_blocks_the_directions_in_which_it_would_be_met():
    directions = np.deg2rad([0.0, 20.0, 40.0, 180.0])
    assert room_in(directions, np.array([1.0]), np.array([0.0]), 0.5).tolist() == [1.0, 1.0, np.inf, np.inf]


def test_narrow_valleys_are_passed_in_the_middle_and_wide_ones_beside_the_edge():
    blocked = np.ones(12, bool)
    blocked[[11, 0, 1]] = False
    assert candidate_sectors(blocked, 5).tolist() == [0]
    assert candidate_sectors(np.arange(12) >= 9, 4).tolist() == [2, 3, 4, 5, 6, 7]


def test_metrics_of_a_straight_drive():
    values = {metric.name: metric.compute(record()) for metric in component("metrics", "hesitation").metrics()}
    assert values == {"stops": 0.0, "standing_share": 0.0, "changes_of_side": 0.0}
