"""Each term of the band alone, against figures worked out by hand: the roots of all other weights are 0."""

import math

import numpy as np
import pytest

from arena_teb.problem import INTERVAL_ROWS, JOINT_ROWS, BandTerms, Ends, Penalties, Shape, Surroundings
from arena_teb.terms import evaluate_terms, make_rows

DISC = Shape(np.zeros((1, 2)), 0.15, 0.15, 0.15)
BOX = Shape(np.array([[0.2, -0.1], [0.2, 0.1], [-0.2, 0.1], [-0.2, -0.1]]), 0.05, 0.3, 0.15)
AWAY = np.inf
NONE = Penalties(
    **dict.fromkeys(("speed_min", "speed_max", "acceleration", "root_speed", "root_acceleration"), np.zeros(3)),
    **dict.fromkeys([name for name in Penalties._fields if name.startswith("root_")][2:], 0.0),
    **{"turn_radius": 0.0, "near": 0.2, "inflated": 0.5, "dynamic_near": 0.3, "dynamic_inflated": 0.6},
    exponent=1.0,
    unit=0.2,
)
SPEEDS = NONE._replace(
    speed_min=np.array((-0.2, -0.1, -1.0)), speed_max=np.array((0.5, 0.3, 1.5)), root_speed=np.array((3.0, 5.0, 7.0))
)
FREE = Ends(np.zeros(3), np.zeros(3), 0.0, 0.0, 0.0)
STANDING = [(0.0, 0.0, 0.0, 0.5)] * 3


def around(count, points=AWAY, point_radius=0.0, caps=1.0, room=AWAY, moving=None, radius=0.25, via=None):
    """Return the surroundings of a band: one static point (x, y) beside every pose, a moving disc, a via of pose 1."""
    beside = np.full((count, 1, 2), AWAY)
    beside[:, 0] = points
    discs = np.empty((count, 0, 2)) if moving is None else np.tile(np.array(moving), (count, 1, 1))
    vias = np.empty((0, 2)) if via is None else np.array([via])
    return Surroundings(
        beside,
        point_radius,
        np.full(count, caps),
        np.full(count, room),
        discs,
        np.full(discs.shape[1], radius),
        vias,
        np.ones(len(vias), np.int64),
    )


def residuals(band, penalties, ends=FREE, shape=DISC, **surroundings):
    """Return the residuals that are not 0, by term, after checking that they make up the cost."""
    band, found = np.array(band, float), around(len(band), **surroundings)
    rows = make_rows(found)
    cost = evaluate_terms(band, BandTerms(penalties, rows), shape, ends, found)
    used = rows.used[0]
    assert cost == pytest.approx(0.5 * np.sum(rows.residual[:used] ** 2))
    return {int(rows.term[i]): pytest.approx(rows.residual[i]) for i in range(used) if rows.residual[i] != 0.0}


def test_a_band_that_stands_far_from_everything_costs_nothing():
    assert residuals(STANDING, SPEEDS) == {}


def test_each_speed_costs_what_it_lies_outside_of_its_limits():
    fast = [(0.0, 0.0, 0.0, 0.5), (0.4, 0.0, 0.0, 0.5), (0.35, 0.0, 0.0, 0.5), (0.15, 0.0, 0.0, 0.0)]
    assert residuals(fast, SPEEDS) == {0: 3.0 * (0.8 - 0.5), 2 * INTERVAL_ROWS: 3.0 * (-0.4 + 0.2)}
    aside = [(0.0, 0.0, 0.0, 0.5), (0.0, 0.3, 0.0, 0.5), (0.0, 0.2, 0.0, 0.0)]
    assert residuals(aside, SPEEDS) == {1: 5.0 * (0.6 - 0.3), INTERVAL_ROWS + 1: 5.0 * (-0.2 + 0.1)}
    turns = [(0.0, 0.0, 0.0, 0.5), (0.0, 0.0, 1.0, 0.5), (0.0, 0.0, 0.2, 0.0)]
    assert residuals(turns, SPEEDS) == {2: 7.0 * (2.0 - 1.5), INTERVAL_ROWS + 2: 7.0 * (-1.6 + 1.0)}


def test_speeds_are_those_at_the_heading_half_way():
    """0.4 m along x in half a second, headings 0 and pi / 3: by cos(pi / 6) forward, by sin(pi / 6) to the right."""
    band = [(0.0, 0.0, 0.0, 0.5), (0.4, 0.0, math.pi / 3.0, 0.5), (0.4, 0.0, math.pi / 3.0, 0.5)]
    found = residuals(band, SPEEDS._replace(speed_max=np.array((0.5, 0.3, 9.0))))
    assert found == {0: 3.0 * (0.8 * math.sqrt(0.75) - 0.5), 1: 5.0 * (-0.4 + 0.1)}


