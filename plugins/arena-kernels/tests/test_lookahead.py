import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arena_kernels.costmap_window import LETHAL, CostmapWindow
from arena_kernels.distance import distance_field
from arena_kernels.lookahead import farthest_in_sight, in_sight

STRAIGHT = np.stack((np.arange(-1.5, 1.51, 0.1), np.full(31, 0.025), np.zeros(31)), axis=1)


def window_with(*cells):
    costs = np.zeros((80, 80), np.uint8)
    for row, column in cells:
        costs[row, column] = LETHAL
    return CostmapWindow(costs, distance_field(costs >= LETHAL, 0.05), 0.05, -2.0, -2.0)


@pytest.mark.parametrize(("lookahead", "x"), [(0.5, 0.0), (1.0, 0.5), (9.0, 1.5)])
def test_free_path_is_seen_as_far_as_one_looks_or_to_its_end(lookahead, x):
    place = farthest_in_sight(STRAIGHT, window_with(), 0.2, -0.5, 0.3, lookahead, 0.05)
    assert math.isclose(STRAIGHT[place, 0], x, abs_tol=1e-9)


def test_nothing_is_seen_behind_a_wall_but_what_is_near_is_followed():
    wall = window_with(*((row, 60) for row in range(80)))  # at x = 1
    place = farthest_in_sight(STRAIGHT, wall, 0.2, -0.5, 0.0, 2.0, 0.05)
    assert 0.7 < STRAIGHT[place, 0] < 0.8 + 1e-9
    near = farthest_in_sight(STRAIGHT, wall, 0.2, 0.9, 0.0, 2.1, 0.05)
    assert math.isclose(STRAIGHT[near, 0], 1.4, abs_tol=1e-9)  # a quarter of the lookahead


@settings(derandomize=True, deadline=None)
@given(
    st.lists(st.tuples(st.integers(0, 79), st.integers(0, 79)), max_size=30),
    *(st.floats(-1.8, 1.8) for _ in range(4)),
    st.floats(0.05, 0.5),
)
def test_finer_looks_and_larger_discs_see_no_more(cells, x, y, to_x, to_y, needed):
    window = window_with(*cells)
    if in_sight(window, (x, y, to_x, to_y), needed, 0.05):
        assert in_sight(window, (x, y, to_x, to_y), needed, 10.0)
        assert in_sight(window, (x, y, to_x, to_y), 0.5 * needed, 0.05)
