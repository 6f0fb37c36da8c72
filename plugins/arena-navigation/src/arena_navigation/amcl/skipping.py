"""Beam skipping: a beam that few particles can explain has hit what is on no map, and is left out for all
of them (as in ROS amcl).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arena_core import OccupancyGrid
from arena_kernels.compiled import borrowing
from arena_kernels.scalars import Integer
from arena_navigation.amcl.directions import PlacedParticles
from arena_navigation.amcl.sensor import Distances, EndpointLookup, distances_to, write_cells
from arena_navigation.columns import X, Y

CONVERGED = 0.5  # m; particles that are all so near to their mean, along either axis, agree on one place (ROS amcl)


class Skipping(NamedTuple):
    """When a beam is skipped: ``near`` says for each cell of a field, flat, whether a beam that ends there fits the
    map.

    A beam is skipped that fits for no more than ``threshold`` of the particles; none is where that would be
    ``error_threshold`` of all beams or more, for then the particles are wrong and not the map. Nothing is skipped where
    ``near`` is empty.
    """

    near: NDArray[np.uint8]
    threshold: float
    error_threshold: float


@dataclass(frozen=True, slots=True)
class NearMap:
    """Tell which cells lie less than ``distance`` m from an obstacle, in the layout of ``LikelihoodField``;
    meant for ``grid.derive``.
    """

    distance: float
    distances: Distances

    def __call__(self, grid: OccupancyGrid) -> NDArray[np.uint8]:
        """Return 1 or 0 for each cell of ``grid`` and of its rim, flat."""
        away = np.pad(np.abs(distances_to(grid, self.distances)), 1, constant_values=np.inf)
        return (away < self.distance).astype(np.uint8).ravel()


@borrowing
def skip_beams(
    particles: PlacedParticles, lookup: EndpointLookup, skipping: Skipping, fitting: NDArray[np.int32]
) -> Integer:
    """Move the ends (2, B) of the beams that are kept to the front, in their order, and return how many there are.

    Particles that are scattered keep all. ``fitting`` is scratch space of B.
    """
    number: Integer = lookup.beams.shape[1]
    if len(skipping.near) == 0 or not has_converged(particles.poses, particles.number):
        return number
    _count_fitting(particles, lookup, skipping.near, fitting)
    kept: Integer = np.int64(0)
    for j in range(number):
        kept += fitting[j] > skipping.threshold * particles.number
    if number - kept >= skipping.error_threshold * number:
        return number
    kept = np.int64(0)
    for j in range(number):
        if fitting[j] > skipping.threshold * particles.number:
            lookup.beams[0, kept], lookup.beams[1, kept] = lookup.beams[0, j], lookup.beams[1, j]
            kept += 1
    return kept


@borrowing
def has_converged(poses: NDArray[np.float64], count: Integer) -> bool:
    """Return whether all of ``count`` particles (3, P) are within ``CONVERGED`` of their mean, along either axis."""
    x, y = 0.0, 0.0
    for i in range(count):
        x += poses[X, i] / count
        y += poses[Y, i] / count
    farthest = 0.0
    for i in range(count):
        farthest = max(farthest, abs(poses[X, i] - x), abs(poses[Y, i] - y))
    return farthest <= CONVERGED


@borrowing
def _count_fitting(
    particles: PlacedParticles, lookup: EndpointLookup, near: NDArray[np.uint8], fitting: NDArray[np.int32]
) -> None:
    """Write for how many particles each beam ends near an obstacle."""
    number = lookup.beams.shape[1]
    for j in range(number):
        fitting[j] = 0
    for i in range(particles.number):
        write_cells(particles.poses, particles.directions, i, lookup, number)
        for j in range(number):
            fitting[j] += near[lookup.cells[j]]
