"""Sums by problem, the error of a mean over problems, and resamples, against closed forms and direct sums."""

import math

import numpy as np
import pytest
from scipy.stats import sem

from arena_core.statistics import make_clusters
from arena_core.statistics.clusters import LEAST_ERROR, RESAMPLES, resample_counts

VALUES = [3.0, 1.0, 4.0, 1.0, 5.0, 9.0, 2.0]


def test_single_episodes_have_the_standard_error_of_the_mean():
    sample = make_clusters(np.array(VALUES), None, None)
    assert sample.mean == pytest.approx(25.0 / 7.0)
    assert sample.error() == pytest.approx(sem(VALUES))
    assert (sample.problems, sample.freedom, sample.repeated) == (7, 6, False)


def test_values_are_summed_by_problem():
    sample = make_clusters(np.array(VALUES), list("abacbca"), None)
    assert sample.sums.tolist() == [9.0, 6.0, 10.0]
    assert sample.sizes.tolist() == [3.0, 2.0, 2.0]
    assert (sample.problems, sample.freedom, sample.repeated, sample.worlds) == (3, 2, True, (3,))


def test_problems_of_a_world_stand_together_and_single_ones_count_as_one_world():
    sample = make_clusters(np.array(VALUES), list(range(7)), list("xyxzyxw"))
    assert sample.sums.tolist() == [3.0, 4.0, 9.0, 1.0, 5.0, 1.0, 2.0]
    assert (sample.worlds, sample.freedom) == ((3, 2, 2), 4)
    alone = make_clusters(np.array(VALUES[:4]), list(range(4)), list("xxxz"))
    assert (alone.worlds, alone.freedom) == ((4,), 3), "one problem alone has no scatter"
    apart = make_clusters(np.array(VALUES[:3]), list(range(3)), list("xyz"))
    assert apart.worlds == (3,)
    assert make_clusters(np.array([2.0]), None, None).worlds == (1,)


def test_error_of_a_mean_over_repeats_is_that_of_the_linearised_ratio():
    """Cochran 1977, section 6.4: n / (n - 1) times the squares of sum less mean times size, over the episodes."""
    sample = make_clusters(np.array(VALUES), list("abacbca"), None)
    mean = 25.0 / 7.0
    squares = (9.0 - 3.0 * mean) ** 2 + (6.0 - 2.0 * mean) ** 2 + (10.0 - 2.0 * mean) ** 2
    assert sample.error() == pytest.approx(math.sqrt(3.0 / 2.0 * squares) / 7.0)


def test_error_over_worlds_is_that_of_strata():
    """Each world has its own mean: n / (n - 1) times the squares about it, summed over worlds."""
    sample = make_clusters(np.array([1.0, 3.0, 10.0, 14.0, 18.0]), None, list("xxyyy"))
    assert sample.error() == pytest.approx(math.sqrt(2.0 * 2.0 + 1.5 * 32.0) / 5.0)
    assert sample.freedom == 3


def test_one_problem_has_no_scatter():
    assert make_clusters(np.array([2.0, 6.0]), ["a", "a"], None).error() == 0.0


def test_each_resample_draws_as_many_problems_of_each_world_as_there_are():
    drawn = resample_counts((4, 3))
    assert drawn.shape == (RESAMPLES, 7) == (5000, 7)
    assert (drawn[:, :4].sum(axis=1) == 4.0).all()
    assert (drawn[:, 4:].sum(axis=1) == 3.0).all()
    assert drawn.mean(axis=0) == pytest.approx(np.ones(7), abs=0.06)


def test_pivots_are_the_means_of_resamples_in_their_own_standard_errors():
    values = np.array(VALUES)
    sample, drawn = make_clusters(values, None, None), resample_counts((7,))
    pivots = sample.pivots()
    for row in range(60):
        again = np.repeat(values, drawn[row].astype(int))
        error = max(sem(again), 0.35 * sem(values))
        assert pivots[row] == pytest.approx((again.mean() - values.mean()) / error)


def test_a_resample_without_scatter_is_measured_by_0_35_of_the_samples_error():
    values = np.array([0.0, 1.0, 2.0, 3.0, 10.0])
    sample, drawn = make_clusters(values, None, None), resample_counts((5,))
    same = np.flatnonzero(drawn.max(axis=1) == 5.0)
    assert len(same) > 0
    for row in same:
        off = values[drawn[row].argmax()] - values.mean()
        assert sample.pivots()[row] == pytest.approx(off / (0.35 * sem(values)))
    assert LEAST_ERROR == 0.35
