"""Routes are connected, never cheaper to improve, and keep away from walls where there is room."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra

from arena_core import OccupancyGrid, Pose
from arena_tasks.random.route import _Prices, find_route

EXACT = settings(derandomize=True, deadline=None, max_examples=60)


def maze(seed: int, density: float) -> OccupancyGrid:
    random = np.random.default_rng(seed)
    data = np.where(random.random((14, 17)) < density, 100, 0)
    data[0, 0] = data[-1, -1] = 0
    return OccupancyGrid(data, 0.5, Pose(-3.0, 1.0, 0.4))


def corner(grid: OccupancyGrid, cell: tuple[int, int]) -> NDArray[np.float64]:
    return grid.positions(cell)


def reference_cost(prices: NDArray[np.int32]) -> float:
    """Return the cost from the last cell to the first with scipy's Dijkstra."""
    rows, columns = prices.shape
    edges: dict[tuple[int, int], int] = {}
    for r in range(rows):
        for c in range(columns):
            for dr, dc in ((-1, -1), (-1, 0), (-1, 1), (0, -1), (0, 1), (1, -1), (1, 0), (1, 1)):
                a, b = r + dr, c + dc
                if not (0 <= a < rows and 0 <= b < columns) or 0 in (
                    prices[r, c],
                    prices[a, b],
                    prices[r, b],
                    prices[a, c],
                ):
                    continue
                edges[r * columns + c, a * columns + b] = int(prices[a, b]) * (7 if dr and dc else 5)
    if not edges:
        return np.inf
    ends = np.array(list(edges)).T
    graph = csr_array(
        (np.array(list(edges.values()), float), (ends[0], ends[1])), shape=(rows * columns, rows * columns)
    )
    return float(dijkstra(graph, indices=rows * columns - 1)[0])


@EXACT
@given(st.integers(0, 2**32), st.sampled_from([0.0, 0.1, 0.2, 0.3]))
def test_route_is_as_cheap_as_dijkstra_and_cuts_no_corner(seed: int, density: float) -> None:
    grid = maze(seed, density)
    prices = grid.derive(_Prices(0.1))
    route = find_route(grid, 0.1, corner(grid, (0, 0)), corner(grid, (13, 16)))
    reference = reference_cost(prices)
    assert (len(route) == 0) == np.isinf(reference)
    if len(route) == 0:
        return
    cells = grid.cells(route)
    steps = np.diff(cells, axis=0)
    assert (cells[0].tolist(), cells[-1].tolist()) == ([0, 0], [13, 16])
    assert (np.abs(steps).max(axis=1) == 1).all()
    assert (prices[tuple(cells.T)] > 0).all()
    between = np.stack((cells[:-1, 0], cells[1:, 1]), axis=1), np.stack((cells[1:, 0], cells[:-1, 1]), axis=1)
    assert all((prices[tuple(b.T)] > 0).all() for b in between)
    assert _cost(prices, cells) == reference


def _cost(prices: NDArray[np.int32], cells: NDArray[np.int64]) -> float:
    lengths = np.where(np.abs(np.diff(cells, axis=0)).sum(axis=1) == 2, 7, 5)
    return float((prices[tuple(cells[:-1].T)] * lengths).sum())


def test_route_to_itself_is_one_point() -> None:
    grid = maze(0, 0.0)
    assert find_route(grid, 0.1, corner(grid, (0, 0)), corner(grid, (0, 0))) == pytest.approx(
        corner(grid, (0, 0))[None]
    )


def test_there_is_no_route_through_a_wall() -> None:
    data = np.zeros((9, 9), np.int8)
    data[:, 4] = 100
    grid = OccupancyGrid(data, 1.0, Pose(0.0, 0.0))
    assert find_route(grid, 0.1, corner(grid, (1, 1)), corner(grid, (1, 7))).shape == (0, 2)


def test_route_keeps_to_the_middle_of_a_corridor() -> None:
    data = np.full((40, 200), 100, np.int8)
    data[4:36, 4:196] = 0
    grid = OccupancyGrid(data, 0.05, Pose(0.0, 0.0))
    route = find_route(grid, 0.1, corner(grid, (8, 10)), corner(grid, (8, 190)))
    middle = route[len(route) // 3 : -len(route) // 3, 1]
    assert np.abs(middle - 1.0).max() < 0.3
