"""The critic of walls gives way in a passage to the room that the path leaves."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arena_kernels.costmap_window import outline_of, window_of
from arena_mppi.passage import AHEAD, KEPT, NEAR, eased_static, room_ahead
from arena_mppi.settings import Static

STATIC = Static(
    weight=2.0,
    inflation_radius=0.5,
    critical_cost=30.0,
    near_collision_gap=0.1,
    reaction_time=0.05,
    collision_gap=0.03,
    eased=True,
)
DISC = outline_of(None, 0.165, 0.165, 0.05)
PATH = np.column_stack((np.arange(-1.5, 2.0, 0.05), np.zeros(70), np.zeros(70)))


@pytest.mark.parametrize("room", [-0.1, 0.0, math.inf])
def test_outside_of_passages_nothing_gives_way(room):
    assert eased_static(STATIC, room) == STATIC


def test_nothing_gives_way_where_that_is_switched_off():
    assert eased_static(replace(STATIC, eased=False), 0.02) == replace(STATIC, eased=False)


def test_half_the_room_is_kept_and_the_weight_falls_with_its_square():
    eased = eased_static(STATIC, 0.04)
    assert eased.collision_gap == pytest.approx(KEPT * 0.04)
    assert eased.near_collision_gap == pytest.approx(NEAR * 0.04)
    assert eased.weight == pytest.approx(2.0 * 0.4**2)
    assert eased.reaction_time == pytest.approx(0.05 * 0.4**2)


@settings(derandomize=True, deadline=None, max_examples=100)
@given(st.floats(1e-4, 0.5), st.floats(1e-4, 0.5))
def test_more_room_asks_for_more_and_never_for_more_than_is_wanted(one, other):
    less, more = (eased_static(STATIC, room) for room in sorted((one, other)))
    for name in ("weight", "reaction_time", "near_collision_gap", "collision_gap"):
        assert 0.0 < getattr(less, name) <= getattr(more, name) <= getattr(STATIC, name)
    assert less.collision_gap < less.near_collision_gap


@pytest.mark.parametrize(("cells", "room"), [(7, 0.01), (9, 0.06), (11, math.inf)])
def test_room_is_looked_for_a_metre_ahead(cells, room, costmap):
    edge = 0.05 * (cells // 2) + 0.04
    window = window_of(costmap((0.0, 0.2, edge, 3.1), (0.0, 0.2, -3.1, -edge)))
    assert room_ahead(window, DISC, PATH, -0.9 * AHEAD, 0.0, 0.1) == pytest.approx(room, abs=1e-6)
    assert room_ahead(window, DISC, PATH, -1.4 * AHEAD, 0.0, 0.1) == math.inf
