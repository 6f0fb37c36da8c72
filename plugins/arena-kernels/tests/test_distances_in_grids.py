"""Distances and rooms looked up in grids, against the other kernel that knows them and by hand."""

import math

import numpy as np
import pytest

from arena_kernels.distance import grid_distance
from arena_kernels.footprint import make_body, place_body
from arena_kernels.grids import distance_and_gradient, is_blocked, stack_grids, to_grid
from arena_kernels.ground import Ground, clearance_and_gradient
from arena_kernels.route_grid import coarse_grid_maker
from arena_kernels.walls import gap_to_cells


@pytest.mark.parametrize("seed", range(6))
def test_distances_of_a_stack_are_those_of_each_grid_inside_and_outside(seed, random_grid):
    grids = [random_grid(seed), random_grid(seed + 100)]
    stack, which = stack_grids(grids)
    for g, grid in zip(which, grids, strict=True):
        origin = grid.origin
        ground = Ground(
            *(grid_distance(grid), origin.x, origin.y, math.cos(origin.theta), math.sin(origin.theta), grid.resolution)
        )
        rows, columns = grid.occupied.shape
        for x, y in grid.positions(np.random.default_rng(seed).uniform(-3.0, (columns + 3.0, rows + 3.0), (40, 2))):
            expected = clearance_and_gradient(ground, x, y)
            assert distance_and_gradient(stack, g, x, y) == pytest.approx(expected, abs=1e-6)


def test_a_position_is_a_cell_of_the_turned_grid_and_nothing_outside_is_blocked(make_grid):
    blocked = np.zeros((3, 4), bool)
    blocked[1, 2] = True
    grid = make_grid(blocked, 0.5, 1.0, 2.0, 0.5 * math.pi)
    stack, _ = stack_grids([grid])
    assert to_grid(stack, 0, 0.25, 3.0) == pytest.approx((2.0, 1.5)), "1 m up, 0.75 m to the left"
    assert is_blocked(stack, 0, 0.25, 3.1)
    assert not is_blocked(stack, 0, 0.25, 2.9)
    assert not is_blocked(stack, 0, 0.75, 3.1)
    assert not is_blocked(stack, 0, 9.0, 9.0)


def test_a_coarse_cell_has_the_room_of_its_roomiest_place(make_grid):
    """A wall in the first column of cells of 0.1 m: 0.05 m less than from centre to centre to its edge."""
    blocked = np.zeros((4, 6), bool)
    blocked[:, 0] = True
    rooms = coarse_grid_maker(0.2)(make_grid(blocked, 0.1))
    assert rooms.factor == 2
    assert rooms.room == pytest.approx(np.tile((0.05, 0.25, 0.45), (2, 1)), abs=1e-6)
    assert rooms.place.tolist() == [[1, 3, 5], [13, 15, 17]], "the first of them, row by row"


def test_a_body_of_six_corners_is_held_against_the_four_of_a_cell(make_grid):
    """Its foremost corner reaches 0.3 m ahead: 0.2 m are left to the cell."""
    blocked = np.zeros((20, 20), bool)
    blocked[5, 10] = True
    stack, _ = stack_grids([make_grid(blocked, 0.1)])
    body = make_body(
        0.3 * np.array([(math.cos(k * math.pi / 3.0), math.sin(k * math.pi / 3.0)) for k in range(6)]), 0.3
    )
    place_body(body, 0.5, 0.55, 0.0)
    gap, nx, ny, px, py = gap_to_cells(stack, 0, body, 1.0)
    assert (gap, nx, ny, px) == pytest.approx((0.2, 1.0, 0.0, 1.0))
    assert 0.5 <= py <= 0.6
