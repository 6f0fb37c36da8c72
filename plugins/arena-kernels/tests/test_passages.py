"""How much room a path leaves, which gap a robot keeps, and how it gets away from a wall:
against closed forms and slow copies.
"""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arena_kernels.costmap_window import (
    CLOSE,
    NEARER,
    CostmapWindow,
    allowed_gap,
    close_gap,
    keeps_from_walls,
    outline_clearance,
    outline_of,
)
from arena_kernels.distance import distance_field
from arena_kernels.escape import ENOUGH, LOOK, STEPS, escape_command, escape_commands, keeps_gap
from arena_kernels.foreseen import Foreseen
from arena_kernels.passage import reduced_gap, room_along

RESOLUTION = 0.05
CELLS = 80  # the window reaches from -2 to 2 m
CIRCLE = outline_of(None, 0.15, 0.15, 0.05)
CORNERS = np.array(((0.21, -0.165), (0.21, 0.165), (-0.21, 0.165), (-0.21, -0.165)))
BOX = outline_of(CORNERS, float(np.hypot(*CORNERS[0])), 0.165, 0.05)
NOBODY = Foreseen.straight(np.empty((0, 2)), np.empty((0, 2))), np.empty(0)
GAP = st.floats(-0.1, 0.5)


def window(*boxes):
    """Return a window with lethal cells [first row, end row, first column, end column)."""
    lethal = np.zeros((CELLS, CELLS), np.bool_)
    for first_row, end_row, first_column, end_column in boxes:
        lethal[first_row:end_row, first_column:end_column] = True
    distance = distance_field(lethal, RESOLUTION).astype(np.float32)
    return CostmapWindow(np.where(lethal, 254, 0).astype(np.uint8), distance, RESOLUTION, -2.0, -2.0)


def gap(cells, first=40, depth=4):
    """Return a wall across the window, ``depth`` cells deep, with a gap of so many cells, and
    the height of the gap's middle, m.
    """
    return window((0, first, 40, 40 + depth), (first + cells, CELLS, 40, 40 + depth)), RESOLUTION * (
        first + 0.5 * cells
    ) - 2.0


def line(y, start=-1.5, end=1.5):
    xs = np.arange(start, end, 0.05)
    return np.column_stack((xs, np.full_like(xs, y), np.zeros_like(xs)))


def stand(x, y, theta=0.0):
    return x, y, math.cos(theta), math.sin(theta)


@pytest.mark.parametrize("cells", range(4, 16))
@pytest.mark.parametrize("outline", [CIRCLE, BOX], ids=["circle", "box"])
def test_room_in_a_gap_is_half_its_width_less_the_inscribed_radius(cells, outline):
    scene, middle = gap(cells)
    # the middle lies between two cells, which are as far as each other from the walls
    even = 0.5 * RESOLUTION * (cells % 2 == 0)
    exact = 0.5 * cells * RESOLUTION - even - outline.inscribed_radius
    assert room_along(scene, outline, line(middle), (-0.2, middle), 1.0) == pytest.approx(exact, abs=1e-6)


@settings(derandomize=True, deadline=None, max_examples=60)
@given(st.integers(4, 16), st.floats(-0.4, 0.4), st.sampled_from([0.0, 0.5]))
def test_room_beside_the_middle_is_what_is_left_on_the_nearer_side(cells, aside, cell):
    scene, middle = gap(cells)
    half = 0.5 * cells * RESOLUTION
    aside = cell * RESOLUTION if cell else aside * half  # edges and middles of cells too
    found = room_along(scene, CIRCLE, line(middle + aside), (-0.2, middle), 1.0)
    exact = half - abs(aside) - CIRCLE.inscribed_radius
    assert exact - 0.5 * RESOLUTION - 1e-6 <= found <= exact + 1e-6


def test_only_the_path_ahead_and_a_robots_length_behind_count():
    scene, middle = gap(7)
    narrow = 3.5 * RESOLUTION - CIRCLE.inscribed_radius
    path = line(middle)
    assert room_along(scene, CIRCLE, path, (-1.0, middle), 0.5) > narrow + 0.1  # the gap is 1 m ahead
    assert room_along(scene, CIRCLE, path, (-1.0, middle), 1.1) == pytest.approx(narrow)
    assert room_along(scene, CIRCLE, path, (0.25, middle), 0.5) == pytest.approx(narrow)  # its tail is still within
    assert room_along(scene, CIRCLE, path, (0.8, middle), 0.5) > narrow + 0.1


