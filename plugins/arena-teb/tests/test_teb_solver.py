"""The terms' derivatives, and the solver against scipy's."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import least_squares
from scipy.sparse import csr_matrix

from arena_teb.problem import REACH, BandTerms, Ends, Penalties, Shape, Surroundings
from arena_teb.solver import solve_band
from arena_teb.terms import evaluate_terms, make_rows

BOX = Shape(np.array([[0.21, -0.165], [0.21, 0.165], [-0.21, 0.165], [-0.21, -0.165]]), 0.0, 0.267, 0.165)
DISC = Shape(np.zeros((1, 2)), 0.15, 0.15, 0.15)
ENDS = Ends(np.array((0.1, 0.0, 0.2)), np.zeros(3), 1.0, 1.0, 0.0)


def penalties(holonomic=False, turn_radius=0.0, exponent=1.0):
    return Penalties(
        speed_min=np.array((-0.2, -0.3 * holonomic, -1.0)),
        speed_max=np.array((0.5, 0.3 * holonomic, 1.0)),
        acceleration=np.array((0.5, 0.5, 0.5)),
        root_speed=np.sqrt((50.0, 50.0 * holonomic, 10.0)),
        root_acceleration=np.sqrt((1.0, 1.0 * holonomic, 1.0)),
        root_nonholonomic=1.0 if holonomic else math.sqrt(1000.0),
        root_forward=math.sqrt(10.0),
        root_turn_radius=math.sqrt(100.0) if turn_radius > 0.0 else 0.0,
        root_time=1.0,
        root_path=math.sqrt(0.1),
        root_obstacle=math.sqrt(50.0),
        root_inflation=math.sqrt(0.2),
        root_dynamic=math.sqrt(50.0),
        root_dynamic_inflation=math.sqrt(0.2),
        root_via=1.0,
        root_rotation=math.sqrt(2.0),
        turn_radius=turn_radius,
        near=0.2,
        inflated=0.5,
        dynamic_near=0.2,
        dynamic_inflated=0.5,
        exponent=exponent,
        unit=0.2,
    )


def drawn(seed, count=40, tracks=10, noise=0.02):
    """Return a wavy band with points beside some poses, moving discs and three via points."""
    random = np.random.default_rng(seed)
    share = np.linspace(0.0, 1.0, count)
    band = np.zeros((count, 4))
    band[:, 0], band[:, 1] = 0.12 * count * share, 0.5 * np.sin(3.0 * share + random.uniform(0.0, 6.0))
    band[:, 2] = np.arctan2(np.gradient(band[:, 1]), np.gradient(band[:, 0]))
    points = np.full((count, 2, 2), np.inf)
    for side, sign in enumerate((1.0, -1.0)):
        offsets = np.column_stack((0.0 * share, sign * random.uniform(0.3, 0.6, count)))
        near = random.random(count) < 0.5
        points[near, side] = (band[:, :2] + offsets)[near]
    band[1:-1, :3] += random.normal(0.0, noise, (count - 2, 3))
    band[:, 3] = random.uniform(0.2, 0.4, count)
    times = 0.3 * np.arange(count)[:, None, None]
    moving = random.uniform((0.0, -1.5), (0.12 * count, 1.5), (tracks, 2)) + times * random.uniform(
        -0.3, 0.3, (tracks, 2)
    )
    vias = random.uniform((0.02 * count, -0.3), (0.1 * count, 0.3), (3, 2))
    poses = np.array([1 + int(np.argmin(np.hypot(*(band[1:-1, :2] - via).T))) for via in vias])
    return band, Surroundings(
        points, 0.025, np.ones(count), np.full(count, np.inf), moving, np.full(tracks, 0.25), vias, poses
    )


def sparse(rows, variables):
    """Return the Jacobian of all terms, also of those that are out of action."""
    row, column = np.nonzero(np.arange(REACH) < rows.width[: rows.used[0], None])
    entries = rows.jacobian[row, column], (rows.term[row], rows.first[row] + column)
    return csr_matrix(entries, shape=(len(rows.width), variables))


def residuals_of(rows):
    """Return the residuals of all terms, 0 of those that are out of action."""
    residuals = np.zeros(len(rows.residual))
    residuals[rows.term[: rows.used[0]]] = rows.residual[: rows.used[0]]
    return residuals


def in_action(rows):
    active = np.zeros(len(rows.term), np.bool_)
    active[rows.term[: rows.used[0]]] = True
    return active


def polished(band, settings, shape, ends, around, evaluations=60):
    """Return the cost at which scipy's trust region ends that begins at ``band``."""
    rows = make_rows(around)
    free = np.ones(band.shape, np.bool_)
    free[0, :3] = free[-1] = False
    free[-1, 2] = ends.heading_free > 0.0
    lowest = np.tile((-np.inf, -np.inf, -np.inf, 1e-4), (len(band), 1))

    def at(values):
        placed = band.copy()
        placed[free] = values
        evaluate_terms(placed, BandTerms(settings, rows), shape, ends, around)

    def residuals(values):
        at(values)
        return residuals_of(rows)

    def jacobian(values):
        at(values)
        return sparse(rows, band.size)[:, free.ravel()]

    start, bounds = band[free], (lowest[free], np.inf)
    return least_squares(residuals, start, jacobian, bounds=bounds, x_scale="jac", max_nfev=evaluations).cost


