"""Each term of the objective alone, against figures worked out by hand: all other weights are 0."""

import math

import numpy as np
import pytest

from arena_kernels.compiled import borrowing
from arena_mpc.columns import STAGE_HEAD
from arena_mpc.corridor import FREE
from arena_mpc.objective import WEIGHTS
from arena_mpc.terms import ROUNDING, Terms, differentiate_stage, interval_cost, make_slopes, stage_cost

STAGES, STEP = 4, 0.1  # s, the wanted step
GOAL = np.array((2.0, 0.5, 0.4))
# reference (0.5, 0.2), normal (0, 1), heading 0.3, which counts; via point (0.4, 0.1), which counts
HEAD = (0.5, 0.2, 0.0, 1.0, 0.3, 1.0, 0.4, 0.1, 1.0)
STATE = np.array((0.7, 0.6, 0.9, 0.8, -0.5, 0.25))  # x, y, theta, v, w, step


@borrowing
def _stage(terms, k, state, slopes):
    return stage_cost(terms, k, state, slopes)


@borrowing
def _interval(terms, state, control):
    return interval_cost(terms, state, control)


def terms_of(timed=True, head=HEAD, planes=((0.0, 1.0, FREE),), movers=(), goal_heading=1.0, **weights):
    rows = np.zeros((STAGES + 1, STAGE_HEAD + 3 * len(planes)))
    rows[:, :STAGE_HEAD], rows[:, STAGE_HEAD:] = head, np.ravel(planes)
    values = np.array([weights.get(name, 0.0) for name in WEIGHTS])
    people = np.tile(np.array(movers, float).reshape(-1, 5), (STAGES + 1, 1, 1))
    disc = np.array(((0.2, 0.1),))
    return Terms(0, timed, 0.3, STEP, 0.05, 0.1, goal_heading, GOAL, values, disc, people, rows)


def stage(k=2, state=STATE, **given):
    terms = terms_of(**given)
    return _stage(terms, k, state, make_slopes(terms, len(state), 2))


def interval(control, state=STATE, **given):
    return _interval(terms_of(**given), state, np.array(control))


def test_without_weights_nothing_costs():
    assert stage() == stage(STAGES) == interval((1.0, 1.0)) == 0.0


def test_an_interval_costs_its_own_time_where_intervals_are_free():
    assert interval((0.8, -0.5), time=3.0) == 3.0 * 0.25
    assert interval((0.8, -0.5), timed=False, time=3.0) == 0.0


def test_an_interval_costs_the_squares_of_accelerations():
    """From 0.8 to 1.0 m/s in 0.25 s are 0.8 m/s^2; from -0.5 to 0.25 rad/s 3 rad/s^2; times the wanted step."""
    assert interval((1.0, 0.25), acceleration_linear=2.0) == pytest.approx(STEP * 2.0 * 0.64)
    assert interval((1.0, 0.25), acceleration_angular=2.0) == pytest.approx(STEP * 2.0 * 9.0)
    sideways = np.array((0.7, 0.6, 0.9, 0.8, 0.1, -0.5, 0.25))
    found = interval((1.0, 0.35, -0.5), sideways, acceleration_linear=2.0)
    assert found == pytest.approx(STEP * 2.0 * (0.64 + 1.0))


def test_a_stage_costs_how_far_it_lies_beside_the_path():
    assert stage(path=5.0) == pytest.approx(STEP * 5.0 * 0.4**2)
    slanted = (0.5, 0.2, 0.6, 0.8, *HEAD[4:])
    assert stage(path=5.0, head=slanted) == pytest.approx(STEP * 5.0 * (0.2 * 0.6 + 0.4 * 0.8) ** 2)


def test_a_stage_costs_the_squared_chord_between_its_heading_and_the_paths():
    chord = (math.cos(0.9) - math.cos(0.3)) ** 2 + (math.sin(0.9) - math.sin(0.3)) ** 2
    assert stage(path_heading=5.0) == pytest.approx(STEP * 5.0 * chord)
    assert stage(path_heading=5.0, head=(*HEAD[:5], 0.0, *HEAD[6:])) == 0.0


def test_a_stage_costs_its_squared_distance_from_its_via_point():
    assert stage(via_points=5.0) == pytest.approx(5.0 * (0.3**2 + 0.5**2))
    assert stage(via_points=5.0, head=(*HEAD[:8], 0.0)) == 0.0


AWAY = 1.3**2 + 0.1**2  # m^2, of the state from the goal
TURNED = 2.0 * (1.0 - math.cos(0.5))


@pytest.mark.parametrize(("k", "counts"), [(STAGES, True), (STAGES - 1, False)])
def test_the_last_stage_costs_how_far_it_misses_the_goal(k, counts):
    assert stage(k, goal_position=5.0) == pytest.approx(5.0 * AWAY * counts)
    assert stage(k, goal_heading=1.0, timed=True) == 0.0
    heading = terms_of()
    heading = heading._replace(weights=np.array([7.0 * (name == "goal_heading") for name in WEIGHTS]))
    room = make_slopes(heading, 6, 2)
    assert _stage(heading, k, STATE, room) == pytest.approx(7.0 * TURNED * counts)
    assert _stage(heading._replace(goal_heading=0.0), k, STATE, room) == 0.0


