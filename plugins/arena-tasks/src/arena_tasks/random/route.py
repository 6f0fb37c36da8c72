"""The way that a robot will roughly take: shortest, but away from walls where there is room."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from arena_core import OccupancyGrid
from arena_kernels.compiled import compiled
from arena_tasks.random.free_space import FreeSpace

STRAIGHT, DIAGONAL = 5, 7  # integer lengths, 1 % off the square root of two: sums stay exact and comparisons safe
NEAR, COMFORTABLE = 2.0, 1.0  # a cell at a wall costs NEAR times one that is COMFORTABLE m or more away from it
BAND = 70  # cost of about a step
UNREACHED = np.int32(2**31 - 1)


def find_route(
    grid: OccupancyGrid, clearance: float, start_xy: NDArray[np.float64], goal_xy: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return cell centres from start to goal over cells with this much clearance, shape (M, 2);
    empty when there is no way.
    """
    prices = grid.derive(_Prices(clearance))
    start, goal = grid.cells(start_xy), grid.cells(goal_xy)
    return grid.positions(_trace_route(prices, _costs_to_goal(prices, goal, start), start)).reshape(-1, 2)


@dataclass(frozen=True, slots=True)
class _Prices:
    """A key and function for ``grid.derive``: what a step onto each cell costs, 0 where there is less clearance."""

    clearance: float

    def __call__(self, grid: OccupancyGrid) -> NDArray[np.int32]:
        clearance = grid.derive(FreeSpace).clearance
        comfort = np.clip(clearance / COMFORTABLE, 0.0, 1.0)
        prices = np.rint(10.0 * (NEAR - (NEAR - 1.0) * comfort)).astype(np.int32)
        return np.where(clearance >= self.clearance, prices, np.int32(0))


@compiled
def _costs_to_goal(prices: NDArray[np.int32], goal: NDArray[np.int64], start: NDArray[np.int64]) -> NDArray[np.int32]:
    """Return the cost from each cell to the goal, as far as the start needs it; no step cuts a corner.

    Label correcting in bands of cost, after Meyer and Sanders, Delta-stepping, Journal of Algorithms 49, 2003.
    """
    rows, columns = prices.shape
    costs = np.full((rows, columns), UNREACHED, np.int32)
    waiting = np.zeros((rows, columns), np.bool_)  # a cell waits at most once, in one of the two lists
    near, far = np.empty(rows * columns, np.int64), np.empty(rows * columns, np.int64)
    nears, fars, band = 1, 0, 0
    near[0] = goal[0] * columns + goal[1]
    costs[goal[0], goal[1]] = 0
    while nears > 0 and band - BAND < costs[start[0], start[1]]:
        while nears > 0:
            nears -= 1
            row, column = near[nears] // columns, near[nears] % columns
            waiting[row, column] = False
            for dr in range(-1, 2):
                for dc in range(-1, 2):
                    r, c = row + dr, column + dc
                    if r < 0 or c < 0 or r >= rows or c >= columns or prices[r, c] == 0 or (dr == 0 and dc == 0):
                        continue
                    if dr != 0 and dc != 0 and (prices[row, c] == 0 or prices[r, column] == 0):
                        continue
                    offer = costs[row, column] + prices[r, c] * (DIAGONAL if dr != 0 and dc != 0 else STRAIGHT)
                    if offer >= costs[r, c]:
                        continue
                    costs[r, c] = offer
                    if waiting[r, c]:
                        continue
                    waiting[r, c] = True
                    if offer < band:
                        near[nears] = r * columns + c
                        nears += 1
                    else:
                        far[fars] = r * columns + c
                        fars += 1
        while fars > 0 and nears == 0:
            band += BAND
            kept = 0
            for k in range(fars):
                if costs[far[k] // columns, far[k] % columns] < band:
                    near[nears] = far[k]
                    nears += 1
                else:
                    far[kept] = far[k]
                    kept += 1
            fars = kept
    return costs


@compiled
def _trace_route(prices: NDArray[np.int32], costs: NDArray[np.int32], start: NDArray[np.int64]) -> NDArray[np.int64]:
    """Follow the costs from the start to the goal; (M, 2) rows and columns, none when the start was not reached."""
    rows, columns = costs.shape
    steps = np.empty((rows * columns, 2), np.int64)
    count = 0
    row, column = start[0], start[1]
    while costs[row, column] != UNREACHED:
        steps[count, 0], steps[count, 1] = row, column
        count += 1
        if costs[row, column] == 0:
            break
        best, best_row, best_column = np.int64(UNREACHED), row, column
        for r in range(max(row - 1, 0), min(row + 2, rows)):
            for c in range(max(column - 1, 0), min(column + 2, columns)):
                diagonal = r != row and c != column
                if (r == row and c == column) or (diagonal and (prices[row, c] == 0 or prices[r, column] == 0)):
                    continue
                onward = np.int64(costs[r, c]) + prices[row, column] * (DIAGONAL if diagonal else STRAIGHT)
                if onward < best:
                    best, best_row, best_column = onward, r, c
        row, column = best_row, best_column
    return steps[:count]