def test_room_is_negative_through_a_wall_and_infinite_where_nothing_is_known():
    scene, middle = gap(7)
    assert room_along(scene, CIRCLE, line(middle + 0.5), (-0.2, middle + 0.5), 1.0) < 0.0
    assert room_along(scene, CIRCLE, line(0.0, 3.0, 5.0), (3.0, 0.0), 1.0) == math.inf
    assert room_along(window(), CIRCLE, line(0.0), (0.0, 0.0), 1.0) == math.inf


@settings(derandomize=True, deadline=None, max_examples=200)
@given(st.floats(0.0, 0.5), GAP, GAP, st.floats(0.0, 1.0), st.floats(0.0, 0.1))
def test_what_is_asked_for_lies_between_the_least_and_what_is_wanted_and_grows_with_the_room(
    wanted, room, more, share, least
):
    asked = reduced_gap(wanted, room, share, least)
    assert min(wanted, least) <= asked <= wanted
    if 0.0 < room <= more:
        assert asked <= reduced_gap(wanted, more, share, least)
    if room <= 0.0:
        assert asked == wanted


def test_eased_in_numbers():
    assert reduced_gap(0.03, 0.02, 0.7, 0.005) == pytest.approx(0.014)
    assert reduced_gap(0.03, 0.001, 0.7, 0.005) == 0.005
    assert reduced_gap(0.03, 1.0, 0.7, 0.005) == 0.03
    assert reduced_gap(0.03, math.inf, 0.7, 0.005) == 0.03
    assert reduced_gap(0.03, -math.inf, 0.7, 0.005) == 0.03


@settings(derandomize=True, deadline=None, max_examples=300)
@given(GAP, GAP, st.floats(0.0, 0.3), st.floats(0.0, 0.3))
def test_allowed_gap_grows_with_the_present_one_and_with_what_is_wanted(now, later, wanted, other):
    assert allowed_gap(now, wanted, CLOSE) <= min(wanted, now)  # it asks for no more than there is
    assert allowed_gap(min(now, later), wanted, CLOSE) <= allowed_gap(max(now, later), wanted, CLOSE)
    assert allowed_gap(now, min(wanted, other), CLOSE) <= allowed_gap(now, max(wanted, other), CLOSE)


@pytest.mark.parametrize(
    ("now", "allowed"),
    [(1.0, 0.03), (0.05, 0.025), (0.03, CLOSE), (CLOSE, 0.018), (0.01, 0.009), (0.0, -NEARER), (-0.02, -0.02 - NEARER)],
)
def test_one_motion_uses_up_half_of_a_gap_and_close_to_a_wall_a_tenth(now, allowed):
    assert allowed_gap(now, 0.03, CLOSE) == pytest.approx(allowed)


def slow_keeps(outline, wall, now, then, wanted):
    """Hold an outline against a straight wall from height ``wall`` up, by the closed form of distance."""
    inner = [(0.0, 0.0, outline.inscribed_radius if len(outline.points_xy) else outline.radius)]
    points = inner + [(px, py, 0.0) for px, py in outline.points_xy]
    before, after = (
        [max(wall - (y + s * px + c * py), -0.5 * RESOLUTION) - radius for px, py, radius in points]
        for _, y, c, s in (now, then)
    )
    if min(before) > 0.0:
        return min(after) >= allowed_gap(min(before), wanted, CLOSE)
    return all(
        then >= wanted or then >= allowed_gap(now, wanted, CLOSE) for now, then in zip(before, after, strict=True)
    )


@settings(derandomize=True, deadline=None, max_examples=300)
@given(
    st.booleans(),
    st.floats(0.17, 0.3),
    st.floats(-0.4, 0.4),
    st.floats(-0.05, 0.05),
    st.floats(-0.4, 0.4),
    st.floats(0.0, 0.1),
)
def test_an_outline_is_held_against_where_it_was_and_point_by_point_where_it_touches(
    box, down, theta, rise, turn, wanted
):
    outline = BOX if box else CIRCLE
    now, then = stand(0.0, 0.2 - down, theta), stand(0.05, 0.2 - down + rise, theta + turn)
    wall = 0.2  # the row from 0.2 m up
    found = keeps_from_walls(window((44, CELLS, 0, CELLS)), outline, now, then, wanted, CLOSE)
    nearly = {
        slow_keeps(outline, wall + shift, now, then, wanted + extra)
        for shift in (-1e-5, 1e-5)
        for extra in (-1e-5, 1e-5)
    }
    assert found in nearly


