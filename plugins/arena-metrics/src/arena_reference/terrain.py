"""The ground of a world on a fine grid: how far each cell's centre is from walls, obstacles and furniture."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from arena_core import Obstacle, OccupancyGrid, Scenario
from arena_core.scenes import furniture_outlines
from arena_kernels.compiled import compiled
from arena_kernels.distance import distance_field
from arena_reference.arrays import Field, Floats

EDGE = 16  # cells of free ground about the map: a robot may drive out of it
REACH = 1.0  # m, within which the distance to an obstacle is exact


class Terrain(NamedTuple):
    """Distances (H, W) m from the centres of square cells, of side ``cell`` m, to the nearest thing that stands.

    (``x``, ``y``) is the corner of cell (0, 0) in ``map``, ``cosine`` and ``sine`` turn the grid's axes to it. A
    distance is exact to within ``error`` m.
    """

    distance: Field
    cell: float
    x: float
    y: float
    cosine: float
    sine: float
    error: float

    def cells_of(self, x: float, y: float) -> tuple[float, float]:
        """Return a position in ``map`` in cells, as (column, row), not rounded."""
        dx, dy = (x - self.x) / self.cell, (y - self.y) / self.cell
        return self.cosine * dx + self.sine * dy, self.cosine * dy - self.sine * dx


def terrain_of(scenario: Scenario, cell: float, robot_height: float) -> Terrain:
    """Return the ground of a scenario for a robot of this height, on cells about as large as ``cell``, m."""
    grid = scenario.world.grid
    parts = max(1, round(grid.resolution / cell))
    distance, side, error = _grid_distances(grid, parts, max(1, round(cell * parts / grid.resolution)))
    c, s = math.cos(grid.origin.theta), math.sin(grid.origin.theta)
    x, y = grid.origin.x - EDGE * side * (c - s), grid.origin.y - EDGE * side * (s + c)
    ground = Terrain(distance, side, x, y, c, s, error)
    for obstacle in (*scenario.obstacles, *furniture_outlines(scenario.world.furniture, 0.0, robot_height)):
        _add_obstacle(ground, obstacle)
    return ground


def _grid_distances(grid: OccupancyGrid, parts: int, pooled: int) -> tuple[Field, float, float]:
    """Return the distances to a grid's occupied cells, the side of their cells and how exact they are, m.

    Each of the grid's cells is divided into ``parts`` squared; ``pooled`` squared of them become one. A cell that holds
    a wall is at distance 0.
    """
    occupied = np.repeat(np.repeat(grid.occupied, parts, axis=0), parts, axis=1)
    fine = grid.resolution / parts
    edge = EDGE * pooled
    padded = np.pad(occupied, ((edge, edge + -occupied.shape[0] % pooled), (edge, edge + -occupied.shape[1] % pooled)))
    exact = distance_field(padded, fine)
    nearest, farthest = 0.5 * fine, math.sqrt(0.5) * fine  # from the centre of an occupied cell to its rim
    exact -= np.float32(0.5 * (nearest + farthest))
    np.maximum(exact, np.float32(0.0), out=exact)
    error = 0.5 * (farthest - nearest)
    if pooled > 1:
        middle, off = pooled // 2, (pooled % 2 == 0) * math.sqrt(0.5) * fine
        exact, error = exact[middle::pooled, middle::pooled], error + off
    return np.ascontiguousarray(exact), fine * pooled, error


def _add_obstacle(ground: Terrain, obstacle: Obstacle) -> None:
    columns_rows = np.array([ground.cells_of(x, y) for x, y in np.asarray(obstacle.vertices_xy, np.float64).tolist()])
    add_obstacle(ground.distance, columns_rows, float(obstacle.radius) / ground.cell, ground.cell, REACH / ground.cell)


@compiled
def add_obstacle(distance: Field, vertices: Floats, radius: float, cell: float, reach: float) -> None:
    """Lower distances (H, W) to a disc about the one vertex, or to a polygon; vertices (V, 2), radius and reach in
    cells.
    """
    rows, columns = distance.shape
    first, last = np.empty(2, np.int64), np.empty(2, np.int64)
    for axis in range(2):
        most = columns if axis == 0 else rows
        first[axis] = max(0, math.floor(vertices[:, axis].min() - radius - reach))
        last[axis] = min(most, math.ceil(vertices[:, axis].max() + radius + reach))
    for row in range(first[1], last[1]):
        for column in range(first[0], last[0]):
            away = _distance_to(vertices, column + 0.5, row + 0.5) - radius
            distance[row, column] = min(distance[row, column], np.float32(max(away, 0.0) * cell))


@compiled
def _distance_to(vertices: Floats, x: float, y: float) -> float:
    """Return how far a point is from a polygon, 0 inside, or from its one vertex."""
    nearest, inside, before = np.inf, False, len(vertices) - 1
    for i in range(len(vertices)):
        ax, ay, bx, by = vertices[before, 0], vertices[before, 1], vertices[i, 0], vertices[i, 1]
        dx, dy = bx - ax, by - ay
        along = ((x - ax) * dx + (y - ay) * dy) / max(dx * dx + dy * dy, 1e-12)
        along = min(max(along, 0.0), 1.0)
        nearest = min(nearest, (x - ax - along * dx) ** 2 + (y - ay - along * dy) ** 2)
        if (ay > y) != (by > y) and x < ax + (y - ay) * dx / dy:
            inside = not inside
        before = i
    return 0.0 if inside else math.sqrt(nearest)
