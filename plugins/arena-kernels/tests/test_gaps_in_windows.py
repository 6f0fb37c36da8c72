"""Gaps of outlines in a window, and how much of a gap a motion may use up, worked out by hand."""

import math

import numpy as np
import pytest

from arena_kernels.costmap_window import (
    CostmapWindow,
    allowed_gap,
    close_gap,
    distance_at,
    keeps_from_walls,
    outline_clearance,
    outline_of,
    points_along,
    without_discs,
)
from arena_kernels.escape import escape_command, escape_commands, keeps_gap
from arena_kernels.foreseen import Foreseen
from arena_kernels.passage import half_width, reduced_gap, room_along

# 4 m by 4 m; the column of cells at x = 3.05 m is lethal: its edge is at x = 3 m, distances fall with x
CENTRES = (np.arange(40) + 0.5) * 0.1
FIELD = np.tile(np.abs(3.05 - CENTRES), (40, 1)).astype(np.float32)
WALL = CostmapWindow(np.where(FIELD < 0.01, 254, 0).astype(np.uint8), FIELD, 0.1, 0.0, 0.0)
OPEN = WALL._replace(costs=np.zeros((40, 40), np.uint8), distance=np.full((40, 40), np.inf, np.float32))
DISC = outline_of(None, 0.2, 0.2, 0.05)
BOX = outline_of(np.array([(0.4, -0.2), (0.4, 0.2), (-0.4, 0.2), (-0.4, -0.2)]), math.hypot(0.4, 0.2), 0.2, 0.05)
AHEAD, BESIDE = (1.0, 0.0), (0.0, 1.0)  # cosine and sine of headings


def test_distances_are_to_the_edge_of_the_nearest_cell_and_interpolated():
    assert distance_at(WALL, 2.0, 2.0) == pytest.approx(1.0, abs=1e-6)
    assert distance_at(WALL, 2.234, 1.777) == pytest.approx(0.766, abs=1e-6)
    assert distance_at(WALL, 0.0, 0.0) == pytest.approx(2.95, abs=1e-6), "as far as the first cell's centre"
    assert distance_at(WALL, 3.92, 3.99) == pytest.approx(0.82, abs=1e-6)
    assert distance_at(WALL, 3.99, 3.92) == pytest.approx(0.85, abs=1e-6), "as far as the last one's"
    assert distance_at(WALL, -0.01, 2.0) == distance_at(WALL, 2.0, 4.01) == -math.inf
    assert distance_at(OPEN, 2.0, 2.0) == math.inf
    slope = WALL._replace(distance=(FIELD + 2.0 * CENTRES[:, None]).astype(np.float32))
    assert distance_at(slope, 1.0, 1.23) == pytest.approx(2.0 + 2.0 * 1.23, abs=1e-5)


@pytest.mark.parametrize(("heading", "gap"), [(AHEAD, 0.6), (BESIDE, 0.8)])
def test_clearance_of_a_box_is_that_of_its_nearest_side(heading, gap):
    assert outline_clearance(WALL, BOX, (2.0, 2.0, *heading), 9.0) == pytest.approx(gap, abs=1e-6)
    assert outline_clearance(WALL, DISC, (2.0, 2.0, *heading), 9.0) == pytest.approx(0.8, abs=1e-6)
    rough = outline_clearance(WALL, BOX, (1.0, 2.0, *heading), 0.5)
    assert rough == pytest.approx(2.0 - math.hypot(0.4, 0.2), abs=1e-6), "far off a lower bound will do"


@pytest.mark.parametrize(("enough", "gap"), [(1.3, 1.5), (1.25, 1.5), (1.2, 1.25)])
def test_only_beyond_enough_a_lower_bound_will_do(enough, gap):
    """1.75 m to the nearest edge from everywhere: 1.5 m beside the inner circle, 1.25 m beside the outer one."""
    even = CostmapWindow(np.zeros((8, 8), np.uint8), np.full((8, 8), 2.0, np.float32), 0.5, 0.0, 0.0)
    box = outline_of(np.array([(0.5, -0.25), (0.5, 0.25), (-0.5, 0.25), (-0.5, -0.25)]), 0.5, 0.25, 0.05)
    assert outline_clearance(even, box, (2.0, 2.0, *AHEAD), enough) == gap


def test_points_lie_along_the_edges_no_farther_apart_than_asked():
    points = points_along(np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 0.3)]), 0.4)
    assert points.shape == (3 + 1 + 3, 2)
    assert points[:4].ravel() == pytest.approx((0.0, 0.0, 1.0 / 3.0, 0.0, 2.0 / 3.0, 0.0, 1.0, 0.0))