def test_turns_go_the_shorter_way_round():
    band = [(0.0, 0.0, 3.0, 0.1), (0.0, 0.0, -3.0, 0.5), (0.0, 0.0, -3.0, 0.0)]
    assert residuals(band, SPEEDS) == {2: 7.0 * ((2.0 * math.pi - 6.0) / 0.1 - 1.5)}


def test_between_walls_driving_is_limited_and_turning_is_not():
    band = [(0.0, 0.0, 0.0, 0.5), (0.2, 0.1, 0.0, 0.5), (0.2, 0.1, 0.6, 0.0)]
    assert residuals(band, SPEEDS, caps=0.5) == {0: 3.0 * (0.4 - 0.25), 1: 5.0 * (0.2 - 0.15)}


def test_both_poses_lie_on_one_arc():
    """RAS 2017, eq. 13: the cross product of both headings' sum with the way."""
    first, second = (0.1, 0.2, 0.3, 0.5), (0.5, 0.6, 1.1, 0.5)
    found = residuals([first, second, second], NONE._replace(root_nonholonomic=2.0))
    headings = math.cos(0.3) + math.cos(1.1), math.sin(0.3) + math.sin(1.1)
    assert found == {3: 2.0 * (headings[0] * 0.4 - headings[1] * 0.4)}
    arc = [(0.0, 0.0, 0.0, 0.5), (math.sin(0.8), 1.0 - math.cos(0.8), 0.8, 0.5)]
    assert all(of.expected < 1e-12 for of in residuals([*arc, arc[1]], NONE._replace(root_nonholonomic=2.0)).values())


def test_driving_backwards_costs_its_way():
    band = [(0.0, 0.0, 0.0, 0.25), (-0.4, 0.0, 0.0, 0.5), (0.3, 0.0, 0.0, 0.5)]
    assert residuals(band, NONE._replace(root_forward=3.0)) == {4: -3.0 * 0.4}


def test_turns_tighter_than_the_turning_radius_cost_what_the_way_lacks():
    """A turn by 0.6 rad at a radius of 0.5 m takes 0.3 m."""
    sharp, back = (0.2 * math.cos(0.3), 0.2 * math.sin(0.3)), (-0.2 * math.cos(0.3), 0.2 * math.sin(0.3))
    bends = NONE._replace(root_turn_radius=4.0, turn_radius=0.5)
    band = [(0.0, 0.0, 0.0, 0.25), (*sharp, 0.6, 0.5), (*sharp, 0.6, 0.5)]
    assert residuals(band, bends) == {5: 4.0 * 0.1}
    band = [(0.0, 0.0, 0.0, 0.25), (*back, -0.6, 0.5), (*back, -0.6, 0.5)]
    assert residuals(band, bends) == {5: 4.0 * 0.1}
    wide = [(0.0, 0.0, 0.0, 0.25), (0.4, 0.0, 0.6, 0.5), (0.4, 0.0, 0.6, 0.5)]
    assert residuals(wide, bends) == {}


def test_time_and_way_of_every_interval_cost():
    band = [(0.0, 0.0, 0.0, 0.25), (0.3, 0.4, 0.0, 0.5), (0.3, 0.2, 0.0, 9.0)]
    assert residuals(band, NONE._replace(root_time=2.0)) == {6: 0.5, INTERVAL_ROWS + 6: 1.0}
    assert residuals(band, NONE._replace(root_path=3.0)) == {7: 1.5, INTERVAL_ROWS + 7: 0.6}


def test_turns_against_the_preferred_direction_cost_in_the_first_three_intervals():
    band = [(0.0, 0.0, 0.2 * k * (-1.0) ** k, 0.5) for k in range(6)]
    turns = [-0.2, 0.6, -1.0, 1.4]
    left = residuals(band, NONE._replace(root_rotation=3.0), FREE._replace(rotation=1.0))
    assert left == {8: 3.0 * turns[0], 2 * INTERVAL_ROWS + 8: 3.0 * turns[2]}
    right = residuals(band, NONE._replace(root_rotation=3.0), FREE._replace(rotation=-1.0))
    assert right == {INTERVAL_ROWS + 8: -3.0 * turns[1]}


ROOTS = np.array((2.0, 3.0, 5.0))
PUSHES = NONE._replace(acceleration=np.array((0.5, 0.4, 0.3)), root_acceleration=ROOTS)


def test_accelerations_between_intervals_are_over_half_of_both_times():
    """Speeds 0.8, -0.4 and 0 m/s: -1.2 over 0.375 s, and 0.4 over 0.375 s."""
    band = [(0.0, 0.0, 0.0, 0.25), (0.2, 0.0, 0.0, 0.5), (0.0, 0.0, 0.0, 0.25), (0.0, 0.0, 0.0, 0.0)]
    ends = Ends(np.array((0.8, 0.0, 0.0)), np.zeros(3), 1.0, 0.0, 0.0)
    first = 3 * INTERVAL_ROWS + JOINT_ROWS
    assert residuals(band, PUSHES, ends) == {
        first: 2.0 * (-1.2 / 0.375 + 0.5),
        first + JOINT_ROWS: 2.0 * (0.4 / 0.375 - 0.5),
    }


