import pickle

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from arena_core import Crowd, OccupancyGrid, Path, Pose

grids = st.builds(
    lambda height, width, resolution, x, y, yaw: OccupancyGrid(
        np.zeros((height, width), np.int8), resolution, Pose(x, y, yaw)
    ),
    *(st.integers(1, 40), st.integers(1, 40), st.floats(0.01, 1.0)),
    *(st.floats(-100.0, 100.0), st.floats(-100.0, 100.0), st.floats(-3.2, 3.2)),
)


@given(grid=grids, row=st.integers(-50, 50), column=st.integers(-50, 50))
def test_the_centre_of_a_cell_lies_in_that_cell_also_on_a_turned_map(grid, row, column):
    assert grid.cells(grid.positions((row, column))).tolist() == [row, column]


@given(grid=grids)
def test_neighbouring_centres_are_one_resolution_apart(grid):
    steps = np.diff(grid.positions([(0, 0), (0, 1), (1, 1)]), axis=0)
    assert np.allclose(np.hypot(*steps.T), grid.resolution)


def test_rows_run_up_and_columns_to_the_right():
    grid = OccupancyGrid(np.zeros((4, 6), np.int8), 0.5, Pose(-1.0, 2.0))
    assert grid.positions([(0, 0), (0, 1), (1, 0)]).tolist() == [[-0.75, 2.25], [-0.25, 2.25], [-0.75, 2.75]]


def test_a_quarter_turn_of_the_origin_turns_rows_to_the_left():
    grid = OccupancyGrid(np.zeros((4, 6), np.int8), 1.0, Pose(0.0, 0.0, np.pi / 2))
    assert np.allclose(grid.positions((0, 2)), (-0.5, 2.5))


def test_contains_knows_the_edges():
    grid = OccupancyGrid(np.zeros((2, 3), np.int8), 1.0, Pose(0.0, 0.0))
    cells = np.array(((0, 0), (1, 2), (2, 0), (0, 3), (-1, 0), (0, -1)))
    assert grid.contains(cells).tolist() == [True, True, False, False, False, False]


def test_a_map_cannot_be_written_to():
    source = np.zeros((2, 2), np.int8)
    grid = OccupancyGrid(source, 1.0, Pose(0.0, 0.0))
    source[0, 0] = 100
    assert grid.data[0, 0] == 0
    with pytest.raises(ValueError, match="read-only"):
        grid.data[0, 0] = 100


def test_a_cell_is_occupied_from_the_threshold_on_and_unknown_is_not():
    grid = OccupancyGrid(np.array(((-1, 0, 64), (65, 99, 100))), 1.0, Pose(0.0, 0.0))
    assert grid.occupied.tolist() == [[False, False, False], [True, True, True]]


def test_what_is_derived_from_a_map_is_computed_once():
    calls = []

    def derived(grid):
        calls.append(grid)
        return len(calls)

    grid = OccupancyGrid(np.zeros((2, 2), np.int8), 1.0, Pose(0.0, 0.0))
    assert [grid.derive(derived), grid.derive(derived)] == [1, 1]
    assert calls == [grid]


def test_a_map_travels_to_another_process_without_what_is_derived_from_it():
    grid = OccupancyGrid(np.array(((0, 100),)), 0.5, Pose(1.0, 2.0, 0.3), occupied_from=50)
    grid.derive(lambda g: "not picklable by name")
    copy = pickle.loads(pickle.dumps(grid))
    assert (copy.data == grid.data).all()
    assert (copy.resolution, copy.origin, copy.occupied_from) == (0.5, Pose(1.0, 2.0, 0.3), 50)
    assert not copy.data.flags.writeable


def test_a_world_of_a_crowd_holds_only_its_own_people_and_copies_of_them():
    crowd = Crowd(
        np.array((2, 1), np.int32),
        np.array(((7, 8), (9, 0)), np.int32),
        np.array(((((0.0, 0.0)), (1.0, 1.0)), ((2.0, 2.0), (np.nan, np.nan)))),
        np.zeros((2, 2, 2)),
        np.full((2, 2), 0.3),
        np.zeros((2, 2), np.int8),
    )
    people = crowd.world(1)
    assert people.ids.tolist() == [9]
    people.positions[:] = 5.0
    assert crowd.positions[1, 0].tolist() == [2.0, 2.0]


def test_the_length_of_a_path_is_that_of_its_polyline():
    assert Path(np.array(((0.0, 0.0, 0.0), (3.0, 4.0, 0.0), (3.0, 5.0, 0.0)))).length == pytest.approx(6.0)
