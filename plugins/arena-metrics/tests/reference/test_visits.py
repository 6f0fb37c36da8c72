"""When people came to their waypoints."""

import numpy as np
import pytest

from arena_core import PedestrianSpec
from arena_reference.visits import REACH, find_visits, routes_of, walked_lengths


def spec(number, waypoints, **behaviour):
    return PedestrianSpec(number, np.zeros(2), np.array(waypoints, float).reshape(-1, 2), 1.0, 0.3, behaviour)


def visits_of(walks, specs):
    """Return the visits of people whose ``walks`` (P, R, 2) have a row a second, in one world."""
    positions = np.array(walks, float).transpose(1, 0, 2)[:, None]
    routes = routes_of({one.id: one for one in specs}, np.array([one.id for one in specs], np.int32))
    return find_visits(np.arange(len(positions), dtype=float), positions, routes)


def along(*places):
    return [(x, 0.0) for x in places]


def test_a_visit_begins_where_a_walker_comes_within_reach():
    found = visits_of([along(0, 1, 2, 3, 4)], [spec(1, [(4, 0), (0, 0)])])
    assert found.stamps[:, 0, 0].tolist() == [pytest.approx(4.0 - REACH)]
    assert found.lengths[0, 0, 0] == pytest.approx(4.0 - REACH)
    assert found.in_hand(2.0).tolist() == [0]
    assert found.missing(found.in_hand(4.0)).tolist() == [[True]]


def test_waypoints_are_visited_in_the_order_of_the_loop():
    found = visits_of([along(0, 4, 8, 4, 0)], [spec(1, [(8, 0), (4, 0), (0, 0)])])
    assert found.waypoints[:, 0, 0].tolist() == [0, 1, 2]


def test_who_draws_the_next_waypoint_visits_any_other():
    found = visits_of([along(0, 4, 8, 4, 0)], [spec(1, [(8, 0), (4, 0), (0, 0)], waypoint_mode=1)])
    assert found.waypoints[:, 0, 0].tolist() == [2, 1, 0, 1, 2]


def test_a_waypoint_that_was_given_up_is_no_visit():
    found = visits_of([along(0, 4, 8, 12)], [spec(1, [(20, 0), (4, 0), (8, 0), (12, 0)])])
    assert found.waypoints[:, 0, 0].tolist() == [1, 2, 3]


def test_any_of_a_group_comes_for_all():
    walks = [along(0, 1, 2, 2), along(0, 2, 4, 4)]
    found = visits_of(walks, [spec(1, [(4, 0), (0, 0)], group=3), spec(2, [(9, 9)], group=3)])
    assert found.stamps[0, 0].tolist() == [pytest.approx(found.stamps[0, 0, 1])] * 2


def test_who_vanishes_or_has_no_waypoint_visits_none():
    gone = [(0, 0), (1, 0), (np.nan, np.nan), (np.nan, np.nan)]
    found = visits_of([gone, along(4, 4, 4, 4)], [spec(1, [(4, 0)]), spec(2, [])])
    assert len(found.stamps) == 0


def test_vanishing_is_no_walk():
    positions = np.array([(0, 0), (1, 0), (np.nan, np.nan), (9, 0), (9, 2)], float)[:, None, None]
    assert walked_lengths(positions)[:, 0, 0].tolist() == [0.0, 1.0, 1.0, 1.0, 3.0]
