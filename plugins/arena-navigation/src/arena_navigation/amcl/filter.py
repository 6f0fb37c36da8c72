"""The particle filter: one compiled call for each scan that is used.

Poses are in the grid's frame, so nothing depends on where ``map`` has its origin.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arena_kernels.compiled import borrowing
from arena_kernels.random import fill_normals
from arena_kernels.scalars import Integer
from arena_navigation.amcl.beams import ExpectedWalls, ScanLayout, write_ends, write_least
from arena_navigation.amcl.clusters import Clusters, Moments, best_cluster
from arena_navigation.amcl.directions import PlacedParticles, write_directions
from arena_navigation.amcl.draws import Draw
from arena_navigation.amcl.histogram import make_histogram
from arena_navigation.amcl.motion import OdometryMotion, move_particles
from arena_navigation.amcl.ranges import View, match_ranges
from arena_navigation.amcl.resampling import (
    BinnedParticles,
    FreeSpace,
    Injection,
    ParticleLimits,
    accumulate_weights,
    draw_independently,
    free_pose,
    is_scattered,
    particles_needed,
    resample_systematically,
    resampling_offset,
)
from arena_navigation.amcl.sensor import BeamCount, EndpointLookup, LikelihoodTable, match_endpoints, update_weights
from arena_navigation.amcl.skipping import Skipping, skip_beams
from arena_navigation.columns import FAST, SLOW, THETA, UPDATES, X, Y


class ParticleCloud(NamedTuple):
    """The particles: the first ``number[0]`` columns of ``poses`` (3, P), and their normalised weights; then scratch
    space.

    ``likelihoods`` are the slow and the fast running mean of how well a beam fits, and how many values they have seen;
    ``mean`` and ``covariance`` are the estimate.
    """

    number: NDArray[np.int64]
    poses: NDArray[np.float64]
    weights: NDArray[np.float64]
    likelihoods: NDArray[np.float64]
    mean: NDArray[np.float64]
    covariance: NDArray[np.float64]
    clusters: Clusters
    directions: NDArray[np.float64]
    noise: NDArray[np.float64]
    scores: NDArray[np.float64]
    chosen: NDArray[np.int32]
    cells: NDArray[np.int32]
    fitting: NDArray[np.int32]
    drawn: NDArray[np.float64]


class Recovery(NamedTuple):
    """How fast the two running means follow, ``recovery.alpha_slow`` and ``recovery.alpha_fast``; a slow
    one of zero: no recovery.
    """

    alpha_slow: float
    alpha_fast: float


class Resampling(NamedTuple):
    """Whether this update resamples, how, and whether the estimate is made afterwards; ``free``
    is where lost particles may go.
    """

    due: bool
    estimate_after: bool
    limits: ParticleLimits
    free: FreeSpace
    recovery: Recovery


class Update(NamedTuple):
    """What an update does besides weighing: how the particles move, how they are resampled, and its random numbers."""

    motion: OdometryMotion
    resampling: Resampling
    draw: Draw


class EndpointModel(NamedTuple):
    """The likelihood field that beams are weighed by, and which of them are skipped."""

    field: LikelihoodTable
    skipping: Skipping


class ScanInputs(NamedTuple):
    """A scan's ranges, the shortest and the longest that count (m), the walls it should show, and its layout."""

    ranges: NDArray[np.float32]
    limits: tuple[float, float]
    walls: ExpectedWalls
    look: ScanLayout


def make_cloud(capacity: int, beams: int) -> ParticleCloud:
    """Return room for ``capacity`` particles and scans of up to ``beams`` beams."""
    clusters = Clusters(
        make_histogram(capacity),
        np.empty(capacity, np.int64),
        np.empty(capacity, np.int32),
        np.empty(capacity, np.int32),
        np.empty(capacity),
        np.empty(capacity, np.int32),
    )
    return ParticleCloud(
        np.zeros(1, np.int64),
        np.empty((3, capacity)),
        np.empty(capacity),
        np.zeros(3),
        np.zeros(3),
        np.zeros((3, 3)),
        clusters,
        np.empty((2, capacity)),
        np.empty(3 * capacity),
        np.empty(capacity),
        np.empty(capacity, np.int32),
        np.empty(beams, np.int32),
        np.empty(beams, np.int32),
        np.empty((3, capacity)),
    )


@borrowing
def draw_particles(cloud: ParticleCloud, mean: NDArray[np.float64], root: NDArray[np.float64], key: np.uint64) -> None:
    """Draw all particles from a normal distribution;

    ``root`` (3, 3) times its transpose is the covariance. Takes tick 0.
    """
    capacity = cloud.poses.shape[1]
    cloud.number[0] = capacity
    cloud.weights[:] = 1.0 / capacity
    cloud.likelihoods[:] = 0.0
    fill_normals(key, np.int64(0), cloud.noise)
    for i in range(capacity):
        a, b, c = cloud.noise[3 * i], cloud.noise[3 * i + 1], cloud.noise[3 * i + 2]
        for axis in range(3):
            cloud.poses[axis, i] = mean[axis] + root[axis, X] * a + root[axis, Y] * b + root[axis, THETA] * c


