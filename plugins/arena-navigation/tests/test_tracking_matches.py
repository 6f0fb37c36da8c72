from itertools import permutations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from arena_navigation.tracking.assignment import Assignment
from arena_navigation.tracking.matches import match_discs


def scene(seed, tracks, discs):
    random = np.random.default_rng(seed)
    states = np.column_stack((random.uniform(-2.0, 2.0, (tracks, 2)), np.zeros((tracks, 2))))
    covariances = np.tile(np.diag((0.05, 0.05, 1.0, 1.0)), (tracks, 1, 1))
    return (
        states,
        covariances,
        np.full(tracks, 0.2),
        random.uniform(-2.0, 2.0, (discs, 2)),
        np.tile(0.01 * np.eye(2), (discs, 1, 1)),
    )


def matched(states, covariances, radii, positions, noises, gate):
    matches = np.full(len(states), -2)
    room = Assignment.room(len(states), len(positions))
    match_discs((states, covariances, radii), (positions, noises), gate, room, matches)
    return matches


@settings(derandomize=True, deadline=None, max_examples=30)
@given(st.integers(0, 10**6), st.integers(0, 5), st.integers(0, 5))
def test_no_disc_is_given_twice_and_none_across_the_gate(seed, tracks, discs):
    states, covariances, radii, positions, noises = scene(seed, tracks, discs)
    matches = matched(states, covariances, radii, positions, noises, 9.2)
    taken = matches[matches >= 0]
    assert len(set(taken.tolist())) == len(taken)
    for k, m in enumerate(matches):
        if m >= 0:
            assert ((states[k, :2] - positions[m]) ** 2).sum() / 0.06 <= 9.2


@settings(derandomize=True, deadline=None, max_examples=30)
@given(st.integers(0, 10**6), st.integers(1, 5))
def test_the_assignment_is_the_nearest_in_sum(seed, count):
    states, covariances, radii, positions, noises = scene(seed, count, count)
    matches = matched(states, covariances, radii, positions, noises, 1e5)
    squared = ((states[:, None, :2] - positions) ** 2).sum(axis=2)
    best = min(squared[range(count), order].sum() for order in permutations(range(count)))
    assert np.isclose(squared[range(count), matches].sum(), best)


def test_a_disc_inside_a_body_is_its_own_however_sure_the_track_was():
    states, noises = np.zeros((1, 4)), 1e-6 * np.eye(2)[None]
    matches = matched(states, 1e-6 * np.eye(4)[None], np.array((0.3,)), np.array(((0.2, 0.0),)), noises, 9.2)
    assert matches.tolist() == [0]
    assert matched(states, 1e-6 * np.eye(4)[None], np.array((0.3,)), np.array(((0.4, 0.0),)), noises, 9.2).tolist() == [
        -1
    ]
