import math

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from arena_core import Costmap, Footprint
from arena_kernels.costmap_window import (
    LETHAL,
    CostmapWindow,
    distance_at,
    footprint_outline,
    outline_clearance,
    outline_of,
    points_along,
    window_of,
    without_discs,
)
from arena_kernels.distance import distance_field

BOX = np.array([[0.21, -0.165], [0.21, 0.165], [-0.21, 0.165], [-0.21, -0.165]])
PLACES = st.floats(-1.7, 1.7)  # the whole outline lies in the window of 4 m


def window_with(*cells, side=80, resolution=0.05):
    costs = np.zeros((side, side), np.uint8)
    for row, column in cells:
        costs[row, column] = LETHAL
    half = -0.5 * side * resolution
    return CostmapWindow(costs, distance_field(costs >= LETHAL, resolution), resolution, half, half)


def test_distance_is_that_to_the_edge_of_the_cell():
    window = window_with((40, 60))
    assert math.isclose(distance_at(window, 0.525, 0.025), 0.475, abs_tol=1e-6)


def test_outside_the_window_nothing_is_free_and_an_empty_one_is_free_for_ever():
    assert distance_at(window_with((40, 60)), 2.01, 0.0) == -math.inf
    assert distance_at(window_with(), 0.0, 0.0) == math.inf


@settings(derandomize=True, deadline=None)
@given(PLACES, PLACES, st.floats(-math.pi, math.pi), st.lists(st.tuples(st.integers(0, 79), st.integers(0, 79))))
def test_clearance_of_a_polygon_is_the_least_over_its_outline_and_middle(x, y, theta, cells):
    window, outline = window_with(*cells), outline_of(BOX, math.hypot(0.21, 0.165), 0.165, 0.05)
    c, s = math.cos(theta), math.sin(theta)
    points = outline.points_xy @ np.array(((c, s), (-s, c))) + (x, y)
    plain = min([distance_at(window, x, y) - 0.165, *(distance_at(window, px, py) for px, py in points)])
    assert math.isclose(outline_clearance(window, outline, (x, y, c, s), math.inf), plain, abs_tol=1e-9)
    assert min(outline_clearance(window, outline, (x, y, c, s), 0.1), 0.1) <= plain + 1e-9


@settings(derandomize=True, deadline=None)
@given(
    st.lists(st.tuples(st.floats(-2.5, 2.5), st.floats(-2.5, 2.5), st.floats(0.0, 0.5)), max_size=4),
    st.integers(0, 2**32 - 1),
)
def test_no_cell_of_a_moving_disc_stays_and_every_other_does(discs, seed):
    blocked = np.random.default_rng(seed).random((80, 80)) < 0.05
    window = window_with(*np.argwhere(blocked))
    table = np.array(discs).reshape(-1, 3)
    standing = without_discs(window, table[:, :2], table[:, 2], 0.1)
    centres = (np.indices((80, 80))[::-1].transpose(1, 2, 0) + 0.5) * 0.05 - 2.0
    gaps = np.array([np.hypot(*(centres - d[:2]).transpose(2, 0, 1)) - d[2] - 0.1 for d in table]).reshape(-1, 80, 80)
    lethal = standing.costs >= LETHAL
    assert not (lethal & (gaps < 0.5 * 0.05).any(axis=0)).any()
    assert (lethal == blocked)[(gaps > 0.04).all(axis=0)].all()
    assert (standing.distance == distance_field(lethal, 0.05)).all()
    assert (window.costs[blocked] == LETHAL).all()


def test_outline_points_lie_on_the_edges_without_gaps():
    points = points_along(BOX, 0.05)
    on_edge = np.isclose(np.abs(points[:, 0]), 0.21) | np.isclose(np.abs(points[:, 1]), 0.165)
    assert on_edge.all()
    assert (np.hypot(*(np.roll(points, -1, axis=0) - points).T) <= 0.05 + 1e-9).all()


def test_a_costmap_becomes_the_window_that_holds_its_arrays():
    plain = window_with((40, 60))
    window = window_of(
        Costmap(plain.costs, plain.distance, plain.resolution, np.array((plain.origin_x, plain.origin_y)))
    )
    assert window.costs is plain.costs
    assert window.distance is plain.distance
    assert window[2:] == plain[2:]


def test_a_footprint_becomes_an_outline_without_gaps_of_a_cell_or_a_circle():
    box, disc = footprint_outline(Footprint.polygon(BOX.tolist())), footprint_outline(Footprint.circle(0.2))
    gaps = np.hypot(*(box.points_xy - np.roll(box.points_xy, 1, axis=0)).T)
    assert gaps.max() <= 0.05 + 1e-12
    assert (disc.radius, len(disc.points_xy)) == (0.2, 0)
