import numpy as np
import pytest
from filterpy.monte_carlo import systematic_resample
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.stats import chi2, norm

from arena_navigation.amcl.draws import Draw
from arena_navigation.amcl.histogram import bin_key, make_histogram
from arena_navigation.amcl.resampling import (
    BinnedParticles,
    FreeSpace,
    Injection,
    ParticleLimits,
    _particle_at,
    accumulate_weights,
    draw_independently,
    free_pose,
    is_scattered,
    kld_bound,
    particles_needed,
    resample_systematically,
)

KEY = np.uint64(5)
WIDE = ParticleLimits(1, 100_000, 0.05, 0.99, False)
NOWHERE = FreeSpace(np.zeros(1, np.int64), 1, 0.05)
weight_lists = st.lists(st.floats(1e-6, 1.0), min_size=1, max_size=60).map(lambda w: np.array(w) / np.sum(w))


def chosen(weights, offset, count=None):
    cumulative, picked = np.empty(len(weights)), np.empty(count or len(weights), np.int32)
    accumulate_weights(weights, len(weights), cumulative)
    resample_systematically(cumulative, len(weights), offset, picked)
    return picked


def drawn_count(poses, weights, limits, occupied=10**6, injection=0.0, free=NOWHERE, tick=1):
    keys, cumulative = np.array([bin_key(*pose) for pose in poses]), np.empty(len(weights))
    accumulate_weights(weights, len(weights), cumulative)
    return particles_needed(
        BinnedParticles(keys, cumulative, len(weights), make_histogram(5000)),
        occupied,
        Injection(injection, free),
        limits,
        Draw(KEY, tick),
    )


@settings(derandomize=True, deadline=None)
@given(weights=weight_lists, seed=st.integers(0, 2**31))
def test_systematic_resampling_equals_filterpy(weights, seed):
    np.random.seed(seed)  # noqa: NPY002 - filterpy draws from numpy's global state
    offset = np.random.random()  # noqa: NPY002
    np.random.seed(seed)  # noqa: NPY002
    np.testing.assert_array_equal(chosen(weights, offset), systematic_resample(weights))


@settings(derandomize=True, deadline=None)
@given(weights=weight_lists, count=st.integers(1, 200), offset=st.floats(0.0, 1.0, exclude_max=True))
def test_a_particle_is_chosen_as_often_as_its_weight_says_give_or_take_one(weights, count, offset):
    times = np.bincount(chosen(weights, offset, count), minlength=len(weights))
    assert times.sum() == count
    assert (np.abs(times - count * weights) < 1.0 + 1e-9).all()


def test_systematic_resampling_is_unbiased():
    weights = np.array([0.05, 0.41, 0.14, 0.4])
    offsets = (np.arange(2000) + 0.5) / 2000
    times = sum(np.bincount(chosen(weights, u, 7), minlength=4) for u in offsets) / 2000
    np.testing.assert_allclose(times, 7 * weights, atol=1e-3)


@pytest.mark.parametrize("quantile", [0.84, 0.99, 2.33])
@pytest.mark.parametrize("bins", [5, 20, 100, 500])
def test_kld_bound_is_the_chi_square_quantile_of_fox(bins, quantile):
    exact = chi2.ppf(norm.cdf(quantile), bins - 1) / (2 * WIDE.kld_err)
    assert kld_bound(bins, WIDE._replace(kld_z=quantile)) == pytest.approx(exact, rel=0.01, abs=1)


def test_kld_bound_grows_with_the_bins_within_the_limits():
    limits = ParticleLimits(100, 5000, 0.01, 0.99, False)
    bounds = [kld_bound(bins, limits) for bins in range(200)]
    assert bounds == sorted(bounds)
    assert (bounds[0], bounds[1], bounds[-1]) == (100, 100, 5000)


def test_a_wider_cloud_needs_more_particles():
    random = np.random.default_rng(1)
    weights = np.full(2000, 1 / 2000)
    clouds = [random.normal(0.0, width, (2000, 3)) * (1, 1, 0.1) for width in (0.05, 1.0, 3.0)]
    counts = [drawn_count(poses, weights, ParticleLimits(100, 5000, 0.05, 0.99, False)) for poses in clouds]
    assert counts[0] < counts[1] < counts[2]


def test_count_is_the_bound_of_the_bins_that_were_drawn():
    poses = np.stack((np.arange(30) * 0.5 + 0.25, np.zeros(30), np.zeros(30)), axis=1)
    limits = ParticleLimits(10, 5000, 0.05, 0.99, False)
    assert drawn_count(poses, np.full(30, 1 / 30), limits) == kld_bound(30, limits)


