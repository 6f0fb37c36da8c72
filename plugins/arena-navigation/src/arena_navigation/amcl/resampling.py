"""How many particles to keep (Fox 2003), which ones (systematic resampling), and when to scatter some over the map."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arena_kernels.compiled import borrowing
from arena_kernels.random import uniform
from arena_kernels.scalars import Integer
from arena_navigation.amcl.draws import Draw
from arena_navigation.amcl.histogram import Histogram, add_bin, bin_key, clear_bins

GOLDEN_RATIO = 0.6180339887498949
# First random index of each use within one filter update; numpy's integers, because each literal would be a type of its
# own to compile for.
_SYSTEMATIC, _FIRST_POINT, _SCATTER, _DRAWS = np.int64(0), np.int64(1), np.int64(2), np.int64(1 << 40)


class ParticleLimits(NamedTuple):
    """How many particles are allowed, and what the sample may miss of the distribution: ``kld_err``, with quantile
    ``kld_z``.

    Where they are drawn ``independently`` of one another, a single bin asks for the most, as in ROS amcl; else for the
    fewest.
    """

    min_particles: int
    max_particles: int
    kld_err: float
    kld_z: float
    independently: bool


class FreeSpace(NamedTuple):
    """The cells where a lost robot may be, as flat indices into rows of ``columns`` cells of ``resolution`` m."""

    cells: NDArray[np.int64]
    columns: int
    resolution: float


@borrowing
def kld_bound(bins: Integer, limits: ParticleLimits) -> Integer:
    """Return the number of particles for a distribution over ``bins`` bins, within the limits.

    Fox, Adapting the Sample Size in Particle Filters Through KLD-Sampling, IJRR 22, 2003, equation 7 (Wilson and
    Hilferty's approximation of the chi-square quantile).
    """
    if bins <= 1:
        return limits.max_particles if limits.independently else limits.min_particles
    degrees = bins - 1.0
    share = 2.0 / (9.0 * degrees)
    wanted = np.ceil(degrees / (2.0 * limits.kld_err) * (1.0 - share + np.sqrt(share) * limits.kld_z) ** 3)
    return np.int64(min(max(wanted, float(limits.min_particles)), float(limits.max_particles)))


@borrowing
def accumulate_weights(weights: NDArray[np.float64], count: Integer, cumulative: NDArray[np.float64]) -> None:
    """Write the running sum of normalised weights, the last one exactly 1."""
    total = 0.0
    for i in range(count):
        total += weights[i]
        cumulative[i] = total
    cumulative[count - 1] = 1.0


@borrowing
def resample_systematically(
    cumulative: NDArray[np.float64], count: Integer, offset: float, chosen: NDArray[np.int32]
) -> None:
    """Choose ``len(chosen)`` of ``number`` particles at the points (k + offset) / len(chosen), one uniform number in
    all.

    Kitagawa, Monte Carlo Filter and Smoother, Journal of Computational and Graphical Statistics 5, 1996.
    """
    i = 0
    for k in range(len(chosen)):
        point = (k + offset) / len(chosen)
        while point >= cumulative[i] and i < count - 1:
            i += 1
        chosen[k] = i


class BinnedParticles(NamedTuple):
    """The bin of each of ``number`` particles, the running sum of their weights, and an empty histogram."""

    keys: NDArray[np.int64]
    cumulative: NDArray[np.float64]
    number: Integer
    bins: Histogram


class Injection(NamedTuple):
    """The share of the particles that is placed at random, and the free space it is placed on."""

    share: float
    free: FreeSpace


@borrowing
def particles_needed(
    binned: BinnedParticles, occupied: Integer, injected: Injection, limits: ParticleLimits, draw: Draw
) -> Integer:
    """Return how many particles the distribution needs: draw until the bins they fall into ask for no
    more.

    ``occupied`` bins hold particles now; where even all of them ask for no more than the minimum, nothing need be
    drawn. The points drawn at are multiples of the golden ratio modulo 1: unlike systematic ones they are evenly spread
    wherever one stops.
    """
    if injected.share == 0.0 and kld_bound(occupied, limits) == limits.min_particles:
        return limits.min_particles
    first = uniform(draw.key, draw.tick, _FIRST_POINT)
    filled, drawn = np.int64(0), np.int64(0)
    enough: Integer = limits.min_particles
    while drawn < enough:
        if is_scattered(draw.key, draw.tick, drawn, injected.share):
            x, y, theta = free_pose(injected.free, draw.key, draw.tick, drawn)
            found = bin_key(x, y, theta)
        else:
            point = first + drawn * GOLDEN_RATIO
            found = binned.keys[_particle_at(binned.cumulative, binned.number, point - np.floor(point))]
        drawn += 1
        if add_bin(binned.bins, found, filled) == filled:
            filled += 1
            enough = kld_bound(filled, limits)
    clear_bins(binned.bins, filled)
    return drawn


@borrowing
def draw_independently(
    binned: BinnedParticles, injected: Injection, limits: ParticleLimits, draw: Draw, chosen: NDArray[np.int32]
) -> Integer:
    """Choose particles by one random number each until there are more than their bins ask for; return how
    many.

    This is how ROS amcl draws; it adds noise that systematic resampling does not.
    """
    filled, drawn = np.int64(0), np.int64(0)
    enough: Integer = limits.max_particles
    while drawn <= enough and drawn < limits.max_particles:
        chosen[drawn] = _particle_at(binned.cumulative, binned.number, uniform(draw.key, draw.tick, _DRAWS + drawn))
        found = binned.keys[chosen[drawn]]
        if is_scattered(draw.key, draw.tick, drawn, injected.share):
            x, y, theta = free_pose(injected.free, draw.key, draw.tick, drawn)
            found = bin_key(x, y, theta)
        drawn += 1
        if add_bin(binned.bins, found, filled) == filled:
            filled += 1
            enough = kld_bound(filled, limits)
    clear_bins(binned.bins, filled)
    return drawn


@borrowing
def _particle_at(cumulative: NDArray[np.float64], count: Integer, point: float) -> Integer:
    """Return which particle's share of the running sum holds ``point``."""
    low, high = 0, count - 1
    while low < high:
        middle = (low + high) // 2
        if cumulative[middle] > point:
            high = middle
        else:
            low = middle + 1
    return low


@borrowing
def is_scattered(key: np.uint64, tick: Integer, i: Integer, injection: float) -> bool:
    """Return whether particle ``i`` is one of the share ``injection`` that is placed at random."""
    return bool(injection > 0.0 and uniform(key, tick, _SCATTER + 5 * i) < injection)


@borrowing
def free_pose(free: FreeSpace, key: np.uint64, tick: Integer, i: Integer) -> tuple[float, float, float]:
    """Return the random pose on free space of particle ``i``, in the grid's frame."""
    index = _SCATTER + 5 * i + 1
    cell = free.cells[np.int64(uniform(key, tick, index) * len(free.cells))]
    x = (cell % free.columns + uniform(key, tick, index + 1)) * free.resolution
    y = (cell // free.columns + uniform(key, tick, index + 2)) * free.resolution
    return x, y, (2.0 * uniform(key, tick, index + 3) - 1.0) * np.pi


@borrowing
def resampling_offset(key: np.uint64, tick: Integer) -> float:
    """Return this filter update's random number for ``resample_systematically``."""
    return uniform(key, tick, _SYSTEMATIC)
