"""Costs around obstacles, as costmap_2d's inflation layer gives them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from arena_core import INSCRIBED, LETHAL, UNKNOWN, ConfigurationError, OccupancyGrid
from arena_kernels.compiled import compiled
from arena_kernels.distance import grid_distance

NO_INFORMATION = 255
_ROUNDING = 1e-9  # m: six cells of 0.1 m are within 0.6 m


@dataclass(frozen=True, slots=True)
class Inflation:
    """How cost falls with the distance d to the nearest obstacle; radii in m, scaling in 1/m.

    254 at d = 0, 253 up to the inscribed radius, then 252 exp(-scaling (d - inscribed radius)), 0 beyond the inflation
    radius (ros-planning/navigation, costmap_2d, InflationLayer::computeCost). With an inflation radius of 0 only the
    obstacles cost.
    """

    inscribed_radius: float
    inflation_radius: float
    cost_scaling_factor: float

    def __post_init__(self) -> None:
        if 0.0 < self.inflation_radius < self.inscribed_radius:
            raise ConfigurationError(
                f"inflation_radius is {self.inflation_radius}; "
                f"allowed: 0 or at least the robot's inscribed radius {self.inscribed_radius:.3f} (m)"
            )

    def costs_at(self, distances: NDArray[np.float64]) -> NDArray[np.uint8]:
        """Return the cost at distances (m) of any shape."""
        decayed = (INSCRIBED - 1) * np.exp(
            -self.cost_scaling_factor * np.maximum(distances - self.inscribed_radius, 0.0)
        )
        costs = np.where(distances <= self.inscribed_radius + _ROUNDING, INSCRIBED, np.floor(decayed))
        costs = np.where(distances > self.inflation_radius + _ROUNDING, 0, costs)
        return np.where(distances == 0.0, LETHAL, costs).astype(np.uint8)

    def table(self, resolution: float) -> NDArray[np.uint8]:
        """Return the cost by squared distance in cells; its last entry, 0, stands for all that is farther."""
        reach = int((self.inflation_radius / resolution) ** 2 * (1.0 + 1e-9))
        costs = self.costs_at(np.sqrt(np.arange(reach + 2)) * resolution)
        costs[-1] = 0
        return costs


@dataclass(frozen=True, slots=True)
class InflatedCosts:
    """The costs of a whole grid, for ``grid.derive``; unknown cells are NO_INFORMATION unless ``allow_unknown``."""

    inflation: Inflation
    allow_unknown: bool

    def __call__(self, grid: OccupancyGrid) -> NDArray[np.uint8]:
        """Return the cost of every cell, shape (H, W), read-only."""
        costs = inflate_costs(grid.derive(grid_distance), grid.resolution, self.inflation.table(grid.resolution))
        if not self.allow_unknown:
            costs[grid.data == UNKNOWN] = NO_INFORMATION
        costs.flags.writeable = False
        return costs


@compiled
def inflate_costs(distance: NDArray[np.float32], resolution: float, table: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Look up the cost of each distance (H, W), m, in the table of ``Inflation.table``."""
    rows, columns = distance.shape
    costs = np.empty((rows, columns), np.uint8)
    per_cell = np.float32(1.0 / resolution)
    farthest = np.float32(table.size - 1)
    for row in range(rows):
        for column in range(columns):
            cells = distance[row, column] * per_cell
            # distances are roots of whole numbers: rounding is exact
            squared = min(cells * cells + np.float32(0.5), farthest)
            costs[row, column] = table[np.int32(squared)]
    return costs
