"""In a passage that is narrower than the wanted gap, the room that it leaves is all that TEB asks for."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arena_kernels.foreseen import Foreseen
from arena_teb.association import Reach
from arena_teb.polygons import NO_HULLS
from arena_teb.problem import BandTerms, Ends, Penalties, Shape, Surroundings
from arena_teb.solver import solve_band
from arena_teb.surroundings import Scene, Vicinity, find_surroundings, room_beside
from arena_teb.terms import evaluate_terms, make_rows

NOBODY = np.empty((0, 2))
DISC = Shape(np.zeros((1, 2)), 0.15, 0.15, 0.15)
NEAR = 0.15
BAND = np.column_stack((np.linspace(-1.0, 1.0, 21), np.full(21, 0.02), np.zeros(21), np.full(21, 0.3)))
NO_SPEEDS = np.array((-9.0, -9.0, -9.0)), np.array((9.0, 9.0, 9.0)), np.array((99.0, 99.0, 99.0))
FREE = Ends(np.zeros(3), np.zeros(3), 0.0, 1.0, 0.0)


def penalties(inflation=0.2):
    """Return penalties that look at static points alone, for gaps of NEAR and 0.4 m."""
    zeros = np.zeros(3)
    weights = dict.fromkeys((f for f in Penalties._fields if f.startswith("root_")), 0.0)
    weights |= {
        "root_speed": zeros,
        "root_acceleration": zeros,
        "root_obstacle": math.sqrt(50.0),
        "root_inflation": math.sqrt(inflation),
    }
    low, high, most = NO_SPEEDS
    gaps = {"near": NEAR, "inflated": 0.4, "dynamic_near": 0.3, "dynamic_inflated": 0.6}
    return Penalties(
        speed_min=low, speed_max=high, acceleration=most, turn_radius=0.0, exponent=1.0, unit=NEAR, **weights, **gaps
    )


def rooms(window, band=BAND, forced=0.0):
    here = Scene(window, NO_HULLS, Foreseen.straight(NOBODY, NOBODY), np.empty(0), math.inf, NOBODY)
    return find_surroundings(band, here, Vicinity(Reach(1.0, forced), 1.0, 0.1, 0.5), DISC)


@settings(derandomize=True, deadline=None, max_examples=100)
@given(st.floats(0.05, 1.0), st.floats(0.05, 1.0), st.floats(0.0, 0.3), st.floats(-3.1, 3.1), st.floats(-5.0, 5.0))
def test_room_is_half_of_what_a_passage_is_wider_than_the_robot_wherever_in_it_a_pose_lies(
    left, right, taken, theta, shift
):
    pose = np.array((shift, -shift, theta, 0.3))
    across = np.array((-math.sin(theta), math.cos(theta)))
    points = pose[:2] + np.array((left * across, -right * across))
    assert room_beside.py_func(pose, points, taken) == pytest.approx(max(0.5 * (left + right) - taken, 0.0), abs=1e-9)


@settings(derandomize=True, deadline=None, max_examples=100)
@given(st.floats(0.1, 1.0), st.floats(0.1, 1.0), st.floats(0.0, math.pi), st.floats(-3.1, 3.1))
def test_points_bound_a_passage_if_they_lie_more_than_120_degrees_apart(left, right, apart, turned):
    directions = np.array((turned, turned + apart))
    points = np.array((left, right))[:, None] * np.column_stack((np.cos(directions), np.sin(directions)))
    if abs(apart - math.radians(120.0)) > 1e-6:
        assert math.isinf(room_beside.py_func(np.zeros(4), points, 0.1)) == (apart < math.radians(120.0))


@pytest.mark.parametrize("missing", [0, 1])
def test_a_wall_on_one_side_is_no_passage(missing):
    points = np.array(((0.0, 0.3), (0.0, -0.3)))
    points[missing] = math.inf
    assert math.isinf(room_beside.py_func(np.zeros(4), points, 0.1))


@pytest.mark.parametrize("cells", range(7, 13))
def test_room_between_walls_is_exact_for_even_and_odd_numbers_of_cells(window, cells):
    low = -0.201
    scene = window((-3.1, 3.1, low + 0.05 * cells, 3.1), (-3.1, 3.1, -3.1, low))
    assert np.sum(scene.costs[:, 60] == 0) == cells
    assert rooms(scene).room[5] == pytest.approx(0.5 * cells * 0.05 - DISC.inscribed, abs=1e-6)


def test_a_wall_ahead_and_a_corner_are_no_passages(window):
    ahead = rooms(window((0.5, 3.1, -3.1, 3.1)), BAND[:12])
    corner = rooms(window((0.5, 3.1, -3.1, 3.1), (-3.1, 3.1, 0.3, 3.1)), BAND[:12])
    assert np.isinf(ahead.room).all()
    assert np.isinf(corner.room).all()


def test_poses_outside_of_a_gap_are_in_no_passage(window):
    around = rooms(window((-0.1, 0.1, 0.25, 3.1), (-0.1, 0.1, -3.1, -0.25)))
    inside = np.abs(BAND[:, 0]) < 0.1
    assert np.isfinite(around.room[inside]).all()
    assert np.isinf(around.room[np.abs(BAND[:, 0]) > 0.4]).all()


def test_points_that_are_forced_to_count_are_no_passage(window):
    walls = (-3.1, 3.1, 0.25, 3.1), (-3.1, 3.1, -3.1, -0.25)
    assert np.isinf(rooms(window(*walls), forced=0.5).room).all()
    assert np.isfinite(rooms(window(*walls)).room[5])


def corridor(half, room):
    """Return a band's surroundings between points at ``half`` m to the left and right of the x axis."""
    points = np.stack([np.column_stack((BAND[:, 0], np.full(21, sign * half))) for sign in (1.0, -1.0)], axis=1)
    none = np.empty((21, 0, 2)), np.empty(0), NOBODY, np.empty(0, int)
    return Surroundings(points, 0.0, np.ones(21), np.full(21, room), *none)


@pytest.mark.parametrize("half", [0.16, 0.2, 0.25, 0.3])
def test_off_the_middle_of_a_passage_a_band_costs_what_it_is_off_and_in_it_nothing(half):
    room = half - DISC.inscribed
    around, off = corridor(half, room), 0.01
    for aside in (0.0, off):
        band = BAND.copy()
        band[:, 1] = aside
        cost = evaluate_terms(band, BandTerms(penalties(), make_rows(around)), DISC, FREE, around)
        near = 0.5 * 19 * (50.0 * aside**2)
        inflated = 0.5 * 19 * 0.2 * (aside**2 if room < NEAR else (0.4 - room + aside) ** 2 + (0.4 - room - aside) ** 2)
        assert cost == pytest.approx(near + inflated, rel=1e-6, abs=1e-12)


def test_outside_of_passages_the_wanted_gaps_count_in_full():
    around = corridor(0.2, math.inf)
    band = BAND.copy()
    band[:, 1] = 0.0
    cost = evaluate_terms(band, BandTerms(penalties(), make_rows(around)), DISC, FREE, around)
    assert cost == pytest.approx(0.5 * 19 * 2 * (50.0 * (NEAR - 0.05) ** 2 + 0.2 * (0.4 - 0.05) ** 2))


def test_a_band_in_a_passage_settles_in_its_middle():
    around, band = corridor(0.2, 0.05), BAND.copy()
    band[0, 1] = band[-1, 1] = 0.0
    solve_band(band, penalties(), DISC, FREE, around, 20, 1e-9)
    assert np.abs(band[:, 1]).max() < 1e-3
