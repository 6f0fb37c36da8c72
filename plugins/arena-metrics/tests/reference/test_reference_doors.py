"""Doors in space-time: covered by discs while they are closed, waited for, and passed without a touch."""

import math

import numpy as np
import pytest

from arena_core.scenes import Door
from arena_reference.body import Walkers
from arena_reference.bounds import Bound
from arena_reference.doors import cover_outline, longest_wait, with_doors
from arena_reference.outlook import foresee
from arena_reference.ways import find_certified, rehearse

# across the walled room, whose walls are 5 m from its middle
LEAF = np.array([[0.0, -5.0], [0.1, -5.0], [0.1, 5.0], [0.0, 5.0]])


def door(*intervals, period=None, leaf=LEAF):
    return Door(leaf, np.array(intervals), period)


def test_discs_cover_an_outline_and_little_more() -> None:
    turn = np.array(((math.cos(0.3), math.sin(0.3)), (-math.sin(0.3), math.cos(0.3))))
    leaf = np.array([[0.0, 0.0], [1.2, 0.0], [1.2, 0.1], [0.0, 0.1]])
    centres, radius = cover_outline(leaf @ turn + (3.0, -2.0))
    inside = np.random.default_rng(0).uniform((0.0, 0.0), (1.2, 0.1), (500, 2)) @ turn + (3.0, -2.0)
    assert np.hypot(*(inside[:, None] - centres).transpose(2, 0, 1)).min(axis=1).max() <= radius
    assert (len(centres), radius) == (12, pytest.approx(0.05 * math.sqrt(2.0)))


def test_a_door_is_absent_only_where_it_is_open_before_and_after_too() -> None:
    nobody = Walkers(np.empty((9, 0, 2)), np.empty(0), 1.0, 0.1)
    seen = with_doors(nobody, [door((1.15, 1.62))], [False])
    assert np.isnan(seen.positions[:, 0, 0]).tolist() == [2 < k < 6 for k in range(9)]
    held = with_doors(nobody, [door((0.0, 0.5), (1.55, 3.0))], [True])
    assert np.isnan(held.positions[:, 0, 0]).all()


def test_a_robot_may_have_to_wait_for_the_next_opening() -> None:
    assert longest_wait([door((0.0, 3.0), (20.0, 25.0))], 4.0) == 16.0
    assert longest_wait([door((0.0, 3.0), period=20.0), door((2.0, 9.0))], 4.0) == 20.0


@pytest.mark.parametrize(("intervals", "period", "passes"), [([(6.0, math.inf)], None, 6.0), ([(0.1, 1.0)], 8.0, 8.1)])
def test_a_way_waits_for_a_door_and_is_driven_without_a_touch(stage, intervals, period, passes) -> None:
    made = stage(doors=[door(*intervals, period=period)])
    future = foresee(made.truth, made.finder.horizon(made.truth), 0.1)
    way = find_certified(made.truth, made.finder, future, 2)
    assert way is not None
    assert rehearse(made.truth, way).touched == math.inf
    stamps = way.start + way.period * np.arange(len(way.states))
    radius = made.robot.footprint.inscribed_radius
    begins = stamps[way.states[:, 0] > -radius]
    assert passes <= begins[0] <= passes + 0.6
    bound = Bound(made.robot, made.scenario, made.finder.site.terrain(made.scenario, 0.05))
    assert bound.time() <= way.arrival - 3.0  # doors count as open there


def test_without_an_opening_in_time_there_is_no_way(stage) -> None:
    made = stage(doors=[door((59.9, math.inf))])
    future = foresee(made.truth, made.finder.horizon(made.truth), 0.1)
    assert find_certified(made.truth, made.finder, future, 2) is None
