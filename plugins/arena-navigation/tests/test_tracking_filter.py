import numpy as np
from filterpy.common import Q_continuous_white_noise
from filterpy.kalman import KalmanFilter
from hypothesis import given, settings
from hypothesis import strategies as st

from arena_navigation.tracking.discs import Discs
from arena_navigation.tracking.filter import (
    POSITION,
    VELOCITY,
    correct_radii,
    correct_tracks,
    place_by_radii,
    predict_tracks,
)

DENSITY = 0.7


def positive(random, size):
    a = random.normal(size=(size, size))
    return a @ a.T + 0.01 * np.eye(size)


def peer(state, covariance):
    peer = KalmanFilter(dim_x=4, dim_z=2)
    peer.x, peer.P = state.copy(), covariance.copy()
    peer.H = np.eye(2, 4)
    return peer


def predict_peer(peer, dt):
    peer.F = np.eye(4) + dt * np.eye(4, k=2)
    axis = Q_continuous_white_noise(2, dt, DENSITY)
    peer.Q = np.kron(axis, np.eye(2))
    peer.predict()


@settings(derandomize=True, deadline=None, max_examples=30)
@given(st.integers(0, 10**6), st.integers(1, 12), st.sampled_from((POSITION, VELOCITY)))
def test_the_filters_are_those_of_filterpy(seed, count, first):
    random = np.random.default_rng(seed)
    states, covariances = random.normal(size=(count, 4)), np.array([positive(random, 4) for _ in range(count)])
    peers = [peer(*pair) for pair in zip(states, covariances, strict=True)]
    for _ in range(5):
        dt = float(random.uniform(0.0, 0.5))
        positions, noises = random.normal(size=(count, 2)), np.array([positive(random, 2) for _ in range(count)])
        matches = np.where(random.random(count) < 0.7, random.permutation(count), -1)
        predict_tracks(states, covariances, dt, DENSITY)
        correct_tracks(states, covariances, matches, positions, noises, first)
        for other, match in zip(peers, matches, strict=True):
            predict_peer(other, dt)
            if match >= 0:
                other.update(positions[match], R=noises[match], H=np.eye(2, 4, first))
        np.testing.assert_allclose(states, [p.x for p in peers], atol=1e-9, rtol=1e-9)
        np.testing.assert_allclose(covariances, [p.P for p in peers], atol=1e-9, rtol=1e-9)


@settings(derandomize=True, deadline=None, max_examples=30)
@given(st.integers(0, 10**6))
def test_covariances_stay_symmetric_and_positive(seed):
    random = np.random.default_rng(seed)
    states, covariances = np.zeros((1, 4)), np.diag((1e-4, 1e-4, 4.0, 4.0))[None].copy()
    for _ in range(200):
        predict_tracks(states, covariances, float(random.choice((0.0, 0.02, 0.1, 3.0))), 1.0)
        correct_tracks(
            states,
            covariances,
            np.zeros(1, np.int64),
            random.normal(size=(1, 2)),
            1e-4 * positive(random, 2)[None],
            POSITION,
        )
    np.testing.assert_array_equal(covariances[0], covariances[0].T)
    assert np.linalg.eigvalsh(covariances[0]).min() > 0.0


def test_two_short_predictions_are_one_long_one():
    random = np.random.default_rng(0)
    state, covariance = random.normal(size=(1, 4)), positive(random, 4)[None]
    once, twice = (state.copy(), covariance.copy()), (state.copy(), covariance.copy())
    predict_tracks(*once, 0.3, DENSITY)
    predict_tracks(*twice, 0.1, DENSITY)
    predict_tracks(*twice, 0.2, DENSITY)
    np.testing.assert_allclose(once[0], twice[0], atol=1e-12)
    np.testing.assert_allclose(once[1], twice[1], atol=1e-12)


def test_a_radius_is_the_weighted_mean_of_what_was_measured():
    radii, variances = np.array((0.3, 0.3)), np.array((0.01, 0.01))
    correct_radii(radii, variances, np.array((0, -1)), np.array((0.4,)), np.array((0.01,)))
    np.testing.assert_allclose(radii, (0.35, 0.3))
    np.testing.assert_allclose(variances, (0.005, 0.01))


def test_a_known_radius_moves_the_disc_along_what_its_arc_leaves_open():
    discs = Discs.room(1)
    discs.positions[0], discs.radii[0], discs.radius_variances[0] = (2.1, 0.0), 0.4, 0.01
    discs.covariances[0], discs.leanings[0] = np.diag((0.0101, 0.0001)), (0.01, 0.0)
    positions, noises = np.zeros((2, 2)), np.zeros((2, 2, 2))
    place_by_radii(np.array((-1, 0)), discs, np.array((0.5, 0.3)), np.zeros(2), 0.0, positions, noises)
    np.testing.assert_allclose(positions, [(0.0, 0.0), (2.0, 0.0)])
    np.testing.assert_allclose(noises[1], np.diag((0.0001, 0.0001)), atol=1e-15)
