"""Each kind of interval against its published formula, for single episodes and for problems that were repeated."""

import math

import numpy as np
import pytest
from scipy.stats import chi2, norm, sem, t

from arena_core.statistics import estimate, make_clusters
from arena_core.statistics.clusters import resample_counts
from arena_core.statistics.intervals import design_effect, no_scatter, pivot_quantile

SKEWED = np.array([1.0, 1.2, 0.9, 1.1, 6.0, 1.3])
REPEATED = np.array([1.0, 1.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0])
PAIRS = [0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 5, 5]


def test_figures_have_the_wider_of_the_studentised_bootstrap_and_student():
    found, sample = estimate(SKEWED), make_clusters(SKEWED, None, None)
    mean, error = SKEWED.mean(), sem(SKEWED)
    drawn = resample_counts((6,)).astype(int)
    again = np.array([np.repeat(SKEWED, row) for row in drawn])
    errors = np.maximum(again.std(axis=1, ddof=1) / math.sqrt(6), 0.35 * error)
    under, over = np.quantile((again.mean(axis=1) - mean) / errors, (0.025, 0.975))
    half = t.ppf(0.975, 5) * error
    assert found.low == pytest.approx(mean - max(over * error, half))
    assert found.high == pytest.approx(mean - min(under * error, -half))
    assert found.high - mean > 1.2 * half, "the tail is on this side"
    assert sample.problems == found.problems == 6


@pytest.mark.parametrize(("n", "method"), [(200, "studentised bootstrap"), (201, "Student's t")])
def test_more_than_two_hundred_problems_take_students_t(n, method):
    values = np.random.default_rng(0).normal(size=n)
    found = estimate(values)
    assert found.method == method
    if n > 200:
        half = t.ppf(0.975, n - 1) * sem(values)
        assert (found.low, found.high) == pytest.approx((values.mean() - half, values.mean() + half))


@pytest.mark.parametrize(("n", "has"), [(4, False), (5, True)])
@pytest.mark.parametrize("kind", ["figure", "proportion", "count"])
def test_an_interval_takes_five_problems(n, has, kind):
    assert estimate([1.0, 0.0] * n, kind, [i // 2 for i in range(2 * n)]).has_interval == has


def test_design_effect_is_how_many_times_the_variance_is_that_of_independent_episodes():
    sample = make_clusters(REPEATED, PAIRS, None)
    alone = REPEATED.var(ddof=1) / 12.0
    by_problem = REPEATED.reshape(6, 2).mean(axis=1)
    assert design_effect(REPEATED, sample) == pytest.approx(by_problem.var(ddof=1) / 6.0 / alone)
    assert design_effect(REPEATED, make_clusters(REPEATED, None, None)) == 1.0


def test_design_effect_is_at_least_1_and_the_repeats_where_all_values_are_alike():
    opposite = np.array([0.0, 1.0] * 5)
    assert design_effect(opposite, make_clusters(opposite, [i // 2 for i in range(10)], None)) == 1.0
    alike = np.ones(10)
    assert design_effect(alike, make_clusters(alike, [i // 2 for i in range(10)], None)) == 2.0


def test_single_episodes_go_by_the_normal_quantile_and_repeats_by_students():
    assert pivot_quantile(make_clusters(REPEATED, None, None)) == pytest.approx(norm.ppf(0.975))
    assert pivot_quantile(make_clusters(REPEATED, PAIRS, None)) == pytest.approx(t.ppf(0.975, 5))


def test_repeated_proportions_count_as_that_many_independent_episodes():
    found = estimate(REPEATED, True, PAIRS)
    n, z = 12.0 / design_effect(REPEATED, make_clusters(REPEATED, PAIRS, None)), t.ppf(0.975, 5)
    centre = (8.0 / 12.0 * n + z**2 / 2.0) / (n + z**2)
    half = z * math.sqrt(centre * (1.0 - centre) / (n + z**2))
    assert (found.low, found.high) == pytest.approx((max(0.0, centre - half), min(1.0, centre + half)))
    assert (found.mean, found.n, found.problems) == (pytest.approx(8.0 / 12.0), 12, 6)


def test_proportions_stay_between_0_and_1():
    none, all_of_them = estimate(np.zeros(8), True), estimate(np.ones(8), True)
    assert (none.low, all_of_them.high) == (0.0, 1.0)
    z = norm.ppf(0.975)
    centre = z**2 / 2.0 / (8.0 + z**2)
    assert none.high == pytest.approx(centre + z * math.sqrt(centre * (1.0 - centre) / (8.0 + z**2)))
    assert all_of_them.low == pytest.approx(1.0 - none.high)


def test_events_in_bunches_count_as_fewer():
    """Variance over mean, times the square of Student's quantile over the normal one, events are one."""
    values = np.array([4.0, 0.0, 0.0, 0.0, 5.0, 0.0, 0.0, 3.0, 0.0, 0.0])
    found = estimate(values, "count")
    bunched = values.var(ddof=1) / 1.2 * (t.ppf(0.025, 9) / norm.ppf(0.025)) ** 2
    events, each = 12.0 / bunched, bunched / 10.0
    assert found.low == pytest.approx(each * 0.5 * chi2.ppf(0.025, 2.0 * events))
    assert found.high == pytest.approx(each * 0.5 * chi2.ppf(0.975, 2.0 * (events + 1.0)))
    assert (found.mean, found.n, found.problems) == (pytest.approx(1.2), 10, 10)


def test_problems_of_equal_figures_have_no_scatter_but_for_rounding():
    values = np.array([0.1 + 0.2, 0.3, 0.3, 0.3, 0.3])
    assert no_scatter(make_clusters(values, None, None), sem(values))
    assert estimate(values).method == "Student's t"
    other = np.array([0.3 + 1e-9, 0.3, 0.3, 0.3, 0.3])
    assert not no_scatter(make_clusters(other, None, None), sem(other))
    assert estimate(np.zeros(5)).method == "Student's t"