@pytest.mark.parametrize(
    ("now", "wanted", "close", "allowed"),
    [
        (1.0, 0.2, 0.02, 0.2),
        (0.3, 0.2, 0.02, 0.15),
        (0.03, 0.2, 0.02, 0.02),
        (0.01, 0.2, 0.02, 0.009),
        (0.01, 0.2, 0.0, 0.005),
        (0.0, 0.2, 0.02, -0.005),
        (-0.1, 0.2, 0.02, -0.105),
        (-0.1, -0.3, 0.02, -0.3),
    ],
)
def test_a_motion_may_use_up_half_of_a_gap(now, wanted, close, allowed):
    assert allowed_gap(now, wanted, close) == pytest.approx(allowed)


def test_only_a_car_may_come_nearer_than_two_centimetres():
    assert (close_gap(0.0), close_gap(0.4)) == (0.02, 0.0)


def keeps(outline, now, then, wanted=0.2, close=0.02, heading=AHEAD):
    return keeps_from_walls(WALL, outline, (now, 2.0, *heading), (then, 2.0, *heading), wanted, close)


@pytest.mark.parametrize(
    ("now", "then", "kept"),
    [
        (2.0, 2.59, True),
        (2.0, 2.61, False),
        (2.5, 2.64, True),
        (2.5, 2.66, False),
        (2.9, 2.904, True),
        (2.9, 2.906, False),
    ],
)
def test_a_disc_keeps_the_gap_or_half_of_what_it_has(now, then, kept):
    """Its middle 0.2 m nearer than its edge: gaps of 0.8, 0.3 and -0.1 m now."""
    assert keeps(DISC, now, then) == kept


@pytest.mark.parametrize(("then", "kept"), [(2.624, True), (2.626, False), (2.6, True)])
def test_a_box_that_touches_is_judged_point_by_point(then, kept):
    """Its front lies 0.02 m in the wall, and may come 0.005 m nearer."""
    assert keeps(BOX, 2.62, then) == kept


def test_what_leaves_the_window_keeps_its_gap():
    assert keeps(DISC, 2.0, -0.5)


def test_cells_that_a_disc_touches_are_taken_out_and_distances_made_again():
    cells = np.zeros((40, 40), np.uint8)
    cells[20, 10:13] = 254
    window = WALL._replace(costs=cells)
    at = np.array([(1.05, 2.05)])  # the centre of column 10
    assert (without_discs(window, at, np.array((0.1,)), 0.0).costs >= 254).sum() == 1
    assert (without_discs(window, at, np.array((0.02,)), 0.0).costs >= 254).sum() == 2
    assert (without_discs(window, at, np.array((0.02,)), 0.08).costs >= 254).sum() == 1
    left = without_discs(window, at, np.array((0.1,)), 0.0)
    assert left.distance[20, 10] == pytest.approx(0.2)
    assert without_discs(window, np.array([(3.5, 3.5)]), np.array((0.1,)), 0.0) is window
    assert without_discs(window, np.empty((0, 2)), np.empty(0), 0.0) is window


NOBODY = Foreseen.straight(np.empty((0, 2)), np.empty((0, 2))), np.empty(0)


def escaped(x, *commands, people=NOBODY, wanted=0.05):
    found = escape_command(np.array((x, 2.0, 0.0)), WALL, DISC, *people, np.array(commands, float), wanted)
    return found.tolist()


BACK, SLOWER, ON, TURN = (-0.2, 0.0, 0.0), (-0.1, 0.0, 0.0), (0.2, 0.0, 0.0), (0.0, 0.0, 0.5)


def test_the_arc_that_ends_with_most_room_is_driven():
    assert escaped(2.7, ON, SLOWER, BACK, TURN) == [list(BACK)]
    assert escaped(2.7, SLOWER, TURN) == [list(SLOWER)]
    assert escaped(2.7, TURN, ON) == [], "none gives more room"


def test_more_room_than_enough_is_worth_nothing():
    assert escaped(2.4, SLOWER, BACK) == [list(SLOWER)] or escaped(2.4, SLOWER, BACK) == []
    assert escaped(2.55, SLOWER, BACK) == [list(SLOWER)], "0.25 m: either ends with 0.3 m or more"


def test_an_arc_that_comes_too_near_on_the_way_is_not_driven():
    """Out of the wall's way past a person: 0.45 m between middles where 0.2 and 0.2 m meet, and 0.05 m are wanted."""
    person = Foreseen.straight(np.array([(2.2, 2.0)]), np.array([(0.0, 0.0)])), np.array((0.2,))
    assert escaped(2.7, BACK, people=person) == []
    leaving = Foreseen.straight(np.array([(2.2, 2.0)]), np.array([(-0.3, 0.0)])), person[1]
    assert escaped(2.7, BACK, people=leaving) == [list(BACK)]