@borrowing
def filter_scan(cloud: ParticleCloud, update: Update, scan: ScanInputs, model: EndpointModel) -> None:
    """Run one update by those of the beams that have not hit people."""
    write_least(scan.walls, scan.look)
    kept, explained = write_ends(scan.ranges, scan.limits[0], scan.limits[1], scan.look)
    ends = scan.look.ends[: 2 * kept].reshape(2, kept)
    filter_update(cloud, update, ends, explained, model)


@borrowing
def filter_update(
    cloud: ParticleCloud, update: Update, beams: NDArray[np.float32], explained: float, model: EndpointModel
) -> None:
    """Move the particles, weigh them by where the beams end (2, B) on a likelihood field, estimate, and resample if it
    is due.

    ``explained`` is the share of the beams that were not left out of ``beams``: those left out count as not fitting at
    all.
    """
    particles = PlacedParticles(cloud.poses, cloud.directions, cloud.number[0])
    lookup = EndpointLookup(beams, model.field, cloud.cells)
    move_particles(particles, update.motion, update.draw, cloud.noise)
    number = skip_beams(particles, lookup, model.skipping, cloud.fitting)
    match_endpoints(particles, lookup, number, cloud.scores)
    finish_update(cloud, BeamCount(number, model.field.product), explained, update.resampling, update.draw)


@borrowing
def filter_update_by_ranges(
    cloud: ParticleCloud, update: Update, ranges: NDArray[np.float32], explained: float, view: View
) -> None:
    """Do the same by the beam model: ``ranges`` (B,) m, not a number where one is left out."""
    particles = PlacedParticles(cloud.poses, cloud.directions, cloud.number[0])
    move_particles(particles, update.motion, update.draw, cloud.noise)
    number = match_ranges(particles, ranges, view, cloud.scores)
    finish_update(cloud, BeamCount(number, False), explained, update.resampling, update.draw)


@borrowing
def finish_update(cloud: ParticleCloud, fit: BeamCount, explained: float, resampling: Resampling, draw: Draw) -> None:
    """Turn the scores of so many beams into weights, estimate, and resample if it is due."""
    likelihood = update_weights(cloud.weights, cloud.number[0], cloud.scores, fit)
    occupied = estimate_pose(cloud)
    if fit.beams > 0:
        update_averages(cloud.likelihoods, explained * likelihood, resampling.recovery)
    if resampling.due:
        resample_particles(
            cloud,
            occupied,
            Injection(injection_share(cloud.likelihoods, resampling.recovery), resampling.free),
            resampling.limits,
            draw,
        )
        if resampling.estimate_after:
            write_directions(cloud.poses[THETA], cloud.number[0], cloud.directions)
            estimate_pose(cloud)


@borrowing
def estimate_pose(cloud: ParticleCloud) -> Integer:
    """Write the mean and the covariance of the heaviest cluster; return how many bins hold particles."""
    return best_cluster(
        PlacedParticles(cloud.poses, cloud.directions, cloud.number[0]),
        cloud.weights,
        cloud.clusters,
        Moments(cloud.mean, cloud.covariance),
    )


@borrowing
def update_averages(likelihoods: NDArray[np.float64], likelihood: float, recovery: Recovery) -> None:
    """Let the slow and the fast running mean follow (Probabilistic Robotics, table 8.3); the
    first values are averaged evenly.
    """
    likelihoods[UPDATES] += 1.0
    likelihoods[SLOW] += max(recovery.alpha_slow, 1.0 / likelihoods[UPDATES]) * (likelihood - likelihoods[SLOW])
    likelihoods[FAST] += max(recovery.alpha_fast, 1.0 / likelihoods[UPDATES]) * (likelihood - likelihoods[FAST])


@borrowing
def injection_share(likelihoods: NDArray[np.float64], recovery: Recovery) -> float:
    """Return the share of particles to scatter: how much worse than usual the scans fit of late."""
    if recovery.alpha_slow == 0.0 or likelihoods[SLOW] == 0.0:
        return 0.0
    share: float = 1.0 - likelihoods[FAST] / likelihoods[SLOW]
    return max(0.0, share)


@borrowing
def resample_particles(
    cloud: ParticleCloud, occupied: Integer, injected: Injection, limits: ParticleLimits, draw: Draw
) -> None:
    """Replace the particles by as many as are needed, drawn by weight, a share of them anywhere on free space."""
    before = cloud.number[0]
    cumulative = cloud.scores
    accumulate_weights(cloud.weights, before, cumulative)
    keys, bins = cloud.clusters.keys, cloud.clusters.bins
    if limits.independently:
        count = draw_independently(
            BinnedParticles(keys, cumulative, before, bins), injected, limits, draw, cloud.chosen
        )
    else:
        count = particles_needed(BinnedParticles(keys, cumulative, before, bins), occupied, injected, limits, draw)
        resample_systematically(cumulative, before, resampling_offset(draw.key, draw.tick), cloud.chosen[:count])
    for i in range(count):
        if is_scattered(draw.key, draw.tick, i, injected.share):
            cloud.drawn[X, i], cloud.drawn[Y, i], cloud.drawn[THETA, i] = free_pose(
                injected.free, draw.key, draw.tick, i
            )
        else:
            source = cloud.chosen[i]
            for axis in range(3):
                cloud.drawn[axis, i] = cloud.poses[axis, source]
    for i in range(count):
        for axis in range(3):
            cloud.poses[axis, i] = cloud.drawn[axis, i]
        cloud.weights[i] = 1.0 / count
    cloud.number[0] = count
