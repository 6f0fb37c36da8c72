import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arena_mppi.cost_to_go import UNREACHED, fast_sweep, fill_slowness, last_inside, nearest_row


def solved(slow, row, column, side=0.1):
    left = np.full(slow.shape, UNREACHED, np.float32)
    left[row, column] = 0.0
    return left, fast_sweep(left, slow, side)


@settings(derandomize=True, deadline=None, max_examples=40)
@given(st.integers(0, 39), st.integers(0, 49))
def test_open_ground_leaves_the_straight_distance(row, column):
    left, rounds = solved(np.ones((40, 50), np.float32), row, column)
    rows, columns = np.mgrid[0:40, 0:50]
    np.testing.assert_allclose(left, 0.1 * np.hypot(rows - row, columns - column), atol=0.15)
    assert rounds <= 3


def test_wall_is_gone_round():
    slow = np.ones((40, 40), np.float32)
    slow[:30, 20] = 1000.0
    left, _ = solved(slow, 5, 35)
    assert left[5, 5] > 0.1 * 2 * np.hypot(15, 25) - 0.2
    assert np.isfinite(left).all()


def test_spiral_is_settled_within_the_rounds():
    slow = np.ones((41, 41), np.float32)
    for k in range(0, 16, 4):
        slow[k, k : 41 - k] = slow[40 - k, k : 41 - k] = slow[k + 4 : 41 - k, k] = slow[k : 41 - k, 40 - k] = 1000.0
    left, _ = solved(slow, 20, 20)
    again = left.copy()
    assert fast_sweep(again, slow, 0.1) == 1
    np.testing.assert_allclose(again, left, atol=2e-3)


def test_metres_cost_more_near_walls_and_most_where_the_robot_does_not_fit():
    gaps = np.array([[0.1, 0.15, 0.3, 0.3, 0.4, 0.6, 0.15, 0.21]] * 2, np.float32)
    slow = np.empty((1, 4), np.float32)
    fill_slowness(gaps, 0.2, 0.4, 2.0, 20.0, slow)
    # it just fits in one half of the last
    assert slow[0].tolist() == pytest.approx([20.0, 1.0 + 2.0 * 0.75**2, 1.0 + 2.0 * 0.25**2, 3.0])


def test_the_way_ends_where_the_path_first_leaves_the_window():
    path = np.array([(x, 0.0, 0.0) for x in (0.0, 1.0, 2.0, 3.0, 2.0, 1.0)])
    assert last_inside(path, 0, -2.5, -2.5, 2.5, 2.5) == 2
    assert last_inside(path, 4, -2.5, -2.5, 2.5, 2.5) == 5
    assert nearest_row(path, 1.9, 0.3) == 2
