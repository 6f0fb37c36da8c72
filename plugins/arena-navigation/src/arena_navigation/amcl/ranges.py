"""The beam model: how well measured ranges fit those that a particle would measure, cast in the map."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arena_kernels.compiled import borrowing
from arena_kernels.grids import GridStack
from arena_kernels.raycast import Beams, cast_grid
from arena_kernels.scalars import Integer
from arena_navigation.amcl.directions import PlacedParticles
from arena_navigation.columns import COSINE, SINE, THETA, X, Y


class Mixture(NamedTuple):
    """Weights of a hit, of something in front of it, of nothing hit and of what nothing explains;
    ``sigma_hit`` m, ``lambda_short`` 1/m.
    """

    z_hit: float
    z_short: float
    z_max: float
    z_rand: float
    sigma_hit: float
    lambda_short: float


class View(NamedTuple):
    """What particles look at: the first grid of ``stack``, in its own frame, by ``rays`` from a ``mount`` (x, y, theta)
    in ``base_link``.

    ``expected`` (B,) is scratch space.
    """

    stack: GridStack
    rays: Beams
    mount: tuple[float, float, float]
    mixture: Mixture
    expected: NDArray[np.float32]


@borrowing
def range_likelihood(measured: float, expected: float, range_max: float, mixture: Mixture) -> float:
    """Return how likely a range is where the map has ``expected``, m; ``range_max`` stands for nothing hit, in both.

    Thrun, Burgard, Fox, Probabilistic Robotics, table 6.1. As in ROS amcl the hit is 1 at its best, as in the
    likelihood field, and the exponential of what stands in front is not cut to its interval.
    """
    off = measured - expected
    likelihood = mixture.z_hit * math.exp(-0.5 * (off / mixture.sigma_hit) ** 2)
    if off < 0.0:
        likelihood += mixture.z_short * mixture.lambda_short * math.exp(-mixture.lambda_short * measured)
    return likelihood + (mixture.z_max if measured >= range_max else mixture.z_rand / range_max)


@borrowing
def match_ranges(
    particles: PlacedParticles, ranges: NDArray[np.float32], view: View, scores: NDArray[np.float64]
) -> Integer:
    """Write the sum of the cubes of the likelihoods of ``ranges`` (B,), for each particle in the
    grid's frame.

    Ranges that are no number are left out. Returns how many are not.
    """
    x, y, turn = view.mount
    used = np.int64(0)
    for j in range(len(ranges)):
        used += not math.isnan(ranges[j])
    for i in range(particles.number):
        c, s = particles.directions[COSINE, i], particles.directions[SINE, i]
        at_x, at_y = particles.poses[X, i] + c * x - s * y, particles.poses[Y, i] + s * x + c * y
        cast_grid(view.stack, 0, (at_x, at_y, particles.poses[THETA, i] + turn), view.rays, view.expected)
        total = 0.0
        for j in range(len(ranges)):
            if not math.isnan(ranges[j]):
                expected = min(float(view.expected[j]), view.rays.range_max)
                total += range_likelihood(float(ranges[j]), expected, view.rays.range_max, view.mixture) ** 3
        scores[i] = total
    return used
