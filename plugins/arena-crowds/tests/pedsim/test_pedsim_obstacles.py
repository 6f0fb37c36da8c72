import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from shapely import Point, Polygon

from arena_core import ImpossibleScenario, Obstacle, OccupancyGrid, Pose
from arena_core.scenes import add_obstacles


def test_without_obstacles_it_is_the_same_grid(stage):
    hall = stage.hall(4, 4)
    assert add_obstacles(hall, ()) is hall


@given(st.floats(0.5, 3.5), st.floats(0.5, 3.5), st.floats(0.06, 1.0))
def test_a_disc_covers_the_cells_whose_centres_it_holds(x, y, radius):
    grid = OccupancyGrid(np.zeros((80, 80), np.int8), 0.05, Pose(0.3, -0.2, 0.4))
    marked = add_obstacles(grid, [Obstacle(np.array([(x, y)]), radius)]).occupied
    centres = grid.positions(np.argwhere(np.ones((80, 80), bool))).reshape(80, 80, 2)
    expected = np.hypot(*(centres - (x, y)).transpose(2, 0, 1)) <= radius
    assert (marked & ~expected).sum() <= 1  # the centre's own cell
    assert not (expected & ~marked).any()


def test_a_polygon_covers_its_inside_and_its_outline(stage):
    hall = stage.hall(6, 6)
    corners = np.array([(1.0, 1.0), (4.0, 1.5), (2.0, 2.0), (3.0, 4.5)])  # not convex
    marked = add_obstacles(hall, [Obstacle(corners)]).occupied & ~hall.occupied
    shape = Polygon(corners)
    for row, column in np.ndindex(hall.data.shape):
        centre = Point((column + 0.5) * 0.05, (row + 0.5) * 0.05)
        if shape.contains(centre):
            assert marked[row, column] or hall.occupied[row, column]
        elif marked[row, column]:
            assert shape.distance(centre) < 0.036


def test_an_obstacle_thinner_than_a_cell_is_not_lost(stage):
    thin = np.array([(1.01, 1.01), (3.01, 1.01), (3.01, 1.02), (1.01, 1.02)])
    marked = add_obstacles(stage.hall(4, 4), [Obstacle(thin)]).occupied
    assert marked[20, 20:61].all()


def test_an_obstacle_partly_off_the_map_is_cut(stage):
    assert add_obstacles(stage.hall(4, 4), [Obstacle(np.array([(4.0, 2.0)]), 1.0)]).occupied[40, 62:].all()


def test_people_walk_round_obstacles(stage, make_model):
    crate = Obstacle(np.array([(4.0, 1.5), (6.0, 1.5), (6.0, 4.5), (4.0, 4.5)]))
    drum = Obstacle(np.array([(8.0, 3.0)]), 0.5)
    scenario = stage.scenario(stage.hall(11, 6), [stage.person(0, (2, 3), (10, 3), (2, 3))], [crate, drum])
    positions = np.array([crowd.positions[0, 0] for crowd in stage.walk(make_model(), scenario, 15.0)])
    beside = np.maximum(np.abs(positions - (5.0, 3.0)) - (1.0, 1.5), 0.0)
    assert np.hypot(*beside.T).min() > 0.3 - 0.05
    assert np.hypot(*(positions - (8.0, 3.0)).T).min() > 0.8 - 0.05
    assert np.hypot(*(positions - (10.0, 3.0)).T).min() < 0.5


def test_a_start_inside_an_obstacle_is_named(stage, make_model):
    scenario = stage.scenario(stage.hall(6, 6), [stage.person(4, (3, 3))], [Obstacle(np.array([(3.0, 3.0)]), 0.5)])
    with pytest.raises(ImpossibleScenario, match="person 4 starts at \\(3, 3\\), inside a wall or an obstacle"):
        make_model().reset(np.zeros(1, int), [scenario], 1)
