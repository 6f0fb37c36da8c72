import math

import numpy as np
import pytest
from numba import njit

from arena_kernels.compiled import BORROWING
from arena_mpc.columns import STAGE_HEAD
from arena_mpc.corridor import FREE, nearest_cells
from arena_mpc.motion import NUMBER, differentiate_motion, integrate_motion
from arena_mpc.objective import WEIGHTS
from arena_mpc.parameters import SolverSettings
from arena_mpc.plan import Plan, Room
from arena_mpc.problem import Shape
from arena_mpc.reference import nearest_stages
from arena_mpc.shooting import solve_shooting
from arena_mpc.solvers import InteriorPoint, Shooting
from arena_mpc.terms import (
    Terms,
    differentiate_interval,
    differentiate_stage,
    interval_cost,
    make_slopes,
    stage_cost,
)

SMALL = 1e-6
PRICES = {"time": 1.0, "goal_position": 100.0, "goal_heading": 0.5, "path": 2.0, "slack": 10.0, "slack_squared": 100.0}


@njit(**BORROWING)
def _stage(terms, k, state, slopes):
    return stage_cost(terms, k, state, slopes)


@njit(**BORROWING)
def _stage_slopes(terms, k, state, slopes):
    differentiate_stage(terms, k, state, slopes)


@njit(**BORROWING)
def _interval(terms, state, control):
    return interval_cost(terms, state, control)


@njit(**BORROWING)
def _interval_slopes(terms, state, control, slopes):
    differentiate_interval(terms, state, control, slopes)


@njit(**BORROWING)
def _moved(model, state, control, following):
    integrate_motion(model, 0.3, state, control, following)


@njit(**BORROWING)
def _moved_slopes(model, state, control, by_state, by_control):
    differentiate_motion(model, 0.3, state, control, by_state, by_control)


def _terms(stages=20, weights=PRICES, model=0, timed=True, person=(1.0, 0.3, -0.2, 0.0, 0.5)):
    rows = np.zeros((stages + 1, STAGE_HEAD + 3 * 2 * 2))
    rows[:, :9] = (0.0, 0.0, 0.0, 1.0, 0.1, 1.0, 0.4, 0.2, 1.0)
    rows[:, STAGE_HEAD:] = (0.0, 1.0, -0.4, 0.0, 0.0, FREE) * 2
    values = np.array([weights.get(name, 0.0) for name in WEIGHTS])
    discs = np.array(((0.1, 0.0), (-0.1, 0.05)))
    people = np.tile(np.array((person,)), (stages + 1, 1, 1))
    return Terms(model, timed, 0.3, 0.1, 0.02, 0.1, 1.0, np.array((2.0, 0.1, 0.2)), values, discs, people, rows)


def _numerical(function, point):
    return np.array(
        [(function(point + step) - function(point - step)) / (2.0 * SMALL) for step in SMALL * np.eye(len(point))]
    )


@pytest.mark.parametrize("timed", [True, False])
@pytest.mark.parametrize("k", [3, 20])
def test_slopes_of_a_stage_are_those_of_its_cost(timed, k):
    terms, state = (
        _terms(weights=dict.fromkeys(WEIGHTS, 0.7) | PRICES, timed=timed),
        np.array((0.5, -0.1, 0.4, 0.8, 0.3, 0.12)),
    )
    slopes = make_slopes(terms, 6, 2)
    _stage_slopes(terms, k, state, slopes)
    assert slopes.state == pytest.approx(
        _numerical(lambda s: _stage(terms, k, s, make_slopes(terms, 6, 2)), state), rel=1e-4, abs=1e-5
    )
    assert (np.linalg.eigvalsh(slopes.state_state) >= -1e-9).all()


def test_slopes_of_an_interval_are_those_of_its_cost():
    terms = _terms(weights=dict.fromkeys(WEIGHTS, 0.7))
    state, control = np.array((0.5, -0.1, 0.4, 0.8, 0.3, 0.12)), np.array((0.9, 0.1))
    slopes = make_slopes(terms, 6, 2)
    _interval_slopes(terms, state, control, slopes)
    assert slopes.state == pytest.approx(_numerical(lambda s: _interval(terms, s, control), state), rel=1e-4, abs=1e-5)
    assert slopes.control == pytest.approx(
        _numerical(lambda c: _interval(terms, state, c), control), rel=1e-4, abs=1e-5
    )