def test_slow_commands_lead_wherever_the_robot_can_move():
    least, most = np.array((-0.4, -0.2, -2.0)), np.array((1.0, 0.2, 2.0))
    plain = escape_commands(least, most, 0.5, 0.0, holonomic=False)
    assert sorted(set(plain[:, 0])) == [-0.2, -0.1, 0.0, 0.25, 0.5]
    assert sorted(set(plain[:, 2])) == [-1.0, -0.5, 0.0, 0.5, 1.0]
    assert (len(plain), set(plain[:, 1])) == (25, {0.0})
    sideways = escape_commands(least, most, 0.5, 0.0, holonomic=True)
    assert len(sideways) == 31
    assert sorted(set(sideways[25:, 1])) == [-0.1, 0.1]
    car = escape_commands(least, most, 0.5, 0.8, holonomic=False)
    assert len(car) == 10
    assert np.abs(car[:, 2]).max() == pytest.approx(0.5 / 0.8)
    assert (np.abs(car[:, 2]) <= np.abs(car[:, 0]) / 0.8 + 1e-12).all()


@pytest.mark.parametrize(("speed", "kept"), [(0.59, True), (0.61, False), (-0.5, True)])
def test_a_gap_is_kept_for_a_time(speed, kept):
    """From 0.8 m to the 0.2 m that is wanted in one second."""
    pose, velocity = np.array((2.0, 2.0, 0.0)), np.array((speed, 0.0, 0.0))
    assert keeps_gap(WALL, DISC, pose, velocity, 1.0, 1.0, 0.2, 0.02) == kept


def test_a_polygon_keeps_its_gap_until_it_has_stopped_turning():
    """A box along the wall, 0.3 m off: a quarter turn would bring its front 0.1 m near; half of it is allowed."""
    pose, turning = np.array((2.5, 2.0, 0.5 * math.pi)), np.array((0.0, 0.0, -1.0))
    assert keeps_gap(WALL, BOX, pose, turning, 0.3, 100.0, 0.2, 0.02)
    assert not keeps_gap(WALL, BOX, pose, turning, 0.3, 0.5, 0.2, 0.02)


def room(ahead, path_x, x, outline=DISC, y=2.0):
    path = np.array([(of, y, 0.0) for of in path_x], float)
    return room_along(WALL, outline, path, (x, y), ahead)


def test_room_along_a_path_is_the_least_from_a_length_behind_to_so_far_ahead():
    way = np.arange(0.5, 2.9, 0.1)
    assert room(0.55, way, 1.0) == pytest.approx(3.0 - 1.5 - 0.2, abs=1e-5)
    wide = outline_of(None, 0.25, 0.25, 0.05)
    assert room(0.55, way[::-1], 1.0, wide) == pytest.approx(3.0 - 1.3 - 0.25, abs=1e-5), "0.3 m behind"
    quarters = np.arange(0.5, 2.9, 0.25)
    assert room(0.5, quarters, 1.0) == pytest.approx(3.0 - 1.5 - 0.2, abs=1e-5), "the point at 0.5 m itself counts"
    slanted = np.array([(2.5 - 0.3 * k, 1.0 + 0.4 * k, 0.0) for k in range(5)])  # 0.5 m apart
    found = room_along(WALL, outline_of(None, 0.45, 0.45, 0.05), slanted, (1.6, 2.2), 0.1)
    assert found == pytest.approx(3.0 - 1.9 - 0.45, abs=1e-5), "one point behind is 0.5 m of path"
    found = room_along(WALL, outline_of(None, 0.6, 0.6, 0.05), slanted, (1.6, 2.2), 0.1)
    assert found == pytest.approx(3.0 - 2.2 - 0.6, abs=1e-5), "and two 1 m"
    assert room(9.0, [-2.0, -1.0], -1.0) == math.inf, "beyond the window nothing is known"


def test_a_box_is_as_wide_as_its_sides():
    assert half_width(BOX) == 0.2
    assert half_width(DISC) == 0.2
    assert half_width(BOX._replace(points_xy=BOX.points_xy * (1.0, 2.0))) == 0.4


@pytest.mark.parametrize(
    ("room_left", "kept"), [(1.0, 0.3), (0.4, 0.28), (0.1, 0.07), (0.05, 0.05), (0.0, 0.3), (-0.2, 0.3)]
)
def test_in_a_passage_a_share_of_the_room_is_kept(room_left, kept):
    assert reduced_gap(0.3, room_left, 0.7, 0.05) == pytest.approx(kept)
