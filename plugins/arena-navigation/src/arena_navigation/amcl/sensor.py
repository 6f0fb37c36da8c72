"""The filter's sensor model: how well a scan, seen from a particle, fits the map."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arena_core import OccupancyGrid
from arena_kernels.compiled import borrowing, inlined
from arena_kernels.distance import distance_field, grid_distance
from arena_kernels.scalars import Integer
from arena_navigation.amcl.directions import PlacedParticles
from arena_navigation.columns import COSINE, SINE, X, Y

FloatTable = NDArray[np.float32]


class Distances(NamedTuple):
    """What a beam's end is near to: the ``surface`` of obstacles, or the centre of the nearest occupied cell (ROS
    amcl).

    To centres, ``hollow`` takes only those cells for occupied that a scan can have seen, as in a map that was made by
    scans; without, all of an obstacle's inside fits a beam equally well, and estimates are drawn into racks and walls.
    """

    surface: bool
    hollow: bool


class LikelihoodTable(NamedTuple):
    """What a beam that ends in a cell adds to a particle's score: a padded table, flat, of ``rows`` by ``columns``.

    Its rim stands for all outside. The scores of beams are added; ``product`` says whether they are logarithms.
    """

    values: FloatTable
    rows: int
    columns: int
    cells_per_metre: float
    product: bool


@dataclass(frozen=True, slots=True)
class LikelihoodField:
    """Make the table of a grid, as Thrun, Burgard, Fox, Probabilistic Robotics, table 6.3; meant for ``grid.derive``.

    ``sigma_hit``, ``max_dist`` and ``max_range`` in m. A ``product`` multiplies the likelihoods of the beams, as in the
    book, each to the power ``beam_weight``; else their cubes are added, which is ROS amcl's ``likelihood_field`` and
    much less sure of itself.
    """

    product: bool
    z_hit: float
    z_rand: float
    sigma_hit: float
    max_dist: float
    distances: Distances
    beam_weight: float
    max_range: float

    def __call__(self, grid: OccupancyGrid) -> LikelihoodTable:
        """Return the field of ``grid``."""
        distance = np.pad(
            np.minimum(distances_to(grid, self.distances), self.max_dist), 1, constant_values=self.max_dist
        )
        likelihood = self.z_hit * np.exp(-0.5 * np.square(distance / self.sigma_hit)) + self.z_rand / self.max_range
        table = self.beam_weight * np.log(likelihood) if self.product else likelihood**3
        rows, columns = table.shape
        return LikelihoodTable(table.astype(np.float32).ravel(), rows, columns, 1.0 / grid.resolution, self.product)


def distances_to(grid: OccupancyGrid, distances: Distances) -> FloatTable:
    """Return the distance of each cell's centre to the nearest obstacle, (H, W), m."""
    seen = shell_distance if distances.hollow else grid_distance
    distance: FloatTable = grid.derive(surface_distance if distances.surface else seen)
    return distance


def shell_distance(grid: OccupancyGrid) -> FloatTable:
    """Return the distance of each cell's centre to that of the nearest occupied cell
    with a side to the open, (H, W), m.
    """
    filled = np.pad(grid.occupied, 1, constant_values=True)
    enclosed = filled[:-2, 1:-1] & filled[2:, 1:-1] & filled[1:-1, :-2] & filled[1:-1, 2:]
    return distance_field(grid.occupied & ~enclosed, grid.resolution)


def surface_distance(grid: OccupancyGrid) -> FloatTable:
    """Return the distance of each cell's centre to the nearest obstacle's surface, negative
    inside, (H, W), m; for ``grid.derive``.
    """
    inside = distance_field(~grid.occupied, grid.resolution)
    signed: FloatTable = np.where(grid.occupied, grid.resolution - inside, grid.derive(grid_distance)) - np.float32(
        0.5 * grid.resolution
    )
    return signed


class BeamCount(NamedTuple):
    """How many beams made the scores, and whether a score is the logarithm of their product, not a sum."""

    beams: Integer
    product: bool


class EndpointLookup(NamedTuple):
    """Where beams end in the sensor's frame (2, B), the field they are looked up in, and room for one cell a beam."""

    beams: NDArray[np.float32]
    field: LikelihoodTable
    cells: NDArray[np.int32]


@inlined
def write_cells(
    poses: NDArray[np.float64], directions: NDArray[np.float64], i: Integer, lookup: EndpointLookup, number: Integer
) -> None:
    """Write in which cells of the field the first ``number`` beams end, seen from particle ``i``."""
    last_u, last_v = np.float32(lookup.field.columns - 1), np.float32(lookup.field.rows - 1)
    zero, stride = np.float32(0.0), np.int32(lookup.field.columns)
    beam_x, beam_y = lookup.beams[X], lookup.beams[Y]
    c = np.float32(directions[COSINE, i] * lookup.field.cells_per_metre)
    s = np.float32(directions[SINE, i] * lookup.field.cells_per_metre)
    x = np.float32(poses[X, i] * lookup.field.cells_per_metre + 1.0)
    y = np.float32(poses[Y, i] * lookup.field.cells_per_metre + 1.0)
    for j in range(number):
        u = min(max(x + c * beam_x[j] - s * beam_y[j], zero), last_u)
        v = min(max(y + s * beam_x[j] + c * beam_y[j], zero), last_v)
        lookup.cells[j] = np.int32(v) * stride + np.int32(u)


@borrowing
def match_endpoints(
    particles: PlacedParticles, lookup: EndpointLookup, number: Integer, scores: NDArray[np.float64]
) -> None:
    """Write what the ends (2, B) of the first ``number`` beams add up to on the field, for each particle in the
    grid's frame.

    Cells first, values second: the first loop is vectorised, which a loop that does both is not. The sum has four
    parts, which need not wait for one another.
    """
    zero = np.float32(0.0)
    fours = number - number % 4
    for i in range(particles.number):
        write_cells(particles.poses, particles.directions, i, lookup, number)
        total0, total1, total2, total3 = zero, zero, zero, zero
        for j in range(0, fours, 4):
            total0 += lookup.field.values[lookup.cells[j]]
            total1 += lookup.field.values[lookup.cells[j + 1]]
            total2 += lookup.field.values[lookup.cells[j + 2]]
            total3 += lookup.field.values[lookup.cells[j + 3]]
        for j in range(fours, number):
            total0 += lookup.field.values[lookup.cells[j]]
        scores[i] = (total0 + total1) + (total2 + total3)


@borrowing
def update_weights(weights: NDArray[np.float64], count: Integer, scores: NDArray[np.float64], fit: BeamCount) -> float:
    """Multiply the weights by what the scores stand for, normalise them, and return how well a beam fits under the old
    weights.

    That mean is taken per beam, unlike in ROS: a scan of which fewer beams hit anything is no sign of being lost.
    """
    best = 0.0
    if fit.product:
        best = scores[0]
        for i in range(1, count):
            best = max(best, scores[i])
    total, mean, share = 0.0, 0.0, 1.0 / max(fit.beams, 1)
    for i in range(count):
        mean += weights[i] * (np.exp(scores[i] * share) if fit.product else scores[i] * share)
        weights[i] *= np.exp(scores[i] - best) if fit.product else 1.0 + scores[i]
        total += weights[i]
    for i in range(count):
        weights[i] /= total
    return mean
