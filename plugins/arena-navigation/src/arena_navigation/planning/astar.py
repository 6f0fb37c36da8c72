"""The global planner A* on the inflated map."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from arena_core import INSCRIBED, LETHAL, GlobalPlanner, NoPath, OccupancyGrid, Path, Pose, Robot
from arena_core.parameters import NonNegative, NonNegativeInt, Positive
from arena_navigation.planning.escape import escape_paths, free_cells_near
from arena_navigation.planning.inflation import InflatedCosts, Inflation
from arena_navigation.planning.search import Cell, CostToGo, MoveCosts
from arena_navigation.planning.smoothing import leads_through, path_cost, refine_path

Costs = NDArray[np.uint8]
Cells = NDArray[np.int64]
Floats = NDArray[np.float64]


class AstarPlanner(GlobalPlanner):
    """Finds the cheapest 8-connected way through the inflated map, then straightens
    and smooths it (docs/navigation.md).
    """

    def __init__(
        self,
        robot: Robot,
        inflation_radius: NonNegative,
        cost_scaling_factor: NonNegative,
        neutral_cost: Positive,
        cost_factor: NonNegative,
        tolerance: NonNegative,
        spacing: Positive,
        smoothing_rounds: NonNegativeInt,
        padding: NonNegative | None,
        narrow_cost: NonNegative,
        *,
        allow_unknown: bool,
    ) -> None:
        radius = robot.footprint.inscribed_radius
        self._inflated = InflatedCosts(Inflation(radius, inflation_radius, cost_scaling_factor), allow_unknown)
        self._plain = MoveCosts(neutral_cost, cost_factor)
        self._padding, self._narrow_cost = padding or 0.0, narrow_cost
        self._tolerance = tolerance
        self._spacing = spacing
        self._smoothing_rounds = smoothing_rounds
        self._last: tuple[Costs, CostToGo] | None = None

    def plan(self, grid: OccupancyGrid, start: Pose, goal: Pose) -> Path:
        """Return the path, with ``padding`` where there is one; raise NoPath if start or goal is
        blocked or no way joins them.
        """
        costs, moves = grid.derive(self._inflated), self._move_costs(grid.resolution)
        start_cell, goal_cell = _cell_of(grid, start, "start"), _cell_of(grid, goal, "goal")
        if costs[start_cell] >= LETHAL:
            raise NoPath(
                f"the start {_format_position(start)} lies in an occupied or unknown cell; a free one is needed"
            )
        radius = self._inflated.inflation.inscribed_radius
        found = self._cheapest_cells(
            costs, moves, start_cell, goal_cell, radius / grid.resolution, self._tolerance / grid.resolution
        )
        if found is None:
            raise NoPath(self._failure_reason(costs, start, goal, goal_cell, radius))
        cells, pinned = found
        points: Floats = cells[:, ::-1].astype(np.float64) + 0.5
        points[0] = _to_cells(grid, start)
        if tuple(cells[-1]) == goal_cell:
            points[-1] = _to_cells(grid, goal)
        if len(points) == 1:
            points = np.stack((_to_cells(grid, start), points[0]))
        weights = self._cell_weights(moves)
        return _make_path(
            grid,
            refine_path((costs, weights), points, pinned, self._spacing / grid.resolution, self._smoothing_rounds),
            start,
        )

    def cost(self, grid: OccupancyGrid, path: Path) -> float:
        """Return what the search charges for a path; inf if it is blocked once it has left the
        inscribed zone about its start.
        """
        if not grid.contains(grid.cells(path.poses[:, :2])).all():
            return math.inf
        weights = self._cell_weights(self._move_costs(grid.resolution))
        return path_cost(grid.derive(self._inflated), weights, _positions_in_cells(grid, path.poses[:, :2]))

    def is_narrow(self, grid: OccupancyGrid, path: Path) -> bool:
        """Return whether the path leads through a passage without ``padding``; its ends may lie beside walls."""
        if not grid.contains(grid.cells(path.poses[:, :2])).all():
            return False
        narrow_from = self._move_costs(grid.resolution).narrow_from
        return bool(
            leads_through(grid.derive(self._inflated), narrow_from, _positions_in_cells(grid, path.poses[:, :2]))
        )

    def _move_costs(self, resolution: float) -> MoveCosts:
        """Return what moves cost on a grid: a wall's edge is half a cell nearer than its cell's centre."""
        inflation = self._inflated.inflation
        if self._padding == 0.0 or inflation.inflation_radius == 0.0:
            return self._plain
        least = int(inflation.costs_at(np.array(inflation.inscribed_radius + self._padding + 0.5 * resolution)))
        return replace(self._plain, narrow_from=max(least, 1), narrow_cost=self._narrow_cost)

    def _cell_weights(self, moves: MoveCosts) -> Floats:
        return moves.neutral_cost * moves.relative()

    def _cheapest_cells(
        self, costs: Costs, moves: MoveCosts, start: Cell, goal: Cell, radius: float, tolerance: float
    ) -> tuple[Cells, int] | None:
        """Return the way as (K, 2) cells and how many of them lead out of the inscribed zone, None if there
        is none; lengths in cells.
        """
        ways = escape_paths(costs, start, 2 + math.ceil(2.0 * radius))
        exhausted: list[CostToGo] = []
        for target in free_cells_near(costs, goal, tolerance) if ways else ():
            if any(math.isfinite(search(target)) for search in exhausted):
                continue  # shut in with a target that was tried
            search = self._goal_search(costs, moves, target, ways[0][-1])
            for way in ways:
                if math.isfinite(search(way[-1])):
                    return np.concatenate((np.array(way, np.int64), search.cells_from(way[-1])[1:])), len(way) - 1
            exhausted.append(search)
        return None

    def _goal_search(self, costs: Costs, moves: MoveCosts, goal: Cell, anchor: Cell) -> CostToGo:
        """Return the search for this goal, the one of the last query if costs and goal are the same."""
        if self._last is None or self._last[0] is not costs or self._last[1].goal != goal:
            self._last = costs, CostToGo(costs, moves, goal, anchor)
        return self._last[1]

    def _failure_reason(self, costs: Costs, start: Pose, goal: Pose, goal_cell: Cell, radius: float) -> str:
        if costs[goal_cell] >= INSCRIBED:
            return (
                f"the goal {_format_position(goal)} is blocked, no way leads within {self._tolerance} m of it "
                f"(inscribed radius {radius:.3f} m)"
            )
        return (
            f"no way leads from {_format_position(start)} to {_format_position(goal)} (inscribed radius {radius:.3f} m)"
        )


def _format_position(pose: Pose) -> str:
    return f"({pose.x:.2f}, {pose.y:.2f})"


def _cell_of(grid: OccupancyGrid, pose: Pose, role: str) -> Cell:
    """Return the cell of a position; raise NoPath outside the grid."""
    cell = grid.cells((pose.x, pose.y))
    if not grid.contains(cell):
        raise NoPath(
            f"the {role} {_format_position(pose)} lies outside the map of {grid.data.shape[1]} x "
            f"{grid.data.shape[0]} cells"
        )
    return int(cell[0]), int(cell[1])


def _to_cells(grid: OccupancyGrid, pose: Pose) -> Floats:
    """Return a position of ``map`` as (column, row) in cells."""
    return _positions_in_cells(grid, np.array((pose.x, pose.y)))


def _positions_in_cells(grid: OccupancyGrid, positions_xy: Floats) -> Floats:
    """Return positions of ``map`` (..., 2) as (column, row) in cells."""
    x, y = positions_xy[..., 0] - grid.origin.x, positions_xy[..., 1] - grid.origin.y
    c, s = math.cos(grid.origin.theta), math.sin(grid.origin.theta)
    return np.stack((c * x + s * y, c * y - s * x), axis=-1) / grid.resolution


def _make_path(grid: OccupancyGrid, points: Floats, start: Pose) -> Path:
    """Turn (column, row) points in cells into poses in ``map``, each heading for the
    next, the last as the one before.
    """
    positions = grid.positions(points[:, ::-1] - 0.5)
    steps = np.diff(positions, axis=0)
    headings = np.arctan2(steps[:, 1], steps[:, 0])
    return Path(np.column_stack((positions, np.append(headings, headings[-1]))))