@pytest.mark.parametrize("model", list(NUMBER))
def test_slopes_of_a_motion_are_those_of_the_motion(model):
    control = np.array((0.8, 0.3, -0.6) if model == "omnidirectional" else (0.8, 0.3))
    state = np.concatenate(((0.5, -0.1, 0.4), control + 0.1, (0.2,)))
    by_state, by_control = np.zeros((len(state), len(state))), np.zeros((len(state), len(control)))
    _moved_slopes(NUMBER[model], state, control, by_state, by_control)

    def end(at, velocities):
        following = np.zeros(len(state))
        _moved(NUMBER[model], at, velocities, following)
        return following

    assert pytest.approx(_numerical(lambda s: end(s, control), state), abs=1e-6) == by_state.T
    assert pytest.approx(_numerical(lambda c: end(state, c), control), abs=1e-6) == by_control.T


ROOM = Room(np.array((-0.2, -1.5)), np.array((1.0, 1.5)), np.full(2, 4.0), 0.02, 0.5, 1.0)
BEGIN = np.array((0.0, 0.0, 0.0, 0.4, 0.0))


def _guess(stages=20):
    states = np.zeros((stages + 1, 5))
    states[:, 0], states[:, 3] = np.linspace(0.0, 2.0, stages + 1), 1.0
    states[0] = BEGIN
    return Plan(states, 0.1, np.zeros(stages + 1))


@pytest.mark.parametrize("person", [(1.0, 0.3, -0.2, 0.0, 0.5), (1.2, -0.5, 0.0, 0.4, 0.5), (9.0, 9.0, 0.0, 0.0, 0.5)])
def test_shooting_finds_plans_as_cheap_as_ipopt_does(person):
    weights = {**PRICES, "acceleration_linear": 0.01, "acceleration_angular": 0.01}
    terms = _terms(weights=weights, person=person)
    terms.rows[:, 8] = 0.0
    shape = Shape("unicycle", "minimum_time", 20, 2, 2, 1, cells=False, hard=False, fixed_end=False)
    ipopt = InteriorPoint(SolverSettings("ipopt", 300, 300, 1e-4), lambda _: shape).solve(
        terms, BEGIN, _guess(), ROOM, 300
    )
    shot = Shooting(SolverSettings("shooting", 150, 150, 1e-5)).solve(terms, BEGIN, _guess(), ROOM, 150)
    priced_alike = solve_shooting(terms, BEGIN, ipopt.plan, ROOM, 0, 1e-5).cost  # shooting rounds shortfalls off
    assert shot.cost <= 1.02 * priced_alike


def test_more_iterations_never_cost_more():
    costs = [
        Shooting(SolverSettings("shooting", n, n, 1e-9)).solve(_terms(), BEGIN, _guess(), ROOM, n).cost
        for n in (1, 2, 5, 20, 60)
    ]
    assert costs == sorted(costs, reverse=True)


def test_cells_within_the_inclusion_count_and_beyond_it_one_on_either_side():
    cells = np.array(((0.3, 0.1), (0.3, 0.2), (1.5, 0.5), (1.0, -0.8), (2.0, -0.8), (5.0, 5.0)))
    rows = nearest_cells(cells, np.zeros((1, 2)), np.zeros(1), 0.25, 0.5, 2.5, 4)[0]
    assert rows[:3].tolist() == [[0.3, 0.1, 0.25], [1.0, -0.8, 0.25], [0.3, 0.2, 0.25]]
    assert rows[3].tolist() == [-FREE, -FREE, 0.0]


def test_via_points_draw_the_stages_nearest_to_them():
    positions = np.column_stack((np.linspace(0.0, 1.0, 6), np.zeros(6)))
    rows = nearest_stages(np.array(((0.0, 0.1), (0.62, 0.3))), positions)
    assert rows[:, 2].tolist() == [0.0, 1.0, 0.0, 1.0, 0.0, 0.0]
    assert math.isclose(rows[3, 1], 0.3)
