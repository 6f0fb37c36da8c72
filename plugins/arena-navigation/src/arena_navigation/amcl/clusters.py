"""The pose that the particles agree on: mean and covariance of the heaviest cluster, so that no
mean lies between two modes.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arena_kernels.compiled import borrowing
from arena_kernels.scalars import Integer
from arena_navigation.amcl.directions import PlacedParticles, wrap_angle
from arena_navigation.amcl.histogram import Histogram, add_bin, clear_bins, find_bin, neighbour_key, write_keys
from arena_navigation.columns import COSINE, SINE, THETA, X, Y


class Clusters(NamedTuple):
    """Scratch space: the bin of each particle (key and number), the cluster and the weight of each bin;
    ``open`` is a stack of bins.
    """

    bins: Histogram
    keys: NDArray[np.int64]
    bin_of: NDArray[np.int32]
    cluster_of: NDArray[np.int32]
    weight_of: NDArray[np.float64]
    open: NDArray[np.int32]


class Moments(NamedTuple):
    """Room for an estimate: the mean pose (3,) and its covariance (3, 3)."""

    mean: NDArray[np.float64]
    covariance: NDArray[np.float64]


@borrowing
def label_clusters(poses: NDArray[np.float64], count: Integer, clusters: Clusters) -> Integer:
    """Give all bins that touch one another, by a side or a corner, one cluster
    number; return how many bins there are.
    """
    filled: Integer = np.int64(0)
    write_keys(poses, count, clusters.keys)
    for i in range(count):
        number = add_bin(clusters.bins, clusters.keys[i], filled)
        clusters.bin_of[i] = number
        filled = max(filled, number + 1)
    for b in range(filled):
        clusters.cluster_of[b] = -1
    for seed in range(filled):
        if clusters.cluster_of[seed] < 0:
            _flood_cluster(clusters, seed)
    return filled


@borrowing
def _flood_cluster(clusters: Clusters, seed: int) -> None:
    clusters.cluster_of[seed] = seed
    clusters.open[0] = seed
    waiting = 1
    while waiting:
        waiting -= 1
        key = clusters.bins.keys[clusters.bins.slots[clusters.open[waiting]]]
        for step in range(27):
            other = find_bin(clusters.bins, neighbour_key(key, step // 9 - 1, step // 3 % 3 - 1, step % 3 - 1))
            if other >= 0 and clusters.cluster_of[other] < 0:
                clusters.cluster_of[other] = seed
                clusters.open[waiting] = other
                waiting += 1


@borrowing
def heaviest_cluster(weights: NDArray[np.float64], count: Integer, clusters: Clusters, filled: Integer) -> Integer:
    """Return the number of the cluster with the largest weight."""
    for b in range(filled):
        clusters.weight_of[b] = 0.0
    for i in range(count):
        clusters.weight_of[clusters.cluster_of[clusters.bin_of[i]]] += weights[i]
    best = 0
    for b in range(1, filled):
        if clusters.weight_of[b] > clusters.weight_of[best]:
            best = b
    return best


@borrowing
def write_moments(
    particles: PlacedParticles, weights: NDArray[np.float64], clusters: Clusters, cluster: Integer, moments: Moments
) -> None:
    """Write mean (3,) and covariance (3, 3) of a cluster; the mean heading is the circular one,
    deviations from it are wrapped.
    """
    total, x, y, c, s = 0.0, 0.0, 0.0, 0.0, 0.0
    for i in range(particles.number):
        if clusters.cluster_of[clusters.bin_of[i]] == cluster:
            w = weights[i]
            total += w
            x += w * particles.poses[X, i]
            y += w * particles.poses[Y, i]
            c += w * particles.directions[COSINE, i]
            s += w * particles.directions[SINE, i]
    moments.mean[X], moments.mean[Y], moments.mean[THETA] = x / total, y / total, np.arctan2(s, c)
    moments.covariance[:] = 0.0
    for i in range(particles.number):
        if clusters.cluster_of[clusters.bin_of[i]] == cluster:
            w = weights[i] / total
            dx, dy = particles.poses[X, i] - moments.mean[X], particles.poses[Y, i] - moments.mean[Y]
            turn = wrap_angle(particles.poses[THETA, i] - moments.mean[THETA])
            moments.covariance[X, X] += w * dx * dx
            moments.covariance[X, Y] += w * dx * dy
            moments.covariance[X, THETA] += w * dx * turn
            moments.covariance[Y, Y] += w * dy * dy
            moments.covariance[Y, THETA] += w * dy * turn
            moments.covariance[THETA, THETA] += w * turn * turn
    moments.covariance[Y, X], moments.covariance[THETA, X], moments.covariance[THETA, Y] = (
        moments.covariance[X, Y],
        moments.covariance[X, THETA],
        moments.covariance[Y, THETA],
    )


@borrowing
def best_cluster(
    particles: PlacedParticles, weights: NDArray[np.float64], clusters: Clusters, moments: Moments
) -> Integer:
    """Write mean and covariance of the heaviest cluster of particles; return how many bins hold any."""
    filled = label_clusters(particles.poses, particles.number, clusters)
    write_moments(
        particles,
        weights,
        clusters,
        heaviest_cluster(weights, particles.number, clusters, filled),
        moments,
    )
    clear_bins(clusters.bins, filled)
    return filled
