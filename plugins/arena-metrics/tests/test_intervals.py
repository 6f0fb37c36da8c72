"""Intervals: right in the mean, the same every time, blind to repeats, absent where nothing is known."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.stats import binom, chi2, sem, t
from statsmodels.stats.proportion import proportion_confint

from arena_core.statistics import estimate


def test_proportion_has_the_interval_of_agresti_and_coull():
    found, peer = estimate([1.0] * 11 + [0.0] * 4, True), proportion_confint(11, 15, method="agresti_coull")
    assert (found.low, found.high) == pytest.approx(peer)
    assert (found.method, found.n, found.problems) == ("Agresti-Coull", 15, 15)


@pytest.mark.parametrize("n", [15, 50, 300])
def test_proportions_are_covered_whatever_they_are(n):
    """Summed over all outcomes, not drawn: Wilson's interval comes down to 0.915 here."""
    found = [estimate(np.arange(n) < k, True) for k in range(n + 1)]
    low, high = (np.array([getattr(one, end) for one in found]) for end in ("low", "high"))
    for p in np.linspace(0.02, 0.98, 97):
        assert binom.pmf(np.arange(n + 1), n, p)[(low <= p) & (p <= high)].sum() > 0.93


def test_numbers_of_events_have_the_exact_interval_of_garwood():
    found = estimate([0.0, 1.0] * 10, "count")
    assert (found.low, found.high) == pytest.approx((chi2.ppf(0.025, 20) / 40, chi2.ppf(0.975, 22) / 40))
    nothing = estimate(np.zeros(20), "count")
    assert (nothing.low, nothing.high) == pytest.approx((0.0, -np.log(0.025) / 20))


def test_events_that_come_in_bunches_are_less_sure():
    spread, bunched = estimate([1.0] * 10 + [0.0] * 10, "count"), estimate([5.0] * 2 + [0.0] * 18, "count")
    assert spread.mean == bunched.mean
    assert bunched.high - bunched.low > 1.8 * (spread.high - spread.low)


def test_figures_have_an_interval_at_least_as_wide_as_that_of_student():
    values = np.random.default_rng(5).gamma(1.5, 2.0, 15)
    found, (low, high) = estimate(values), t.interval(0.95, 14, values.mean(), sem(values))
    assert found.low <= low + 1e-9
    assert found.high > high  # the long tail is on this side
    assert found.method == "studentised bootstrap"


def test_repeats_of_a_problem_are_no_more_problems():
    values = np.random.default_rng(6).gamma(2.0, 1.0, 9)
    labels = [i for i in range(9) for _ in range(10)]
    once, often, blind = (
        estimate(values),
        estimate(np.repeat(values, 10), problems=labels),
        estimate(np.repeat(values, 10)),
    )
    assert (often.low, often.high, often.n, often.problems) == pytest.approx((once.low, once.high, 90, 9))
    assert blind.high - blind.low < 0.5 * (once.high - once.low)
    share, shares = estimate(values > 2.0, True), estimate(np.repeat(values > 2.0, 10), True, labels)
    assert shares.high - shares.low > share.high - share.low  # nine problems, and Student's t


@pytest.mark.parametrize("kind", ["figure", "proportion", "count"])
def test_fewer_than_five_problems_give_no_interval(kind):
    values = [1.0, 0.0, 1.0, 1.0] * 10
    assert not estimate(values, kind, [0, 1, 2, 3] * 10).has_interval
    assert estimate([*values, 1.0], kind, [0, 1, 2, 3] * 10 + [4]).has_interval


def test_worlds_are_strata():
    """Two worlds of very different figures: what differs between them is no luck of the draw."""
    random = np.random.default_rng(7)
    values = np.concatenate((random.normal(0.0, 1.0, 10), random.normal(100.0, 1.0, 10)))
    within = estimate(values, worlds=["a"] * 10 + ["b"] * 10)
    assert within.high - within.low < 2.0 < 20.0 < estimate(values).high - estimate(values).low
    alone = estimate(np.append(values, 100.0), worlds=["a"] * 10 + ["b"] * 10 + ["c"])
    assert alone.high - alone.low < 3.0


def test_single_episode_has_no_interval():
    found = estimate([2.5])
    assert (found.mean, found.n, found.has_interval) == (2.5, 1, False)
    assert math.isnan(found.low)
    assert not estimate([1.0], True).has_interval


def test_undefined_episodes_are_left_out():
    found = estimate([1.0, math.nan, 3.0])
    assert (found.mean, found.n) == (2.0, 2)
    nothing = estimate([math.nan])
    assert nothing.n == 0
    assert math.isnan(nothing.mean)


def test_interval_of_a_bounded_figure_stays_in_its_bounds():
    values = [1.0] * 7 + [0.2]
    free = estimate(values)
    assert free.high > 1.0
    held = free.within(0.0, 1.0)
    assert (held.low, held.high, held.mean) == (free.low, 1.0, free.mean)
    assert math.isnan(estimate([1.0]).within(0.0, 1.0).low)


def test_equal_values_give_a_point():
    found = estimate([0.3] * 7)
    assert (found.low, found.high) == pytest.approx((0.3, 0.3))


def test_hundreds_of_episodes_take_students_t():
    found = estimate(np.random.default_rng(0).normal(size=300))
    assert found.method == "Student's t"
    assert found.low < found.mean < found.high


samples = st.lists(st.floats(-1e3, 1e3), min_size=5, max_size=20)


@settings(derandomize=True, deadline=None, max_examples=40)
@given(samples, st.floats(0.1, 10.0), st.floats(-100.0, 100.0))
def test_interval_moves_and_scales_with_the_values(values, scale, shift):
    found, moved = estimate(values), estimate(scale * np.array(values) + shift)
    assert moved.low == pytest.approx(scale * found.low + shift, abs=1e-5)
    assert moved.high == pytest.approx(scale * found.high + shift, abs=1e-5)
    assert found.low <= found.mean + 1e-9
    assert found.mean <= found.high + 1e-9