def test_a_robot_beside_a_wall_may_drive_along_and_away_but_not_swing_its_tail_into_it():
    scene = window((44, CELLS, 0, CELLS))  # 3.5 cm to the left of the robot's side
    here = stand(0.0, 0.0)
    assert keeps_from_walls(scene, BOX, here, stand(0.1, 0.0), 0.05, CLOSE)
    assert keeps_from_walls(scene, BOX, here, stand(0.1, -0.05), 0.05, CLOSE)
    # its rear left corner comes 3 cm nearer
    assert not keeps_from_walls(scene, BOX, here, stand(0.0, 0.0, -0.2), 0.05, CLOSE)
    assert not keeps_from_walls(scene, BOX, here, stand(0.0, 0.0, 0.2), 0.05, CLOSE)  # its front one
    # with 10 cm more there is room
    assert keeps_from_walls(scene, BOX, stand(0.0, -0.1), stand(0.0, -0.1, -0.2), 0.05, CLOSE)


def test_a_mark_of_noise_at_one_corner_allows_no_other_corner_to_come_near():
    noise = (36, 37, 44, 45)  # at the front right corner
    wall = (44, CELLS, 0, CELLS)
    here, swing = stand(0.0, 0.0), stand(-0.02, 0.0, -0.2)
    assert outline_clearance(window(noise), BOX, here, 1.0) <= 0.0
    assert keeps_from_walls(window(noise), BOX, here, swing, 0.05, CLOSE)  # it turns away from the mark
    assert not keeps_from_walls(window(noise, wall), BOX, here, swing, 0.05, CLOSE)
    assert keeps_from_walls(window(noise, wall), BOX, here, stand(-0.1, 0.0), 0.05, CLOSE)


def test_room_of_a_car_is_that_beside_its_sides():
    car = outline_of(CORNERS + np.array((0.131, 0.0)), float(np.hypot(0.341, 0.165)), 0.079, 0.05)
    scene, middle = gap(9)
    path = line(middle)
    assert room_along(scene, car, path, (0.0, middle), 0.5) == room_along(scene, BOX, path, (0.0, middle), 0.5)


def test_a_car_may_use_up_a_gap_by_halves_and_others_come_no_nearer_than_close():
    assert close_gap(0.0) == CLOSE
    assert close_gap(0.48) == 0.0
    assert allowed_gap(0.025, 0.03, close_gap(0.0)) == pytest.approx(CLOSE)
    assert allowed_gap(0.025, 0.03, close_gap(0.48)) == pytest.approx(0.0125)


def test_beyond_the_window_all_is_free():
    assert keeps_from_walls(window((0, CELLS, 0, CELLS)), BOX, stand(3.0, 0.0), stand(3.1, 0.0), 0.1, CLOSE)
    assert keeps_from_walls(window(), BOX, stand(0.0, 0.0), stand(0.1, 0.0), 0.1, CLOSE)


@pytest.mark.parametrize(
    ("command", "kept"), [((0.3, 0.0, 0.0), True), ((0.3, 0.0, -1.0), False), ((0.3, 0.0, 1.0), False)]
)
def test_what_is_driven_keeps_its_gap_until_it_has_stopped_turning(command, kept):
    scene = window((44, CELLS, 0, CELLS))
    assert keeps_gap(scene, BOX, np.zeros(3), np.array(command), 0.1, 2.0, 0.03, CLOSE) == kept
    assert keeps_gap(scene, BOX, np.array((0.0, -0.3, 0.0)), np.array(command), 0.1, 2.0, 0.03, CLOSE)


