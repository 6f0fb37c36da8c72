"""The filter's sensor model: how well a scan, seen from a particle, fits the map."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np
from arena_core import LaserScan, OccupancyGrid
from arena_kernels.compiled import compiled
from arena_kernels.distance import grid_distance
from numba import njit
from numpy.typing import NDArray

FloatTable = NDArray[np.float32]
LaserModelType = Literal["likelihood_field", "likelihood_field_prob"]


class Field(NamedTuple):
    """A padded table (H + 2, W + 2) of what a beam that ends in a cell adds to a particle's score; the rim stands for all outside.

    The scores of beams are added; ``product`` tells whether they are logarithms.
    """

    table: FloatTable
    cells_per_metre: float
    product: bool


class BeamSkipping(NamedTuple):
    """Which beams to leave out: those that at most a share ``threshold`` of the particles see end where the table has ``least`` or more.

    None is left out when the share of those left out would exceed ``error_threshold``: then the particles are wrong, not the beams.
    """

    on: bool
    threshold: float
    error_threshold: float
    least: float


@dataclass(frozen=True, slots=True)
class LikelihoodField:
    """Make the table of a grid, as Thrun, Burgard, Fox, Probabilistic Robotics, table 6.3; meant for ``grid.derive``.

    ``sigma_hit``, ``max_dist`` and ``max_range`` in m. ``likelihood_field_prob`` multiplies the likelihoods of the beams, as in the book;
    ``likelihood_field`` adds their cubes, which is ROS amcl's and much less sure of itself.
    """

    model: LaserModelType
    z_hit: float
    z_rand: float
    sigma_hit: float
    max_dist: float
    max_range: float

    def __call__(self, grid: OccupancyGrid) -> Field:
        """Return the field of ``grid``."""
        distance = np.minimum(grid.derive(grid_distance), np.float32(self.max_dist))
        table = self.value(np.pad(distance, 1, constant_values=self.max_dist))
        return Field(table, 1.0 / grid.resolution, self.model == "likelihood_field_prob")

    def value(self, distance: FloatTable) -> FloatTable:
        """Return what a beam adds that ends at a distance (m) from the nearest obstacle."""
        likelihood = self.z_hit * np.exp(-0.5 * np.square(distance / np.float32(self.sigma_hit))) + self.z_rand / self.max_range
        return (np.log(likelihood) if self.model == "likelihood_field_prob" else likelihood**3).astype(np.float32)


def beam_ends(scan: LaserScan, max_beams: int, min_range: float, max_range: float) -> FloatTable:
    """Return the ends of evenly spaced beams that hit something, (2, B) in ``base_link``, m; negative limits are the scan's own."""
    step = max((len(scan.ranges) - 1) // max(max_beams - 1, 1), 1)
    ranges = scan.ranges[::step].astype(np.float64)
    nearest = scan.range_min if min_range < 0.0 else min_range
    hits = np.flatnonzero((ranges >= nearest) & (ranges < farthest(scan, max_range)))
    angles = scan.mount.theta + scan.angle_min + scan.angle_increment * step * hits
    x = scan.mount.x + ranges[hits] * np.cos(angles)
    y = scan.mount.y + ranges[hits] * np.sin(angles)
    return np.stack((x, y)).astype(np.float32)


def farthest(scan: LaserScan, max_range: float) -> float:
    """Return the range from which a beam counts as having hit nothing, m."""
    return scan.range_max if max_range < 0.0 else min(max_range, scan.range_max)


@compiled
def believed(poses: NDArray[np.float64], directions: NDArray[np.float64], count: int, beams: FloatTable, field: Field, skipping: BeamSkipping) -> FloatTable:
    """Return the beams (2, K) that enough of the particles can explain by the map; the others hit people or what else is on no map.

    A hundred evenly spaced particles are asked, or all when there are fewer.
    """
    if not skipping.on:
        return beams
    step = max(count // 100, 1)
    kept = np.empty_like(beams)
    number = 0
    for j in range(beams.shape[1]):
        agreeing, asked = 0, 0
        for i in range(0, count, step):
            u = poses[0, i] + directions[0, i] * beams[0, j] - directions[1, i] * beams[1, j]
            v = poses[1, i] + directions[1, i] * beams[0, j] + directions[0, i] * beams[1, j]
            agreeing += field.table[_padded(v, field, 0), _padded(u, field, 1)] >= skipping.least
            asked += 1
        if agreeing > skipping.threshold * asked:
            kept[0, number], kept[1, number] = beams[0, j], beams[1, j]
            number += 1
    if number < (1.0 - skipping.error_threshold) * beams.shape[1]:
        return beams
    return np.ascontiguousarray(kept[:, :number])


@compiled
def _padded(metres: float, field: Field, axis: int) -> int:
    """Return the row or column of the padded table."""
    return np.int64(min(max(metres * field.cells_per_metre + 1.0, 0.0), field.table.shape[axis] - 1.0))


@njit(cache=True, error_model="numpy", fastmath=True)
def match(
    poses: NDArray[np.float64], directions: NDArray[np.float64], count: int, beams: FloatTable, field: Field, scores: NDArray[np.float64]
) -> None:
    """Write what the beams' ends (2, B) add up to on the field, for each of ``count`` particles (3, P) in the grid's frame.

    ``directions`` (2, P) are the cosine and sine of their headings.     Cells first, values second: the first loop is vectorised, which a loop that does both is not.
    """
    columns = field.table.shape[1]
    last_u, last_v = np.float32(columns - 1), np.float32(field.table.shape[0] - 1)
    zero, stride = np.float32(0.0), np.int32(columns)
    values = field.table.ravel()
    cells = np.empty(beams.shape[1], np.int32)
    beam_x, beam_y = beams[0], beams[1]
    for i in range(count):
        c = np.float32(directions[0, i] * field.cells_per_metre)
        s = np.float32(directions[1, i] * field.cells_per_metre)
        x = np.float32(poses[0, i] * field.cells_per_metre + 1.0)
        y = np.float32(poses[1, i] * field.cells_per_metre + 1.0)
        for j in range(len(cells)):
            u = min(max(x + c * beam_x[j] - s * beam_y[j], zero), last_u)
            v = min(max(y + s * beam_x[j] + c * beam_y[j], zero), last_v)
            cells[j] = np.int32(v) * stride + np.int32(u)
        total = zero
        for j in range(len(cells)):
            total += values[cells[j]]
        scores[i] = total


@compiled
def reweigh(weights: NDArray[np.float64], count: int, scores: NDArray[np.float64], beams: int, product: bool) -> float:
    """Multiply the weights by what the scores stand for, normalise them, and return how well a beam fits under the old weights.

    That mean is taken per beam, unlike in ROS: a scan of which fewer beams hit anything is no sign of being lost.
    """
    best = np.max(scores[:count]) if product else 0.0
    total, mean = 0.0, 0.0
    for i in range(count):
        mean += weights[i] * (np.exp(scores[i] / max(beams, 1)) if product else scores[i] / max(beams, 1))
        weights[i] *= np.exp(scores[i] - best) if product else 1.0 + scores[i]
        total += weights[i]
    for i in range(count):
        weights[i] /= total
    return mean
