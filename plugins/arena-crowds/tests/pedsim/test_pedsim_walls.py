import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.ndimage import label

from arena_core import OccupancyGrid, Pose
from arena_kernels.distance import grid_distance
from arena_kernels.grids import distance_and_gradient, stack_grids
from arena_kernels.ground import clearance_and_gradient, ground_of, layouts_of
from arena_kernels.slide_along import is_visible, slide_along

coordinate, move = st.floats(-1.0, 9.0), st.floats(-3.0, 3.0)


def cluttered(yaw: float) -> OccupancyGrid:
    data = np.zeros((160, 160), np.int8)
    data[[0, -1], :] = data[:, [0, -1]] = 100
    random = np.random.default_rng(4)
    for row, column in random.integers(0, 150, (25, 2)):
        data[row : row + 8, column : column + 1 + row % 12] = 100
    return OccupancyGrid(data, 0.05, Pose(0.0, 0.0, yaw))


def ground_in(grid: OccupancyGrid):
    stack, _ = stack_grids([grid])
    return ground_of(stack.distance, layouts_of(stack)[0])


STACK, _ = stack_grids([cluttered(0.0), cluttered(0.3)])
GROUNDS = [ground_of(STACK.distance, layouts_of(STACK)[g]) for g in range(2)]
grounds = st.sampled_from(GROUNDS)


@given(st.integers(0, 1), coordinate, coordinate)
def test_the_ground_is_that_of_the_shared_kernels(g, x, y):
    assert clearance_and_gradient(GROUNDS[g], x, y) == pytest.approx(distance_and_gradient(STACK, g, x, y), abs=1e-12)


@given(grounds, coordinate, coordinate, move, move, st.floats(0.05, 0.6))
def test_no_move_ends_nearer_to_a_wall_than_the_radius(ground, x, y, dx, dy, radius):
    before = clearance_and_gradient(ground, x, y)[0]
    if before < 0.0:
        return
    after = clearance_and_gradient(ground, *slide_along(ground, (x, y, radius), dx, dy))[0]
    assert after >= min(before, radius) - 1e-9


@given(coordinate, coordinate, move, move)
def test_no_move_crosses_a_wall(x, y, dx, dy):
    """Both ends of a move lie in the same piece of ground on which the body has room (but for a cell)."""
    radius, grid = 0.2, cluttered(0.0)
    pieces, _ = label(grid.derive(grid_distance) > radius - 0.05)
    if grid.contains(grid.cells((x, y))) and clearance_and_gradient(GROUNDS[0], x, y)[0] >= radius:
        end = slide_along(GROUNDS[0], (x, y, radius), dx, dy)
        assert not grid.contains(grid.cells(end)) or pieces[tuple(grid.cells(end))] == pieces[tuple(grid.cells((x, y)))]


def test_a_wall_of_one_cell_holds_somebody_fast(stage):
    hall = stage.hall(10, 4, [(5.0, 0.0, 5.05, 4.0)])
    ground = ground_in(hall)
    for length in (0.1, 1.0, 8.0):
        assert slide_along(ground, (2.0, 2.0, 0.3), length, 0.0)[0] <= 4.7 + 1e-9


def test_who_walks_into_a_wall_slides_along_it(stage):
    ground = ground_in(stage.hall(10, 4))
    x, y = slide_along(ground, (5.0, 0.4, 0.3), 1.0, -1.0)
    assert x == pytest.approx(6.0, abs=1e-6)
    assert y == pytest.approx(0.35, abs=1e-6)


def test_a_body_pressed_into_a_wall_gets_out(stage):
    ground = ground_in(stage.hall(10, 4))
    assert slide_along(ground, (5.0, 0.2, 0.3), 0.0, 0.0)[1] == pytest.approx(0.35, abs=1e-6)


def test_sight_needs_room_on_both_sides(stage):
    ground = ground_in(stage.hall(10, 4, [(5.0, 0.0, 5.2, 1.5), (5.0, 2.5, 5.2, 4.0)]))
    assert is_visible(ground, (2.0, 2.0, 8.0, 2.0), 0.45)
    assert not is_visible(ground, (2.0, 2.0, 8.0, 2.0), 0.55)
    assert not is_visible(ground, (2.0, 1.0, 8.0, 1.0), 0.1)


@pytest.mark.slow
@pytest.mark.parametrize(("routing", "seconds"), [("around_walls", 600.0), ("straight", 120.0)])
def test_fifty_people_pass_through_no_wall_in_ten_minutes(stage, make_model, routing, seconds):
    hall = stage.hall(20, 20, stage.racks)
    occupied = (np.argwhere(hall.occupied)[:, ::-1] + 0.5) * 0.05
    scenario = stage.crowded(hall, 50, 3)
    before = np.array([spec.position_xy for spec in scenario.pedestrians])
    walked = np.zeros(50)
    for tick, crowd in enumerate(stage.walk(make_model(wayfinding={"routing": routing}), scenario, seconds)):
        positions = crowd.positions[0]
        walked += np.hypot(*(positions - before).T)
        assert not hall.occupied[tuple(hall.cells((positions + before) / 2).T)].any()
        before = positions
        # the true distance to the squares of the map; its interpolation may err by a fifth of a cell
        if tick % 100 == 0:
            gaps = np.maximum(np.abs(positions[:, None] - occupied) - 0.025, 0.0)
            assert np.hypot(gaps[..., 0], gaps[..., 1]).min() > 0.3 - 0.015
    assert (walked > seconds * 0.1 * np.array([spec.desired_speed for spec in scenario.pedestrians])).all()
