"""Intervals: right in the mean, the same every time, absent where nothing is known."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.stats import bootstrap

from arena_metrics.intervals import bca, estimate, estimates


def test_wilson_interval_of_fourteen_in_fifteen():
    found = estimate([1.0] * 14 + [0.0], proportion=True)
    assert (found.low, found.high) == pytest.approx((0.7018, 0.9881), abs=1e-4)
    assert found.method == "Wilson"


def test_proportion_of_one_keeps_a_lower_end_below_one():
    assert estimate([1.0] * 15, proportion=True).low == pytest.approx(0.7961, abs=1e-4)


def test_bca_agrees_with_scipy():
    values = np.random.default_rng(5).gamma(1.5, 2.0, 15)
    peer = bootstrap((values,), np.mean, method="BCa", n_resamples=20000, rng=np.random.default_rng(1)).confidence_interval
    found = estimate(values)
    assert (found.low, found.high) == pytest.approx((peer.low, peer.high), rel=0.03)


def test_interval_covers_the_true_mean_about_as_often_as_it_says():
    samples = np.random.default_rng(2).normal(3.0, 1.0, (15, 2000))
    low, high = bca(samples)
    assert 0.90 < ((low <= 3.0) & (high >= 3.0)).mean() < 0.97


def test_single_episode_has_no_interval():
    found = estimate([2.5])
    assert (found.mean, found.n, found.has_interval) == (2.5, 1, False)
    assert math.isnan(found.low)
    assert not estimate([1.0], proportion=True).has_interval


def test_undefined_episodes_are_left_out():
    found = estimate([1.0, math.nan, 3.0])
    assert (found.mean, found.n) == (2.0, 2)
    nothing = estimate([math.nan])
    assert nothing.n == 0
    assert math.isnan(nothing.mean)


def test_equal_values_give_a_point():
    found = estimate([0.3] * 7)
    assert (found.low, found.high) == pytest.approx((0.3, 0.3))


def test_an_estimate_does_not_depend_on_its_neighbours():
    columns = [[1.0, 2.0, 4.0], [0.0, 1.0, 1.0], [5.0, math.nan, 6.0]]
    together = estimates(columns, [False, True, False])
    assert together == [estimate(columns[0]), estimate(columns[1], True), estimate(columns[2])]


samples = st.lists(st.floats(-1e3, 1e3), min_size=2, max_size=20)


@settings(derandomize=True, deadline=None, max_examples=40)
@given(samples, st.floats(0.1, 10.0), st.floats(-100.0, 100.0))
def test_interval_moves_and_scales_with_the_values(values, scale, shift):
    found, moved = estimate(values), estimate(scale * np.array(values) + shift)
    assert moved.low == pytest.approx(scale * found.low + shift, abs=1e-5)
    assert moved.high == pytest.approx(scale * found.high + shift, abs=1e-5)
    assert found.low <= found.mean + 1e-9
    assert found.mean <= found.high + 1e-9