def slow_escape(scene, outline, start, people, commands, wanted):
    """Return the row of the best arc in plain Python, None if none is worth its while."""
    here = outline_clearance(scene, outline, stand(*start), ENOUGH)
    best, chosen, least = here + 0.005, None, allowed_gap(here, wanted, CLOSE)
    for row, (vx, vy, wz) in enumerate(commands):
        x, y, theta = start
        gaps = []
        for step in range(1, STEPS + 1):
            dt = LOOK / STEPS
            middle = theta + 0.5 * dt * wz
            x, y = (
                x + dt * (vx * math.cos(middle) - vy * math.sin(middle)),
                y + dt * (vx * math.sin(middle) + vy * math.cos(middle)),
            )
            theta += dt * wz
            away = [
                np.hypot(*(np.add(p, step * dt * np.array(v)) - (x, y))) - r - outline.radius
                for p, v, r in zip(*people, strict=True)
            ]
            gaps.append(min([outline_clearance(scene, outline, stand(x, y, theta), ENOUGH), *away]))
        if min(gaps) >= least and min(gaps[-1], ENOUGH) > best:
            best, chosen = min(gaps[-1], ENOUGH), row
    return chosen


@settings(derandomize=True, deadline=None, max_examples=60)
@given(st.integers(0, 10**6), st.booleans(), st.sampled_from([0.0, 0.4]), st.booleans())
def test_the_arc_that_is_driven_ends_with_most_room(seed, box, turn_radius, holonomic):
    random = np.random.default_rng(seed)
    places = random.integers(25, 55, (12, 2))
    scene = window(
        *((row, row + 3, column, column + 3) for row, column in places if max(abs(row - 39), abs(column - 39)) > 5)
    )
    outline = BOX if box else CIRCLE
    people = random.uniform(-1.5, 1.5, (2, 2)), random.uniform(-0.5, 0.5, (2, 2)), np.full(2, 0.3)
    foreseen = Foreseen.straight(*people[:2]), people[2]
    commands = escape_commands(
        np.array((-0.5, -0.3, -1.5)), np.array((1.0, 0.3, 1.5)), 0.3, turn_radius, holonomic=holonomic
    )
    start = np.array((*random.uniform(-0.1, 0.1, 2), random.uniform(-3.0, 3.0)))
    found = escape_command(start, scene, outline, *foreseen, commands, 0.02)
    chosen = slow_escape(scene, outline, start.tolist(), people, commands, 0.02)
    expected = np.empty((0, 3)) if chosen is None else commands[[chosen]]
    assert found.tolist() == expected.tolist()


def test_a_robot_that_faces_a_wall_backs_away_unless_somebody_walks_up_behind_it():
    scene = window((0, CELLS, 45, CELLS))  # 4 cm before its nose
    commands = escape_commands(np.array((-0.5, 0.0, -1.0)), np.array((0.5, 0.0, 1.0)), 0.3, 0.4, holonomic=False)
    alone = escape_command(np.zeros(3), scene, BOX, *NOBODY, commands, 0.02)
    assert alone[0, 0] < 0.0
    behind = Foreseen.straight(np.array(((-1.0, 0.0),)), np.array(((0.5, 0.0),))), np.array((0.3,))
    assert len(escape_command(np.zeros(3), scene, BOX, *behind, commands, 0.02)) == 0


def test_where_there_is_room_enough_there_is_nothing_to_get_away_from():
    commands = escape_commands(np.array((-0.5, 0.0, -1.0)), np.array((0.5, 0.0, 1.0)), 0.3, 0.0, holonomic=False)
    assert len(escape_command(np.zeros(3), window((0, CELLS, 70, CELLS)), BOX, *NOBODY, commands, 0.02)) == 0


@pytest.mark.parametrize(("turn_radius", "holonomic"), [(0.0, False), (0.0, True), (0.6, False)])
def test_ways_out_are_slow_and_such_as_the_robot_can_drive(turn_radius, holonomic):
    least, most = np.array((-0.5, -0.4, -3.0)), np.array((1.0, 0.4, 3.0))
    commands = escape_commands(least, most, 0.3, turn_radius, holonomic=holonomic)
    assert (commands[:, 0] >= 0.3 * least[0]).all()
    assert (commands[:, 0] <= 0.3 * most[0]).all()
    assert (np.abs(commands[:, 2]) <= 1.0).all()
    assert (commands[:, 1] != 0.0).any() == holonomic
    assert (commands[:, 0] == 0.0).any() == (turn_radius == 0.0)
    assert (np.abs(commands[:, 2]) * turn_radius <= np.abs(commands[:, 0]) + 1e-12).all()
    assert commands[:, 0].min() < 0.0 < commands[:, 0].max()