def test_the_quadratic_form_costs_what_is_left_to_the_goal_and_velocities():
    assert stage(timed=False, state_position=5.0) == pytest.approx(5.0 * AWAY)
    assert stage(timed=False, state_heading=5.0) == pytest.approx(5.0 * TURNED)
    assert stage(timed=False, state_heading=5.0, goal_heading=0.0) == 0.0
    assert stage(timed=False, control_linear=5.0) == pytest.approx(5.0 * 0.8**2)
    assert stage(timed=False, control_angular=5.0) == pytest.approx(5.0 * 0.5**2)
    sideways = np.array((0.7, 0.6, 0.9, 0.8, 0.3, -0.5, 0.25))
    assert stage(state=sideways, timed=False, control_linear=5.0) == pytest.approx(5.0 * (0.64 + 0.09))
    regulation = ("state_position", "state_heading", "control_linear", "control_angular")
    assert stage(**dict.fromkeys(regulation, 5.0)) == 0.0, "where intervals are free there is no such form"


DISC_X = 0.7 + 0.2 * math.cos(0.9) - 0.1 * math.sin(0.9)
DISC_Y = 0.6 + 0.2 * math.sin(0.9) + 0.1 * math.cos(0.9)
FASTER = 0.1 * 0.8  # m that a robot of 0.8 m/s keeps more


def rounded(shortfall):
    """Return how the slack is rounded off: log(1 + exp) of the shortfall in units of ROUNDING."""
    return ROUNDING * math.log1p(math.exp(shortfall / ROUNDING))


@pytest.mark.parametrize("shortfall", [-0.05, 0.0, 0.01, 0.3])
def test_the_slack_is_what_a_half_plane_lacks(shortfall):
    offset = 0.6 * DISC_X + 0.8 * DISC_Y - FASTER + shortfall
    planes = ((0.6, 0.8, offset),)
    assert stage(planes=planes, slack=3.0) == pytest.approx(3.0 * rounded(shortfall), rel=1e-5)
    assert stage(planes=planes, slack_squared=3.0) == pytest.approx(3.0 * rounded(shortfall) ** 2, rel=1e-5)


def test_a_distance_kept_by_far_costs_nothing():
    """Beyond 12 times the rounding, 0.24 m."""
    offset = 0.6 * DISC_X + 0.8 * DISC_Y - FASTER
    assert stage(planes=((0.6, 0.8, offset - 0.25),), slack=1e9) == 0.0
    assert stage(planes=((0.6, 0.8, offset - 0.23),), slack=1e9) > 0.0


def test_of_several_half_planes_the_worst_counts_and_equals_add_up_in_the_rounding():
    offset = 0.6 * DISC_X + 0.8 * DISC_Y - FASTER + 0.1
    worst, mild = (0.6, 0.8, offset), (0.6, 0.8, offset - 0.1)
    both = ROUNDING * math.log(1.0 + math.exp(5.0) + math.exp(0.0))
    assert stage(planes=(worst, mild), slack=3.0) == pytest.approx(3.0 * both, rel=1e-5)
    twice = ROUNDING * math.log(1.0 + 2.0 * math.exp(5.0))
    assert stage(planes=(worst, worst), slack=3.0) == pytest.approx(3.0 * twice, rel=1e-5)


def test_a_moving_obstacle_goes_on_and_grows_until_the_stage():
    """Stage 2 lies 0.5 s from now: two intervals of 0.25 s. Obstacles grow by 0.05 m/s."""
    x, y = DISC_X + 0.3 - 0.5 * 0.4, DISC_Y - 0.4 + 0.5 * 0.2
    shortfall = 0.45 + 0.5 * 0.05 + FASTER - 0.5
    assert stage(movers=[(x, y, 0.4, -0.2, 0.45)], slack=3.0) == pytest.approx(3.0 * rounded(shortfall), rel=1e-3)


SMALL = 1e-6
OFFSET = 0.6 * DISC_X + 0.8 * DISC_Y - FASTER
EVERY = tuple(name for name in WEIGHTS if name not in ("time", "acceleration_linear", "acceleration_angular"))


@borrowing
def _stage_slopes(terms, k, state, slopes):
    differentiate_stage(terms, k, state, slopes)


@pytest.mark.parametrize("timed", [True, False])
@pytest.mark.parametrize("k", [2, STAGES])
@pytest.mark.parametrize("name", EVERY)
def test_slopes_of_each_term_are_those_of_finite_differences(name, k, timed):
    """Beside a slanted path, near a half-plane and a person."""
    head = (0.5, 0.2, 0.6, 0.8, *HEAD[4:])
    people, planes = [(DISC_X + 0.4, DISC_Y - 0.3, 0.4, -0.2, 0.45)], ((0.6, 0.8, OFFSET - 0.01),)
    terms = terms_of(timed, head, planes, people)
    terms = terms._replace(weights=np.array([7.0 * (of == name) for of in WEIGHTS]))
    slopes = make_slopes(terms, 6, 2)
    _stage_slopes(terms, k, STATE, slopes)
    room = make_slopes(terms, 6, 2)
    steps = SMALL * np.eye(6)
    numerical = [(_stage(terms, k, STATE + s, room) - _stage(terms, k, STATE - s, room)) / (2.0 * SMALL) for s in steps]
    assert slopes.state == pytest.approx(numerical, rel=1e-4, abs=1e-4)
