"""Who is near whom, and how bodies that overlap are pushed apart, against testing every pair."""

import math

import numpy as np
import pytest

from arena_kernels.neighbours import CELLS_FROM, all_pairs, near_pairs, pairs_by_cells
from arena_kernels.separation import body_overlap, push_apart

NO_ROOM = np.empty((0, 2), np.int32)


def by_hand(positions, reach):
    apart = np.hypot(*(positions[:, None] - positions).transpose(2, 0, 1))
    return [(i, j) for j in range(len(positions)) for i in range(j) if apart[i, j] < reach]


@pytest.mark.parametrize("spread", [0.5, 5.0, 4000.0])
@pytest.mark.parametrize("count", [1, 2, CELLS_FROM - 1, CELLS_FROM, 70])
@pytest.mark.parametrize("kernel", [all_pairs, pairs_by_cells, near_pairs])
def test_pairs_are_those_nearer_than_the_reach_by_the_later_then_the_earlier(kernel, count, spread):
    positions = np.random.default_rng(count).uniform(-spread, spread, (count, 2)) + np.array((3.0, -7.0))
    positions[count // 2] = positions[0] + 0.1
    pairs, found = kernel(positions, 1.5, NO_ROOM)
    assert [tuple(pair) for pair in pairs[:found].tolist()] == by_hand(positions, 1.5)


@pytest.mark.parametrize("kernel", [all_pairs, pairs_by_cells])
def test_a_person_at_the_reach_itself_is_not_near(kernel):
    positions = np.array([(0.0, 0.0), (2.0, 0.0), (0.0, 1.9), (2.0, 2.1)])
    pairs, found = kernel(positions, 2.0, NO_ROOM)
    assert pairs[:found].tolist() == [[0, 2]]


@pytest.mark.parametrize("kernel", [all_pairs, pairs_by_cells])
def test_who_is_nowhere_is_near_no_one(kernel):
    positions = np.array([(math.nan, math.nan), (1.0, 0.0), (1.0, 0.5), (math.nan, math.nan)])
    pairs, found = kernel(positions, 2.0, NO_ROOM)
    assert pairs[:found].tolist() == [[1, 2]]


def test_room_for_pairs_is_kept_where_it_is_large_enough():
    room = np.empty((9, 2), np.int32)
    positions = np.array([(0.0, 0.0), (1.0, 0.0)])
    assert all_pairs(positions, 2.0, room)[0] is room or np.shares_memory(all_pairs(positions, 2.0, room)[0], room)
    assert len(all_pairs(positions, 2.0, NO_ROOM)[0]) >= 1


def test_overlap_is_both_radii_less_the_distance_along_the_line_between():
    positions, radii = np.array([(1.0, 2.0), (1.3, 2.4), (1.0, 2.0), (1.0, 2.9)]), np.array((0.3, 0.4, 0.1, 0.5))
    assert body_overlap(positions, radii, 0, 1) == pytest.approx((0.2, 0.6, 0.8))
    assert body_overlap(positions, radii, 1, 0) == pytest.approx((0.2, -0.6, -0.8))
    assert body_overlap(positions, radii, 0, 2) == pytest.approx((0.4, 1.0, 0.0)), "one upon the other: along x"
    assert body_overlap(positions, radii, 0, 3) == (0.0, 0.0, 0.0)


def test_every_pair_shares_its_overlap_evenly_as_if_it_were_alone():
    positions, radii = np.array([(0.0, 0.0), (0.5, 0.0), (0.5, 0.8)]), np.array((0.4, 0.4, 0.6))
    pushes, pairs = np.full((3, 2), 9.0), np.array([(0, 1), (1, 2), (0, 2)], np.int32)
    assert push_apart(positions, radii, pairs, 3, pushes)
    first, second, third = 0.15, 0.1, 0.5 * (1.0 - math.hypot(0.5, 0.8))
    along = np.array((0.5, 0.8)) / math.hypot(0.5, 0.8)
    assert pushes[0] == pytest.approx((-first - third * along[0], -third * along[1]))
    assert pushes[1] == pytest.approx((first, -second))
    assert pushes[2] == pytest.approx((third * along[0], second + third * along[1]))


def test_bodies_that_only_touch_stay():
    pushes = np.full((2, 2), 9.0)
    positions, pairs = np.array([(0.0, 0.0), (1.0, 0.0)]), np.array([(0, 1)], np.int32)
    assert not push_apart(positions, np.array((0.5, 0.5)), pairs, 1, pushes)
    assert not push_apart(positions, np.array((0.9, 0.9)), pairs, 0, pushes), "only pairs that were found count"
