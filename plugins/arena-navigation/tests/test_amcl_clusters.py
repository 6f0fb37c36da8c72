import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arena_navigation.amcl.clusters import Moments, best_cluster, label_clusters
from arena_navigation.amcl.directions import PlacedParticles
from arena_navigation.amcl.filter import make_cloud
from arena_navigation.amcl.histogram import add_bin, bin_key, clear_bins, find_bin, make_histogram

poses_list = st.lists(
    st.tuples(st.floats(-3, 3), st.floats(-3, 3), st.floats(-3.14159, 3.14159)), min_size=1, max_size=60
)


def estimate(poses, weights):
    poses, weights = np.ascontiguousarray(np.array(poses, float).T), np.array(weights, float)
    count = len(weights)
    mean, covariance, scratch = np.empty(3), np.empty((3, 3)), make_cloud(count, 1)
    directions = np.stack((np.cos(poses[2]), np.sin(poses[2])))
    best_cluster(
        PlacedParticles(poses, directions, count), weights / weights.sum(), scratch.clusters, Moments(mean, covariance)
    )
    assert (scratch.clusters.bins.keys == -1).all()
    return mean, covariance


def blob(x, y, theta, count, seed):
    return np.random.default_rng(seed).normal((x, y, theta), (0.1, 0.2, 0.05), (count, 3))


def linked(a, b):
    """Return whether two poses lie in the same bin or in bins that touch."""
    turns = (np.floor((a[2] + np.pi) * 18 / np.pi) - np.floor((b[2] + np.pi) * 18 / np.pi)) % 36
    apart = np.abs(np.floor(np.array(a[:2]) / 0.5) - np.floor(np.array(b[:2]) / 0.5)).max()
    return apart <= 1 and turns in (0, 1, 35)


def test_mean_and_covariance_are_those_of_the_weighted_particles():
    poses, weights = blob(1.0, 2.0, 0.3, 400, 3), np.random.default_rng(4).random(400)
    mean, covariance = estimate(poses, weights)
    np.testing.assert_allclose(mean[:2], np.average(poses[:, :2], axis=0, weights=weights), atol=1e-12)
    assert mean[2] == pytest.approx(np.average(poses[:, 2], weights=weights), abs=1e-4)
    np.testing.assert_allclose(covariance, np.cov(poses.T, aweights=weights, ddof=0), atol=1e-6)


def test_the_estimate_is_the_heavier_of_two_modes_not_a_point_between():
    poses = np.concatenate((blob(0.0, 0.0, 0.0, 300, 1), blob(6.0, 0.0, 0.0, 200, 2)))
    weights = np.concatenate((np.full(300, 0.2), np.full(200, 0.8)))
    mean, covariance = estimate(poses, weights)
    assert mean[0] == pytest.approx(6.0, abs=0.05)
    assert covariance[0, 0] < 0.05


def test_headings_on_both_sides_of_half_a_turn_are_one_cluster():
    poses = blob(0.2, 0.2, 0.0, 300, 5)
    turned = poses.copy()
    turned[:, 2] = (poses[:, 2] + 2 * np.pi) % (2 * np.pi) - np.pi
    mean, covariance = estimate(turned, np.ones(300))
    straight, expected = estimate(poses, np.ones(300))
    assert abs(mean[2]) == pytest.approx(np.pi, abs=0.02)
    np.testing.assert_allclose(covariance, expected, atol=1e-9)
    np.testing.assert_allclose(mean[:2], straight[:2])


@settings(derandomize=True, deadline=None)
@given(poses_list)
def test_clusters_are_the_connected_components_of_touching_bins(poses):
    scratch = make_cloud(len(poses), 1).clusters
    label_clusters(np.ascontiguousarray(np.array(poses).T), len(poses), scratch)
    labels = scratch.cluster_of[scratch.bin_of[: len(poses)]]
    component = list(range(len(poses)))
    for i, a in enumerate(poses):
        for j in range(i):
            if linked(a, poses[j]) and component[i] != component[j]:
                component = [component[i] if c == component[j] else c for c in component]
    same = np.equal.outer(component, component)
    np.testing.assert_array_equal(np.equal.outer(labels, labels), same)


@settings(derandomize=True, deadline=None)
@given(st.lists(st.integers(0, 40), max_size=60))
def test_histogram_numbers_bins_as_they_come(values):
    bins, expected = make_histogram(64), {}
    for value in values:
        number = add_bin(bins, bin_key(0.5 * value, -3.0, 0.1), len(expected))
        assert number == expected.setdefault(value, len(expected))
    for value in range(41):
        assert find_bin(bins, bin_key(0.5 * value, -3.0, 0.1)) == expected.get(value, -1)
    clear_bins(bins, len(expected))
    assert (bins.keys == -1).all()


def test_bins_are_half_a_metre_and_ten_degrees():
    assert bin_key(0.01, 0.01, 0.01) == bin_key(0.49, 0.49, 0.17)
    assert (
        len({int(bin_key(x, y, t)) for x in (-0.1, 0.1, 0.6) for y in (-0.1, 0.1, 0.6) for t in (-0.1, 0.1, 0.2)}) == 27
    )
    assert bin_key(0.0, 0.0, np.pi) == bin_key(0.0, 0.0, -np.pi)
