import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arena_dwa.map_grid import (
    UNSEEN,
    blocked_cells,
    cost_fields,
    interpolate_field,
    map_grids,
    path_cells,
    propagate_wavefront,
)
from arena_dwa.settings import Body, BodyOnWindow, Scales
from arena_kernels.costmap_window import outline_of, window_of

BODY = Body(outline_of(None, 0.113, 0.113, 0.05), 0.03, 0.25, 0.2)


GOAL_ONLY = Scales(0.0, 2.0, 0.0, True, 0.325, 0.0, 0.0, 0.0)


def goal_distance(grids, window, x, y, of_front=False):
    return interpolate_field(cost_fields(grids, window, GOAL_ONLY, False)[int(of_front)], window, x, y)


def path(*points):
    rows = np.array(points, dtype=np.float64)
    return np.column_stack((rows, np.zeros(len(rows))))


@settings(derandomize=True, deadline=None)
@given(st.integers(0, 30), st.integers(0, 40), st.integers(0, 30), st.integers(0, 40))
def test_free_space_distance_is_within_an_eighth_of_euclidean(row, column, seed_row, seed_column):
    cells = np.full((33, 43), UNSEEN, np.int32)
    cells[[0, -1]] = cells[:, [0, -1]] = -2
    propagate_wavefront(
        cells.reshape(-1), 43, np.array([(seed_row + 1) * 43 + seed_column + 1]), np.empty(cells.size + 1, np.int32)
    )
    straight = np.hypot(row - seed_row, column - seed_column)
    assert 0.89 * straight - 1e-9 <= cells[row + 1, column + 1] <= straight + 1.0


def test_wave_goes_round_a_wall(costmap):
    window = window_of(costmap((-0.05, 0.05, -3.0, 2.0)))
    grids = map_grids(BodyOnWindow(window, BODY), path((1.0, 0.0), (1.1, 0.0)), (-1.0, 0.0), 0.325)
    assert goal_distance(grids, window, -1.0, 0.0) > 4.0
    assert goal_distance(grids, window, -1.0, 0.0) > goal_distance(grids, window, -1.0, 1.0) + 0.6


def test_wave_goes_through_a_wall_that_cuts_the_robot_off(costmap):
    window = window_of(costmap((-0.05, 0.05, -3.1, 3.1)))
    grids = map_grids(BodyOnWindow(window, BODY), path((1.0, 0.0), (1.1, 0.0)), (-1.0, 0.0), 0.325)
    assert goal_distance(grids, window, -1.0, 0.0) == pytest.approx(2.1, abs=1e-5)


def test_front_is_led_beyond_the_goal(costmap):
    window = window_of(costmap())
    grids = map_grids(BodyOnWindow(window, BODY), path((0.0, 0.0), (1.0, 0.0)), (0.0, 0.0), 0.3)
    assert goal_distance(grids, window, 1.0, 0.0) < 1e-5
    assert goal_distance(grids, window, 1.3, 0.0, of_front=True) < 1e-5


def test_path_is_followed_from_abreast_of_the_robot_to_where_it_leaves_the_window(costmap):
    window = window_of(costmap())
    cells, inside = path_cells(path((-2.0, 0.0), (2.0, 0.0), (10.0, 0.0)), window, 1.9, 0.3)
    assert not inside
    columns = cells % (window.distance.shape[1] + 2) - 1
    assert columns[0] == 100  # x = 2 m, the pose nearest to the robot
    assert columns[-1] == 120
    assert (np.diff(columns) == 1).all()


def test_robot_off_its_path_is_led_to_the_windows_edge(costmap):
    window = window_of(costmap())
    cells, _ = path_cells(path((20.0, 0.0), (21.0, 0.0)), window, 0.0, 0.0)
    assert cells.tolist() == [61 * 123 + 121]


def test_cells_under_the_robot_stay_open_when_it_stands_in_an_obstacles_reach(costmap):
    window = window_of(costmap((0.05, 0.3, -0.1, 0.1)))
    cells = blocked_cells(window, BODY, 0.0, 0.0).reshape(123, 123)
    assert cells[61, 61] == UNSEEN
    assert cells[61, 67] != UNSEEN


def test_distance_between_cells_is_interpolated(costmap):
    window = window_of(costmap())
    grids = map_grids(BodyOnWindow(window, BODY), path((0.0, 0.0), (2.0, 0.0)), (0.0, 0.0), 0.3)
    assert abs(goal_distance(grids, window, 0.0, 0.0) - goal_distance(grids, window, 0.02, 0.0) - 0.02) < 1e-5


def test_alignment_counts_only_away_from_the_goal(costmap):
    window = window_of(costmap())
    grids = map_grids(BodyOnWindow(window, BODY), path((0.0, 0.0), (2.0, 0.0)), (0.0, 0.0), 0.3)
    path_only = GOAL_ONLY._replace(path_distance_bias=2.0, goal_distance_bias=0.0)
    assert interpolate_field(cost_fields(grids, window, path_only, True)[1], window, 0.0, 1.0) == pytest.approx(
        1.0, abs=1e-5
    )
    assert interpolate_field(cost_fields(grids, window, path_only, False)[1], window, 0.0, 1.0) == 0.0
