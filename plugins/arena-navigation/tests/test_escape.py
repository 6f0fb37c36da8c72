import numpy as np

from arena_core import INSCRIBED, LETHAL
from arena_navigation.planning.escape import escape_paths, free_cells_near


def test_a_free_start_is_its_own_way_out() -> None:
    assert escape_paths(np.zeros((3, 3), np.uint8), (1, 1), 5) == [[(1, 1)]]


def test_the_shortest_way_out_comes_first_and_avoids_obstacles() -> None:
    costs = np.full((7, 7), INSCRIBED, np.uint8)
    costs[3, 4] = LETHAL
    costs[3, 5] = costs[0, 3] = 0
    ways = escape_paths(costs, (3, 3), 5)
    assert [way[-1] for way in ways] == [(0, 3), (3, 5)]
    assert ways[0] == [(3, 3), (2, 3), (1, 3), (0, 3)]
    for (row, column), (next_row, next_column) in zip(ways[1][:-1], ways[1][1:], strict=True):
        assert max(costs[row, next_column], costs[next_row, column]) < LETHAL


def test_no_way_out_is_looked_for_beyond_the_reach() -> None:
    costs = np.full((9, 9), INSCRIBED, np.uint8)
    costs[4, 8] = 0
    assert escape_paths(costs, (4, 4), 3) == []
    assert len(escape_paths(costs, (4, 4), 4)) == 1


def test_free_cells_come_nearest_first_within_the_tolerance() -> None:
    costs = np.zeros((9, 9), np.uint8)
    costs[3:6, 3:6] = LETHAL
    found = list(free_cells_near(costs, (4, 4), 2.3))
    assert found[:4] == [(2, 4), (4, 2), (4, 6), (6, 4)]
    distances = [np.hypot(row - 4, column - 4) for row, column in found]
    assert distances == sorted(distances)
    assert max(distances) <= 2.3
    assert len(found) == 12


def test_a_free_cell_itself_comes_first_even_without_tolerance() -> None:
    costs = np.zeros((3, 3), np.uint8)
    assert list(free_cells_near(costs, (0, 2), 0.0)) == [(0, 2)]
    costs[0, 2] = LETHAL
    assert list(free_cells_near(costs, (0, 2), 0.0)) == []
