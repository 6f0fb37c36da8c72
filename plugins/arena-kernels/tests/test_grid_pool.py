import numpy as np

from arena_kernels.distance import grid_distance
from arena_kernels.pool import GridPool
from arena_kernels.raycast import cast_grid, make_beams

BEAMS = make_beams(0.0, np.pi / 8, 16, 3.0)


def check(pool, grids):
    """Hold every world's grid in the stack to the grid itself, by a scan from its middle."""
    for g, grid in zip(pool.place(grids).tolist(), grids, strict=True):
        rows, columns = grid.occupied.shape
        start = pool.stack.offsets[g]
        np.testing.assert_array_equal(
            pool.stack.distance[start : start + rows * columns], grid.derive(grid_distance).ravel()
        )
        alone = GridPool()
        alone.place([grid])
        pose = (*grid.positions((columns / 2, rows / 2)), 0.3)
        one, other = np.empty(16, np.float32), np.empty(16, np.float32)
        cast_grid(pool.stack, g, pose, BEAMS, one)
        cast_grid(alone.stack, 0, pose, BEAMS, other)
        np.testing.assert_array_equal(one, other)


def test_worlds_that_begin_one_by_one_find_their_grids(random_grid):
    pool = GridPool()
    grids = [random_grid(seed) for seed in range(6)]
    check(pool, grids)
    for seed in range(6, 40):
        grids[seed % 6] = random_grid(seed)
        check(pool, grids)


def test_grid_that_was_there_before_moves_nothing(random_grid):
    pool = GridPool()
    grids = [random_grid(seed) for seed in range(4)]
    pool.place(grids)
    before = pool.stack
    assert pool.place([grids[2], grids[2], grids[0]]).tolist() == [2, 2, 0]
    assert pool.stack is before


def test_new_grid_is_written_behind_the_others(make_grid):
    pool = GridPool()
    pool.place([make_grid(np.eye(9)), make_grid(np.eye(8))])
    before = pool.stack
    pool.place([make_grid(np.eye(5))])
    assert pool.stack.distance is before.distance


def test_single_grid_is_not_copied_by_the_pool(make_grid):
    pool = GridPool()
    for grid in (make_grid(np.eye(4)), make_grid(np.eye(5))):
        pool.place([grid])
        assert np.shares_memory(pool.stack.distance, grid.derive(grid_distance))
