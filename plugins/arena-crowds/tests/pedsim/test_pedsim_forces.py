import math
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from arena_pedsim.forces.forces import sight_weight, social_force, wall_force

near = st.floats(-4.0, 4.0)
pace = st.floats(-1.5, 1.5)


@pytest.fixture
def numbers(make_model):
    return make_model().parameters.view(np.recarray)[0]


def published(dx, dy, dvx, dvy, radii, n):
    """Write Moussaid's force down as the paper has it."""
    separation = math.hypot(dx, dy)
    e = np.array((dx, dy)) / separation
    interaction = n.social_lambda_importance * np.array((dvx, dvy)) + e
    length = np.linalg.norm(interaction)
    t = interaction / length
    b = n.social_gamma * length
    theta = math.atan2(t[0] * e[1] - t[1] * e[0], t @ e) + b * n.social_epsilon
    d = max(separation - radii, 0.0)
    along, across = (
        math.exp(-d / b - (n.social_n_prime * b * theta) ** 2),
        math.exp(-d / b - (n.social_n * b * theta) ** 2),
    )
    return -(along * t + math.copysign(1.0, theta) * across * np.array((-t[1], t[0])))


@given(near, near, pace, pace, st.floats(0.0, 1.0))
def test_social_force_is_the_published_one(dx, dy, dvx, dvy, radii):
    n = SimpleNamespace(
        social_lambda_importance=2.0, social_gamma=0.35, social_n=2.0, social_n_prime=3.0, social_epsilon=0.005
    )
    if (
        math.hypot(dx, dy) < 1e-6
        or math.hypot(2.0 * dvx + dx / math.hypot(dx, dy), 2.0 * dvy + dy / math.hypot(dx, dy)) < 1e-3
    ):
        return
    expected = published(dx, dy, dvx, dvy, radii, n)
    # less than 0.1 % is left out
    assert np.allclose(social_force.py_func(dx, dy, dvx, dvy, radii, n)[:2], expected, atol=1e-3)


def test_compiled_force_is_the_published_one(numbers):
    for args in ((1.0, 0.2, 0.4, -0.1, 0.6), (0.5, 0.0, 0.0, 0.0, 0.6), (-1.0, 1.0, -0.5, 0.3, 0.4)):
        assert np.allclose(social_force(*args, numbers)[:2], published(*args, numbers), atol=1e-12)


def test_people_in_one_place_push_each_other_by_a_finite_force(numbers):
    assert np.isfinite(social_force(0.0, 0.0, 0.0, 0.0, 0.6, numbers)).all()
    assert np.isfinite(social_force(0.5, 0.0, -0.5, 0.0, 0.6, numbers)).all()  # no interaction length at all


def test_who_meets_somebody_head_on_turns_to_the_right(numbers):
    fx, fy, ex, ey = social_force(2.0, 0.0, 1.0, 0.0, 0.6, numbers)
    assert fx < 0.0
    assert fy < 0.0
    assert (ex, ey) == (1.0, 0.0)


def test_force_falls_with_the_gap(numbers):
    sizes = [np.hypot(*social_force(gap + 0.6, 0.1, 0.5, 0.0, 0.6, numbers)[:2]) for gap in np.linspace(0.05, 3.0, 30)]
    assert (np.diff(sizes) < 0.0).all()


def test_people_ahead_count_most():
    ahead, aside, behind = (sight_weight(1.0, 0.0, *towards, 0.12) for towards in ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0)))
    assert (ahead, aside, behind) == pytest.approx((1.0, 0.56, 0.12))


@pytest.mark.parametrize(("form", "at_zero", "at_half"), [("exponential", 1.0, math.exp(-5.0)), ("inverse", 10.0, 2.0)])
def test_walls_push_by_the_chosen_form(make_model, form, at_zero, at_half):
    numbers = make_model(walls={"form": form}).parameters[0]
    assert wall_force(0.0, numbers) == pytest.approx(at_zero)
    assert wall_force(-0.1, numbers) == pytest.approx(at_zero)
    assert wall_force(0.5, numbers) == pytest.approx(at_half)
    assert wall_force(2.0, numbers) == 0.0