def test_particles_without_weight_do_not_ask_for_company():
    poses = np.stack((np.arange(30) * 0.5, np.zeros(30), np.zeros(30)), axis=1)
    weights = np.zeros(30)
    weights[3:5] = 0.5
    assert drawn_count(poses, weights, ParticleLimits(10, 5000, 0.05, 0.99, False)) == max(
        10, kld_bound(2, ParticleLimits(10, 5000, 0.05, 0.99, False))
    )


@settings(derandomize=True, deadline=None, max_examples=30)
@given(spread=st.floats(0.01, 1.0), seed=st.integers(0, 1000))
def test_counting_without_drawing_gives_the_same(spread, seed):
    poses = np.random.default_rng(seed).normal(0.0, spread, (300, 3)) * (1, 1, 0.1)
    weights = np.full(300, 1 / 300)
    occupied = len({int(bin_key(*pose)) for pose in poses})
    limits = ParticleLimits(200, 5000, 0.05, 0.99, False)
    assert drawn_count(poses, weights, limits, occupied) == drawn_count(poses, weights, limits)


@settings(derandomize=True, deadline=None)
@given(weights=weight_lists, point=st.floats(0.0, 1.0, exclude_max=True))
def test_holder_is_found_by_bisection(weights, point):
    cumulative = np.empty(len(weights))
    accumulate_weights(weights, len(weights), cumulative)
    assert _particle_at(cumulative, len(weights), point) == np.searchsorted(cumulative, point, side="right")


def test_scattered_share_is_the_one_asked_for():
    assert np.mean([is_scattered(KEY, 9, i, 0.3) for i in range(20_000)]) == pytest.approx(0.3, abs=0.01)
    assert not any(is_scattered(KEY, 9, i, 0.0) for i in range(100))


def test_scattered_particles_stand_on_free_cells_all_over_them():
    free = FreeSpace(np.array([2, 13, 47]), 10, 0.5)
    poses = np.array([free_pose(free, KEY, 4, i) for i in range(3000)])
    cells = np.floor(poses[:, 1] / 0.5).astype(int) * 10 + np.floor(poses[:, 0] / 0.5).astype(int)
    assert set(cells) == {2, 13, 47}
    np.testing.assert_allclose(np.bincount(cells)[[2, 13, 47]], 1000, atol=100)
    np.testing.assert_allclose(np.mod(poses[:, :2], 0.5).mean(axis=0), 0.25, atol=0.01)
    assert np.abs(poses[:, 2]).max() <= np.pi
    assert np.std(poses[:, 2]) == pytest.approx(2 * np.pi / np.sqrt(12), rel=0.03)


def test_scattered_particles_count_as_bins_of_their_own():
    free = FreeSpace(np.arange(400 * 400), 400, 0.05)
    poses, weights = np.full((100, 3), 5.0), np.full(100, 0.01)
    limits = ParticleLimits(50, 5000, 0.05, 0.99, False)
    assert drawn_count(poses, weights, limits, injection=0.5, free=free) > 10 * drawn_count(poses, weights, limits)


def drawn_independently(poses, weights, limits, tick=1):
    keys, cumulative = np.array([bin_key(*pose) for pose in poses]), np.empty(len(weights))
    accumulate_weights(weights, len(weights), cumulative)
    picked, bins = np.empty(limits.max_particles, np.int32), make_histogram(5000)
    count = draw_independently(
        BinnedParticles(keys, cumulative, len(weights), bins), Injection(0.0, NOWHERE), limits, Draw(KEY, tick), picked
    )
    return picked[:count]


def test_a_single_bin_asks_for_the_most_where_particles_are_drawn_independently():
    limits = ParticleLimits(10, 900, 0.05, 0.99, True)
    picked = drawn_independently(np.full((40, 3), 0.1), np.full(40, 1 / 40), limits)
    assert len(picked) == kld_bound(1, limits) == 900


def test_independent_draws_stop_one_beyond_what_their_bins_ask_for():
    limits = ParticleLimits(10, 5000, 0.05, 0.99, True)
    poses = np.array([(0.1 + 0.5 * k, 0.1, 0.0) for k in range(6)])
    assert len(drawn_independently(poses, np.full(6, 1 / 6), limits)) == kld_bound(6, limits) + 1


def test_independent_draws_follow_the_weights_with_the_noise_of_a_multinomial():
    weights, limits = np.array([0.05, 0.45, 0.15, 0.35]), ParticleLimits(200, 200, 0.05, 0.99, True)
    times = np.array(
        [np.bincount(drawn_independently(np.zeros((4, 3)), weights, limits, tick), minlength=4) for tick in range(400)]
    )
    np.testing.assert_allclose(times.mean(axis=0) / 200, weights, atol=0.01)
    np.testing.assert_allclose(times.var(axis=0), 200 * weights * (1 - weights), rtol=0.3)
