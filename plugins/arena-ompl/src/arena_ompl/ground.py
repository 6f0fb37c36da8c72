"""Where the robot's body may be: a distance field and the discs that cover the body.

All is in the grid's own frame, in m from its lower left corner. A disc is free where the distance to the nearest
occupied cell exceeds its radius both in its centre's cell, which is what a costmap's inscribed cells say, and
interpolated between cells.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from arena_core import UNKNOWN, OccupancyGrid, Robot
from arena_kernels.compiled import borrowing, compiled, inlined
from arena_kernels.distance import distance_field, grid_distance

Field = NDArray[np.float32]
Discs = NDArray[np.float64]

ROUNDING = 1e-6  # m: four cells of 0.05 m are no more than 0.2 m, also in float32
_OUTSIDE = -1e3  # m: the clearance outside the grid


@dataclass(frozen=True, slots=True)
class ObstacleField:
    """The field of a grid, for ``grid.derive``: unknown cells count, unless ``allow_unknown``, for a disc's centre
    alone.

    ``radius`` is that of the discs, m.
    """

    radius: float
    allow_unknown: bool

    def __call__(self, grid: OccupancyGrid) -> Field:
        """Return the distance to the nearest obstacle, m, shape (H, W), read-only and finite."""
        field = grid.derive(grid_distance)
        unknown = grid.data == UNKNOWN
        if not self.allow_unknown and unknown.any():
            field = np.minimum(
                field, distance_field(unknown, grid.resolution) + np.float32(self.radius - 0.5 * grid.resolution)
            )
        field = np.minimum(field, np.float32(grid.resolution * sum(field.shape)))
        field.flags.writeable = False
        return field


@dataclass(frozen=True, slots=True)
class CostField:
    """What a metre costs in each cell of a grid, for ``grid.derive``.

    1 + ``weight`` exp(-``scaling`` times a disc's clearance) where that clearance is below ``influence`` (m), else 1.
    """

    obstacles: ObstacleField
    weight: float
    scaling: float
    influence: float

    def __call__(self, grid: OccupancyGrid) -> Field:
        """Return the price, shape (H, W), read-only."""
        clear = np.maximum(grid.derive(self.obstacles) - np.float32(self.obstacles.radius), 0.0)
        prices = np.where(clear < self.influence, 1.0 + self.weight * np.exp(-self.scaling * clear), 1.0).astype(
            np.float32
        )
        prices.flags.writeable = False
        return prices


def body_discs(robot: Robot, count: int) -> Discs:
    """Return the discs (K, 3) of x, y and radius, m, that must be free: the inscribed one, ``count`` that hold a car's
    polygon.

    Only a car has its heading planned; all others can turn where they stand, and are asked for what they need at any
    heading.
    """
    footprint = robot.footprint
    if robot.kinematics != "ackermann" or footprint.is_circle:
        return np.array(((0.0, 0.0, footprint.inscribed_radius + ROUNDING),))
    low, high = footprint.vertices_xy.min(axis=0), footprint.vertices_xy.max(axis=0)
    half = 0.5 * (high - low) / (count, 1.0)
    centres = low[0] + half[0] * (2.0 * np.arange(count) + 1.0)
    return np.column_stack((centres, np.full(count, 0.5 * (low[1] + high[1])), np.full(count, np.hypot(*half))))


@inlined
def interpolate_field(field: Field, resolution: float, x: float, y: float) -> float:
    """Return a field at a position, that of the nearest one inside if it lies outside the grid."""
    rows, columns = field.shape
    u, v = min(max(x / resolution - 0.5, 0.0), columns - 1.0), min(max(y / resolution - 0.5, 0.0), rows - 1.0)
    column, row = int(u), int(v)
    right, above = min(column + 1, columns - 1), min(row + 1, rows - 1)
    u, v = u - column, v - row
    low = field[row, column] * (1.0 - u) + field[row, right] * u
    high = field[above, column] * (1.0 - u) + field[above, right] * u
    return low * (1.0 - v) + high * v  # type: ignore[no-any-return]


@inlined
def _clearance_of_disc(field: Field, resolution: float, x: float, y: float, radius: float) -> float:
    if not (0.0 <= x < resolution * field.shape[1] and 0.0 <= y < resolution * field.shape[0]):
        return _OUTSIDE
    of_cell = field[int(y / resolution), int(x / resolution)]
    return min(interpolate_field(field, resolution, x, y), of_cell) - radius  # type: ignore[no-any-return]


@borrowing
def body_clearance(field: Field, discs: Discs, resolution: float, pose: tuple[float, float, float]) -> float:
    """Return how far the body at a pose is from the nearest obstacle, m; not positive if it is too near."""
    x, y, theta = pose
    if len(discs) == 1 and discs[0, 0] == 0.0 and discs[0, 1] == 0.0:
        return _clearance_of_disc(field, resolution, x, y, discs[0, 2])
    c, s = math.cos(theta), math.sin(theta)
    least = math.inf
    for i in range(len(discs)):
        px, py = x + c * discs[i, 0] - s * discs[i, 1], y + s * discs[i, 0] + c * discs[i, 1]
        least = min(least, _clearance_of_disc(field, resolution, px, py, discs[i, 2]))
    return least


@compiled
def reachable_cells(
    field: Field, occupied: NDArray[np.bool_], resolution: float, radius: float, reach: float, row: int, column: int
) -> NDArray[np.bool_]:
    """Return the cells (H, W) that a disc of ``radius`` m can get to from a cell, whatever the way.

    Within ``reach`` m of that cell every cell that is not occupied may be crossed.
    """
    rows, columns = field.shape
    reached = np.zeros((rows, columns), np.bool_)
    queue = np.empty((rows * columns, 2), np.int32)
    queue[0, 0], queue[0, 1] = row, column
    reached[row, column] = True
    first, last = 0, 1
    while first < last:
        r, c = queue[first]
        first += 1
        for i in range(max(r - 1, 0), min(r + 2, rows)):
            for j in range(max(c - 1, 0), min(c + 2, columns)):
                if reached[i, j]:
                    continue
                near = math.hypot(i - row, j - column) * resolution <= reach and not occupied[i, j]
                if near or field[i, j] > radius:
                    reached[i, j] = True
                    queue[last, 0], queue[last, 1] = i, j
                    last += 1
    return reached