@settings(derandomize=True, deadline=None, max_examples=40)
@given(
    st.integers(0, 10**6),
    st.booleans(),
    st.booleans(),
    st.sampled_from([0.0, 0.6]),
    st.sampled_from([-1.0, 0.0, 1.0]),
    st.sampled_from([1.0, 4.0]),
    st.booleans(),
)
def test_derivatives_are_those_of_finite_differences(seed, box, holonomic, turn_radius, rotation, exponent, narrow):
    band, around = drawn(seed, 6, 4, 0.2)
    if narrow:
        around = around._replace(room=np.random.default_rng(seed).uniform(0.0, 0.3, len(band)))
    shape, weighed = BOX if box else DISC, penalties(holonomic, turn_radius, exponent)
    ends = ENDS._replace(rotation=rotation)
    rows, size = make_rows(around), 1e-6
    evaluate_terms(band, BandTerms(weighed, rows), shape, ends, around)
    exact, numeric = sparse(rows, band.size).toarray(), np.zeros((len(rows.width), band.size))
    active = in_action(rows)
    for variable in range(band.size - 1):
        for sign in (1.0, -1.0):
            moved = band.copy()
            moved.flat[variable] += sign * size
            evaluate_terms(moved, BandTerms(weighed, rows), shape, ends, around)
            active &= in_action(rows)
            numeric[:, variable] += sign * residuals_of(rows) / (2.0 * size)
    np.testing.assert_allclose(exact[active], numeric[active], rtol=1e-3, atol=1e-3)


@pytest.mark.parametrize("holonomic", [False, True])
def test_cost_never_rises_and_ends_stay(holonomic):
    for seed in range(10):
        band, around = drawn(seed)
        before, settings = band.copy(), penalties(holonomic)
        start = evaluate_terms(band, BandTerms(settings, make_rows(around)), DISC, ENDS, around)
        cost, _ = solve_band(band, settings, DISC, ENDS, around, 20, 1e-4)
        assert cost < start
        assert cost == pytest.approx(evaluate_terms(band, BandTerms(settings, make_rows(around)), DISC, ENDS, around))
        assert (band[0, :3] == before[0, :3]).all()
        assert (band[-1, :2] == before[-1, :2]).all()
        assert (band[:-1, 3] > 0.0).all()


def test_held_heading_of_the_goal_stays():
    band, around = drawn(1)
    before = band[-1, 2]
    solve_band(band, penalties(), DISC, ENDS._replace(heading_free=0.0), around, 10, 1e-4)
    assert band[-1, 2] == before


def test_free_straight_band_becomes_as_fast_as_allowed():
    band = np.zeros((10, 4))
    band[:, 0], band[:, 3] = np.linspace(0.0, 1.0, 10), 1.0
    nothing = Surroundings(
        np.full((10, 2, 2), np.inf),
        0.0,
        np.ones(10),
        np.full(10, np.inf),
        np.empty((10, 0, 2)),
        np.empty(0),
        np.empty((0, 2)),
        np.empty(0, int),
    )
    ends = Ends(np.array((0.5, 0.0, 0.0)), np.zeros(3), 0.0, 1.0, 0.0)
    solve_band(band, penalties()._replace(root_path=0.0), DISC, ends, nothing, 100, 1e-6)
    assert band[:-1, 3].sum() == pytest.approx(2.0, rel=0.05)


@pytest.mark.slow
def test_scipy_finds_little_to_improve():
    better = 0
    for seed in range(20):
        band, around = drawn(seed, 30, 5, 0.005)
        cost, _ = solve_band(band, penalties(), BOX, ENDS, around, 300, 1e-5)
        better += polished(band, penalties(), BOX, ENDS, around) < 0.95 * cost
    assert better <= 2