@pytest.mark.parametrize("axis", range(3))
def test_accelerations_at_the_ends_are_from_the_start_and_to_the_goals_velocity(axis):
    start, goal = np.zeros(3), np.zeros(3)
    start[axis], goal[axis] = 0.3, -0.2
    band = [(0.0, 0.0, 0.0, 0.5), (0.0, 0.0, 0.0, 0.5), (0.0, 0.0, 0.0, 0.25), (0.0, 0.0, 0.0, 0.0)]
    most, first, last = PUSHES.acceleration[axis], 3 * INTERVAL_ROWS + axis, 3 * (INTERVAL_ROWS + JOINT_ROWS) + axis
    found = residuals(band, PUSHES, Ends(start, goal, 1.0, 0.0, 0.0))
    expected = {first: ROOTS[axis] * (-0.3 / 0.5 + most), last: ROOTS[axis] * (-0.2 / 0.25 + most)}
    assert found == expected
    del expected[last]
    assert residuals(band, PUSHES, Ends(start, goal, 0.0, 0.0, 0.0)) == expected, "where the goal's does not count"


NEAR = NONE._replace(root_obstacle=3.0, root_inflation=0.5)
POINTS = 2 * INTERVAL_ROWS + 3 * JOINT_ROWS  # the first term of a static point beside pose 1


@pytest.mark.parametrize(
    ("distance", "near", "inflated"), [(0.3, 0.1, 0.4), (0.4, 0.0, 0.3), (0.69, 0.0, 0.01), (0.71, 0.0, 0.0)]
)
def test_a_static_point_costs_what_its_gap_lacks_of_both_bounds(distance, near, inflated):
    """The gap is the distance less 0.15 m of the disc and 0.05 m of the point."""
    point = (0.6 * distance, 0.8 * distance)
    expected = {POINTS: 3.0 * near, POINTS + 1: 0.5 * inflated}
    found = residuals(STANDING, NEAR, points=point, point_radius=0.05)
    assert found == {term: of for term, of in expected.items() if of > 0.0}


def test_gaps_are_those_of_the_turned_footprint():
    turned = [(1.0, 1.0, 0.5 * math.pi, 0.5)] * 3
    beside, ahead = (1.4, 1.0), (1.0, 1.4)
    assert residuals(turned, NEAR, shape=BOX, points=beside)[POINTS + 1] == 0.5 * (0.5 - (0.3 - 0.05))
    assert residuals(turned, NEAR, shape=BOX, points=ahead)[POINTS + 1] == 0.5 * (0.5 - (0.2 - 0.05))


def test_the_exponent_raises_the_lack_of_the_near_bound_in_its_unit():
    found = residuals(STANDING, NEAR._replace(exponent=4.0), points=(0.25, 0.0))
    assert found == {POINTS: 3.0 * 0.2 * (0.1 / 0.2) ** 4, POINTS + 1: 0.5 * 0.4}
    only_inflated = residuals(STANDING, NEAR._replace(exponent=4.0), points=(0.4, 0.0))
    assert only_inflated == {POINTS + 1: 0.5 * 0.25}


def test_in_a_passage_both_bounds_are_its_room():
    found = residuals(STANDING, NEAR, points=(0.2, 0.0), room=0.1)
    assert found == {POINTS: 3.0 * 0.05, POINTS + 1: 0.5 * 0.05}


def test_a_moving_disc_has_bounds_and_weights_of_its_own():
    moves = NONE._replace(root_dynamic=2.0, root_dynamic_inflation=0.4)
    found = residuals(STANDING, moves, moving=(0.0, 0.6))
    assert found == {POINTS + 2: 2.0 * (0.3 - 0.2), POINTS + 3: 0.4 * (0.6 - 0.2)}
    assert residuals(STANDING, moves, moving=(0.0, 1.01)) == {}
    assert residuals(STANDING, moves, moving=(0.0, 0.99)) == {POINTS + 3: 0.4 * 0.01}


def test_ends_cost_nothing_beside_an_obstacle():
    band = [(0.0, 0.0, 0.0, 0.5), (5.0, 0.0, 0.0, 0.5), (0.0, 0.0, 0.0, 0.0)]
    assert residuals(band, NEAR, points=(0.2, 0.0)) == {}


def test_a_via_point_costs_its_distance_from_its_pose():
    assert residuals(STANDING, NONE._replace(root_via=2.0), via=(0.3, -0.4)) == {POINTS + 2: 1.0}
    band = [(0.0, 0.0, 0.0, 0.5)] * 4
    vias = residuals(band, NONE._replace(root_via=2.0), via=(0.3, -0.4), moving=(9.0, 9.0))
    assert vias == {3 * INTERVAL_ROWS + 4 * JOINT_ROWS + 2 * 2 * 2: 1.0}
