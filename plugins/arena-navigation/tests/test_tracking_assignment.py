import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import linear_sum_assignment

from arena_navigation.tracking.assignment import Assignment, assign_rows


def assigned(costs, room=None):
    rows, columns = costs.shape
    room = room or Assignment.room(rows, columns)
    room.costs[: costs.size] = costs.ravel()
    assign_rows(rows, columns, room)
    return room.column_of[:rows].tolist()


@settings(derandomize=True, deadline=None, max_examples=300)
@given(
    st.integers(0, 10**6), st.integers(0, 12), st.integers(0, 12), st.sampled_from((2, 5, 10**9)), st.floats(0.0, 1.0)
)
def test_the_assignment_is_that_of_scipy_ties_included(seed, rows, more, values, impossible):
    random = np.random.default_rng(seed)
    costs = random.integers(0, values, (rows, rows + more)).astype(float) - 0.5 * values
    costs[random.random(costs.shape) < impossible] = 1e9
    assert assigned(costs) == linear_sum_assignment(costs)[1].tolist()


@settings(derandomize=True, deadline=None, max_examples=100)
@given(st.integers(0, 10**6), st.integers(1, 12), st.integers(0, 12))
def test_costs_that_are_no_whole_numbers_are_assigned_as_by_scipy(seed, rows, more):
    costs = np.random.default_rng(seed).normal(size=(rows, rows + more)) ** 3
    assert assigned(costs) == linear_sum_assignment(costs)[1].tolist()


def test_equal_costs_give_the_identity():
    assert assigned(np.ones((4, 6))) == [0, 1, 2, 3]


def test_room_that_was_used_before_is_as_good_as_new():
    room = Assignment.room(5, 7)
    random = np.random.default_rng(0)
    for rows, columns in ((5, 7), (2, 3), (5, 5), (1, 7)):
        costs = random.random((rows, columns))
        assert assigned(costs, room) == assigned(costs)
