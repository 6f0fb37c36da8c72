"""Static obstacles as walls of a map."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from arena_core.values.world import OCCUPIED, Obstacle, OccupancyGrid


def add_obstacles(grid: OccupancyGrid, obstacles: Sequence[Obstacle]) -> OccupancyGrid:
    """Return the grid with every cell occupied that an obstacle covers or its outline runs through; without
    obstacles the grid itself.
    """
    if not obstacles:
        return grid
    data = np.array(grid.data)
    for obstacle in obstacles:
        cells = np.concatenate(
            (_covered_cells(grid, obstacle), grid.cells(_outline_points(obstacle, 0.5 * grid.resolution)))
        )
        rows, columns = cells[grid.contains(cells)].T
        data[rows, columns] = OCCUPIED
    return OccupancyGrid(data, grid.resolution, grid.origin, grid.occupied_from)


def _covered_cells(grid: OccupancyGrid, obstacle: Obstacle) -> NDArray[np.int64]:
    """Return the cells (row, column) whose centres lie inside, among those of the obstacle's bounding box."""
    low, high = obstacle.vertices_xy.min(axis=0) - obstacle.radius, obstacle.vertices_xy.max(axis=0) + obstacle.radius
    corners = grid.cells([low, high, (low[0], high[1]), (high[0], low[1])])
    # what lies beyond has no cells
    first, last = np.clip((corners.min(axis=0), corners.max(axis=0) + 1), 0, grid.data.shape)
    cells = np.stack(
        np.meshgrid(*(np.arange(*ends) for ends in zip(first, last, strict=True)), indexing="ij"), axis=-1
    ).reshape(-1, 2)
    centres = grid.positions(cells)
    inside = _in_disc(centres, obstacle) if obstacle.radius > 0.0 else _in_polygon(centres, obstacle.vertices_xy)
    return cells[inside]


def _in_disc(points: NDArray[np.float64], disc: Obstacle) -> NDArray[np.bool_]:
    return np.hypot(*(points - disc.vertices_xy[0]).T) <= disc.radius  # type: ignore[no-any-return]


def _in_polygon(points: NDArray[np.float64], vertices: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Count how often a ray to the right crosses the outline."""
    x, y = points[:, :1], points[:, 1:]
    (x0, y0), (x1, y1) = vertices.T, np.roll(vertices, -1, axis=0).T
    straddles = (y0 > y) != (y1 > y)
    crossing = x0 + (y - y0) * (x1 - x0) / np.where(y1 == y0, 1.0, y1 - y0)
    return (straddles & (x < crossing)).sum(axis=1) % 2 == 1  # type: ignore[no-any-return]


def _outline_points(obstacle: Obstacle, spacing: float) -> NDArray[np.float64]:
    """Return points on a polygon's outline, no farther apart than ``spacing``, or a disc's centre: so no
    obstacle is lost between cells.
    """
    if obstacle.radius > 0.0:
        return obstacle.vertices_xy
    starts, ends = obstacle.vertices_xy, np.roll(obstacle.vertices_xy, -1, axis=0)
    steps = int(np.ceil(np.hypot(*(ends - starts).T).max() / spacing)) + 1
    share = np.linspace(0.0, 1.0, steps)[:, None, None]
    return (starts + share * (ends - starts)).reshape(-1, 2)
