"""Bodies before a straight wall, whose distances can be worked out by hand."""

import math

import numpy as np
import pytest

from arena_kernels.ground import Ground, clearance_and_gradient, in_cells, in_map, wall_clearance
from arena_kernels.line_of_sight import COLUMNS, LENGTH, NEEDED, SEEN, check_sight_lines, put_sight_line
from arena_kernels.slide_along import SIGHT, is_visible, slide_along

CELL = 0.1
ROWS = np.arange(60)
# 6 m by 6 m at (1, 2), turned by 30 degrees; the lowest row of cells is a wall: distances grow with the row
TURN = math.radians(30.0)
COSINE, SINE = math.cos(TURN), math.sin(TURN)
BEFORE_WALL = Ground(np.repeat(ROWS[:, None] * CELL, 60, axis=1).astype(np.float32), 1.0, 2.0, COSINE, SINE, CELL)
OPEN = BEFORE_WALL._replace(field=np.full((60, 60), np.inf, np.float32))


def at(u, v):
    """Return in ``map`` what lies u m along the wall and v m before its surface, which is 0.1 m from the edge."""
    return 1.0 + COSINE * u - SINE * (v + CELL), 2.0 + SINE * u + COSINE * (v + CELL)


def along(x, y):
    """Return how far along the wall and before it a position of ``map`` is, m."""
    return COSINE * (x - 1.0) + SINE * (y - 2.0), COSINE * (y - 2.0) - SINE * (x - 1.0) - CELL


def test_positions_are_cells_of_the_turned_grid_and_back():
    row, column = in_cells(BEFORE_WALL, *at(2.0, 1.5))
    assert (row, column) == pytest.approx((16.0, 20.0))
    assert in_map(BEFORE_WALL, row, column) == pytest.approx(at(2.0, 1.5))


@pytest.mark.parametrize("v", [0.01, 0.2, 1.234, 5.0])
def test_clearance_is_the_distance_to_the_walls_surface_and_its_gradient_leads_away(v):
    distance, gx, gy = clearance_and_gradient(BEFORE_WALL, *at(3.0, v))
    assert (distance, gx, gy) == pytest.approx((v, -SINE, COSINE), abs=1e-5)
    assert wall_clearance(BEFORE_WALL, *at(3.0, v)) == distance


def test_clearance_beyond_the_grid_is_that_of_its_nearest_place_and_without_walls_infinite():
    assert wall_clearance(BEFORE_WALL, *at(-3.0, 9.0)) == pytest.approx(5.9 - 0.05, abs=1e-5)
    assert wall_clearance(BEFORE_WALL, *at(9.0, 1.0)) == pytest.approx(1.0, abs=1e-5)
    assert wall_clearance(BEFORE_WALL, *at(3.0, -9.0)) == pytest.approx(-0.05, abs=1e-5)
    assert clearance_and_gradient(OPEN, *at(3.0, 1.0)) == (math.inf, 0.0, 0.0)


def test_a_gradient_has_both_parts_between_four_cells():
    field = np.array(((0.1, 0.4), (0.3, 1.0)), np.float32)
    ground = Ground(field, 0.0, 0.0, 1.0, 0.0, 0.5)
    found = clearance_and_gradient(ground, 0.25 + 0.125, 0.25 + 0.25)  # a quarter to the right, half the way up
    below, above = 0.1 + 0.25 * 0.3, 0.3 + 0.25 * 0.7
    by_hand = 0.5 * (below + above) - 0.25, 0.5 * (0.3 + 0.7) / 0.5, (above - below) / 0.5
    assert found == pytest.approx(by_hand, abs=1e-6)


def moved(start, du, dv, radius=0.3, ground=BEFORE_WALL):
    dx, dy = COSINE * du - SINE * dv, SINE * du + COSINE * dv
    return along(*slide_along(ground, (*at(*start), radius), dx, dy))


def test_a_body_away_from_walls_goes_where_it_moves():
    assert moved((2.0, 2.0), 0.7, -0.9) == pytest.approx((2.7, 1.1))
    assert moved((2.0, 0.5), 0.3, -0.4, ground=OPEN) == pytest.approx((2.3, 0.1))


@pytest.mark.parametrize("dv", [-0.3, -1.0, -4.0])
def test_a_body_slides_along_a_wall_at_its_radius(dv):
    assert moved((1.0, 0.5), 2.0, dv) == pytest.approx((3.0, 0.3), abs=1e-4)


def test_a_body_that_is_nearer_than_its_radius_comes_no_nearer_and_can_leave():
    assert moved((2.0, 0.2), 0.0, -0.1)[1] >= 0.2 - 1e-6
    assert moved((2.0, 0.2), 0.0, 0.05)[1] >= 0.25 - 1e-6


def test_pushes_stop_where_nothing_leads_away():
    """In a place that is as near to walls everywhere a body stays: there is no way out."""
    flat = BEFORE_WALL._replace(field=np.full((60, 60), 0.2, np.float32))
    assert moved((2.0, 2.0), 0.1, 0.0, ground=flat) == pytest.approx((2.1, 2.0))


def seen(ground, start, end, room):
    """Return what both kernels say of a straight way, which is the same."""
    line = (*at(*start), *at(*end))
    sights = np.zeros((3, COLUMNS))
    put_sight_line(ground, sights[1], line, room)
    put_sight_line(ground, sights[2], (*at(1.0, 3.0), *at(2.0, 3.0)), 0.1)
    check_sight_lines(ground, sights[1:], 2, np.zeros(3, np.int32))
    assert sights[2, SEEN] == 1.0
    assert is_visible(ground, line, room) == (sights[1, SEEN] == 1.0)
    return is_visible(ground, line, room)


def with_pillar():
    """Return the ground with a pillar of one cell, column 30 in row 20: 2.0 m before the wall's surface."""
    far = np.hypot(np.arange(60)[None, :] - 30, ROWS[:, None] - 20) * CELL
    return BEFORE_WALL._replace(field=np.minimum(BEFORE_WALL.field, far).astype(np.float32))


@pytest.mark.parametrize(
    ("beside", "room", "free"), [(0.5, 0.4, True), (0.5, 0.5, False), (0.3, 0.2, True), (0.0, 0.2, False)]
)
def test_a_straight_way_is_free_with_room_on_both_sides(beside, room, free):
    """Past the middle of the pillar, half a cell off which its surface is."""
    middle = 1.95
    assert seen(with_pillar(), (1.0, middle + beside), (5.0, middle + beside), room) == free
    assert seen(with_pillar(), (5.0, middle - beside), (1.0, middle - beside), room) == free


def test_ends_that_have_less_room_ask_for_less():
    assert seen(BEFORE_WALL, (1.0, 0.2), (5.0, 0.2), 0.5), "0.9 of the 0.2 m at both ends"
    assert not seen(BEFORE_WALL, (1.0, 0.2), (5.0, -0.01), 0.5), "the end lies in the wall"
    sight = np.zeros(COLUMNS)
    put_sight_line(BEFORE_WALL, sight, (*at(1.0, 0.2), *at(1.0, 2.2)), 0.5)
    assert (sight[LENGTH], sight[NEEDED]) == pytest.approx((2.0, SIGHT * 0.2), abs=1e-4)


def test_no_way_is_always_free():
    assert seen(BEFORE_WALL, (1.0, 1.0), (1.0, 1.0), 0.5)
