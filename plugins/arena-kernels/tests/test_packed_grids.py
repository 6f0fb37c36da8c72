import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arena_kernels.distance import grid_distance
from arena_kernels.grids import (
    LINE,
    TILE,
    distance_and_gradient,
    is_blocked,
    quadrant_reach,
    stack_grids,
    table_size,
    tile_index,
    to_grid,
)

seeds = st.integers(0, 2**32 - 1)


def test_worlds_that_share_a_grid_share_its_memory(make_grid):
    first, second = make_grid(np.eye(4)), make_grid(np.zeros((2, 3)))
    stack, grid_of = stack_grids([first, second, first, first])
    assert grid_of.tolist() == [0, 1, 0, 0]
    assert stack.cells.size == 16 + 6
    assert stack.offsets.tolist() == [0, 16]


def test_single_grid_is_not_copied(make_grid):
    grid = make_grid(np.eye(4))
    stack, _ = stack_grids([grid, grid])
    assert np.shares_memory(stack.distance, grid.derive(grid_distance))


@given(seeds)
@settings(derandomize=True, deadline=None, max_examples=50)
def test_position_is_blocked_where_its_cell_is_occupied(random_grid, seed):
    grid = random_grid(seed)
    stack, _ = stack_grids([random_grid(seed + 1), grid])
    rows, columns = grid.occupied.shape
    for u, v in np.random.default_rng(seed).uniform(-2.0, 52.0, (20, 2)):
        x, y = grid.positions((u, v))
        inside = u < columns and v < rows and min(u, v) >= 0.0
        assert is_blocked(stack, 1, x, y) == (inside and grid.occupied[int(v), int(u)])
        assert to_grid(stack, 1, x, y) == pytest.approx((u, v), abs=1e-9)


@given(seeds)
@settings(derandomize=True, deadline=None, max_examples=30)
def test_reach_is_the_largest_empty_square(random_grid, seed):
    grid = random_grid(seed)
    rows, columns = grid.occupied.shape
    tables = quadrant_reach(grid).reshape(4, table_size(rows, columns))
    assert tables.ctypes.data % LINE == 0
    for quadrant in range(4):
        cells = grid.occupied[:: -1 if quadrant & 2 else 1, :: -1 if quadrant & 1 else 1]
        for row, column in np.ndindex(rows, columns):
            side = tables[quadrant, tile_index(row, column, (columns // TILE + 1) * TILE * TILE)]
            assert not cells[row : row + side, column : column + side].any()
            assert side <= min(rows - row, columns - column)
            if side < min(rows - row, columns - column):
                assert cells[row : row + side + 1, column : column + side + 1].any()


def test_distance_is_to_the_surface_and_grows_along_its_gradient(make_grid):
    occupied = np.zeros((40, 40))
    occupied[:, 0] = 1
    grid = make_grid(occupied, 0.05, 1.0, -2.0, 0.7)
    stack, _ = stack_grids([grid])
    x, y = grid.positions((11.0, 20.3))
    distance, gx, gy = distance_and_gradient(stack, 0, x, y)
    assert distance == pytest.approx(10 * 0.05, abs=1e-6)
    assert (gx, gy) == pytest.approx((np.cos(0.7), np.sin(0.7)), abs=1e-6)


def test_grid_without_walls_pushes_nobody(make_grid):
    stack, _ = stack_grids([make_grid(np.zeros((5, 5)))])
    assert distance_and_gradient(stack, 0, 0.1, 0.1) == (np.inf, 0.0, 0.0)


def test_outside_the_grid_the_nearest_distance_inside_counts(make_grid):
    occupied = np.zeros((4, 4))
    occupied[0, 0] = 1
    stack, _ = stack_grids([make_grid(occupied, 1.0)])
    assert distance_and_gradient(stack, 0, 9.0, 0.5) == distance_and_gradient(stack, 0, 3.5, 0.5)
