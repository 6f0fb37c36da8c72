"""Interquartile means and what training seeds say, against sorting and counting."""

import math

import numpy as np
import pytest
from scipy.stats import trim_mean
from statsmodels.stats.proportion import proportion_confint

from arena_core.base.random_streams import random_generator
from arena_core.statistics import interquartile_mean, middle_half, over_seeds, wilson
from arena_core.statistics.aggregates import RESAMPLES

SCORES = np.array([9.0, 1.0, 4.0, 7.0, 2.0, 100.0, 5.0, 6.0])


def test_middle_half_leaves_out_two_of_eight_on_each_side():
    assert middle_half(SCORES) == (4.0 + 5.0 + 6.0 + 7.0) / 4.0
    assert middle_half(SCORES[:3]) == pytest.approx(14.0 / 3.0), "of three none is left out"
    assert middle_half(SCORES[:4]) == 5.5
    assert middle_half(np.stack((SCORES, SCORES[::-1] + 1.0))).tolist() == [5.5, 6.5]


def test_interval_of_the_interquartile_mean_resamples_each_condition_for_itself():
    strata = [SCORES, np.array([3.0, 3.5, 8.0])]
    found = interquartile_mean(strata)
    random = random_generator(11, "report", "interquartile mean 8 3")
    drawn = [stratum[random.integers(len(stratum), size=(2000, len(stratum)))] for stratum in strata]
    means = trim_mean(np.concatenate(drawn, axis=1), 0.25, axis=1)
    assert (found.low, found.high) == pytest.approx(tuple(np.quantile(means, (0.025, 0.975))))
    assert (found.n, found.problems, RESAMPLES) == (11, 11, 2000)


@pytest.mark.parametrize(("n", "has"), [(4, False), (5, True)])
def test_interquartile_mean_takes_five_problems_for_an_interval(n, has):
    found = interquartile_mean([SCORES[:n]])
    assert found.has_interval == has
    assert found.mean == pytest.approx(trim_mean(SCORES[:n], 0.25))


def test_many_problems_are_resampled_in_parts_to_the_end():
    many = np.random.default_rng(0).normal(size=5000)  # 800 of the 2000 resamples at once
    found = interquartile_mean([many])
    assert found.high - found.low == pytest.approx(2 * 1.96 * 1.09 / math.sqrt(5000), rel=0.1)


@pytest.mark.parametrize(("k", "n"), [(0, 10), (3, 10), (10, 10), (77, 300)])
def test_wilson_is_statsmodels(k, n):
    assert wilson(k / n, n) == pytest.approx(proportion_confint(k, n, method="wilson"), abs=1e-12)
    assert wilson(0.0, n)[0] == 0.0
    assert wilson(1.0, n)[1] == 1.0


def test_seeds_are_drawn_again_within_their_group():
    groups = [[0.1, 0.5, 0.9], [0.2, 0.3]]
    mean, low, high = over_seeds(groups)
    random = random_generator(5, "trainings", "bootstrap")
    parts = [np.array(group)[random.integers(len(group), size=(5000, len(group)))] for group in groups]
    means = trim_mean(np.concatenate(parts, axis=1), 0.25, axis=1)
    assert mean == pytest.approx((0.2 + 0.3 + 0.5) / 3.0)
    assert (low, high) == pytest.approx(tuple(np.quantile(means, (0.025, 0.975))))


def test_a_single_seed_says_nothing_of_others():
    mean, low, high = over_seeds([[0.4, 0.6], [0.8]])
    assert mean == pytest.approx(0.6)
    assert math.isnan(low)
    assert math.isnan(high)
    assert math.isfinite(over_seeds([[0.4, 0.6], [0.8, 0.9]])[1]), "two are enough"
