import dataclasses
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arena_core import NO_TRACKS, Footprint
from arena_core.testing import tracked
from arena_kernels.costmap_window import CostmapWindow, footprint_outline
from arena_kernels.distance import distance_field
from arena_kernels.foreseen import Foreseen
from arena_mpc.corridor import FREE, boundary_cells, half_planes
from arena_mpc.detours import path_detours
from arena_mpc.footprint import Discs, free_until
from arena_mpc.guess import drive_along, shift_plan
from arena_mpc.interior_point import compiled_problem, has_solver
from arena_mpc.moving import FAR, first_hit, relevant_movers
from arena_mpc.parameters import Grid, SolverSettings
from arena_mpc.plan import Plan
from arena_mpc.problem import Shape, formulate_problem
from arena_mpc.reference import PathProgress, free_poses, local_reference, nearest_path_points
from arena_mpc.resizing import reachable_sizes, resize_grid
from arena_mpc.scene import Scene

GRID = Grid(20, 10, 30, 5, 0.2, 0.02, 0.5, 0.1, 1)
STRAIGHT = np.column_stack((np.linspace(0.0, 2.0, 41), np.zeros(41), np.zeros(41)))


def _window(lethal, resolution=0.05):
    costs = np.where(lethal, 254, 0).astype(np.uint8)
    half = 0.5 * resolution * lethal.shape[0]
    return CostmapWindow(costs, distance_field(lethal, resolution), resolution, -half, -half)


def _cells(window):
    return boundary_cells(window.costs, window.resolution, window.origin_x, window.origin_y)


@settings(derandomize=True, deadline=None, max_examples=60)
@given(
    st.lists(st.tuples(st.integers(0, 39), st.integers(0, 39), st.integers(1, 6)), min_size=1, max_size=8),
    st.floats(-0.9, 0.9),
    st.floats(-0.9, 0.9),
    st.floats(0.05, 0.3),
)
def test_discs_inside_enough_half_planes_touch_no_cell(boxes, x, y, radius):
    lethal = np.zeros((40, 40), np.bool_)
    for row, column, size in boxes:
        lethal[row : row + size, column : column + size] = True
    window = _window(lethal)
    cell = int((y + 1.0) / 0.05), int((x + 1.0) / 0.05)
    if lethal[cell]:
        return
    cells = _cells(window)
    planes = half_planes(window, cells, np.array(((x, y),)), radius, 0.0, 10.0, 40)[0]
    assert (planes[-1] == (0.0, 0.0, FREE)).all()  # forty were enough to shut every cell out
    for px, py in np.random.default_rng(0).uniform(-1.0, 1.0, (200, 2)):
        if (planes[:, :2] @ (px, py) >= planes[:, 2]).all():
            gaps = np.hypot(*np.maximum(np.abs(cells - (px, py)) - 0.025, 0.0).T)
            assert gaps.min() >= radius - 1e-6


def test_first_half_plane_faces_the_nearest_cell():
    lethal = np.zeros((40, 40), np.bool_)
    lethal[:, 30] = True  # a wall whose centre line lies at x = 0.525
    planes = half_planes(_window(lethal), _cells(_window(lethal)), np.array(((0.0, 0.025),)), 0.2, 0.0, 2.0, 2)[0]
    assert planes[0] == pytest.approx((-1.0, 0.0, -0.5 + 0.2), abs=1e-6)
    assert planes[1].tolist() == [0.0, 0.0, FREE]


def test_half_plane_inside_an_obstacle_leads_out():
    lethal = np.zeros((40, 40), np.bool_)
    lethal[:, 18:24] = True
    window = _window(lethal)
    planes = half_planes(window, _cells(window), np.array(((-0.03, 0.025),)), 0.1, 0.0, 2.0, 3)[0]
    assert planes[0, 0] < -0.9
    assert planes[0, :2] @ (-0.3, 0.0) > planes[0, 2]


def test_only_the_outermost_cells_count():
    lethal = np.zeros((40, 40), np.bool_)
    lethal[10:20, 10:20] = True
    assert len(_cells(_window(lethal))) == 36


def test_shifted_plan_is_the_rest_of_the_old_one():
    states = np.column_stack((np.linspace(0.0, 2.0, 21), np.zeros((21, 4))))
    moved = shift_plan(states, 0.1, 0.3, states[-1], 20, 0.1)
    assert moved[:18, 0] == pytest.approx(states[3:, 0])
    assert moved[-1] == pytest.approx(states[-1])


@settings(derandomize=True, deadline=None, max_examples=60)
@given(st.floats(-math.pi, math.pi), st.floats(0.1, 3.0), st.sampled_from([0.0, 0.5]), st.booleans())
def test_drive_along_a_path_keeps_to_the_model(theta, speed, radius, sideways):
    drive = drive_along(STRAIGHT, np.array((0.0, 0.3, theta)), speed, 1.5, sideways, radius, 25, 0.1)
    moved = np.diff(drive[:, :2], axis=0)
    turned = np.diff(drive[:, 2])
    assert (np.hypot(*moved.T) <= speed * 0.1 + 1e-9).all()
    assert (np.abs(turned) <= 0.15 + 1e-9).all()
    if not sideways:
        middle = drive[:-1, 2] + 0.5 * turned
        assert moved[:, 1] * np.cos(middle) - moved[:, 0] * np.sin(middle) == pytest.approx(np.zeros(25), abs=1e-9)
        if radius > 0.0:
            assert (np.abs(turned) * radius <= np.hypot(*moved.T) + 1e-9).all()


def test_stages_find_their_place_on_the_path():
    corner = np.vstack((STRAIGHT, np.column_stack((np.full(20, 2.0), np.linspace(0.05, 1.0, 20), np.zeros(20)))))
    rows = nearest_path_points(corner, np.array(((1.0, 0.2), (2.3, 0.5))))
    assert rows[0] == pytest.approx((1.0, 0.0, 0.0, 1.0, 0.0))
    assert rows[1] == pytest.approx((2.0, 0.5, -1.0, 0.0, math.pi / 2))


def test_path_that_comes_near_itself_is_not_cut_short():
    out = np.column_stack((np.linspace(0.0, 8.0, 161), np.zeros(161), np.zeros(161)))
    back = np.add(out[::-1], (0.0, 0.2, 0.0))
    path, progress = np.vstack((out, back)), PathProgress()
    assert len(progress.prune_path(path, np.array((0.0, 0.05)))) == 322
    assert len(progress.prune_path(path, np.array((1.0, 0.15)))) == 302


def test_local_goal_lies_ahead_and_inside_the_window():
    path = np.column_stack((np.linspace(0.0, 9.0, 181), np.zeros(181), np.zeros(181)))
    window = _window(np.zeros((120, 120), np.bool_))
    assert local_reference(path, 1.5, None, window).goal[0] == pytest.approx(1.5, abs=0.06)
    assert local_reference(path, 8.0, None, window).goal[0] == pytest.approx(2.7, abs=0.06)
    assert not local_reference(path, 8.0, None, window).final
    assert local_reference(path[:10], 8.0, None, window).final
    assert local_reference(np.add(path, (50.0, 0.0, 0.0)), 8.0, None, window).path.shape == (1, 3)


def test_path_is_free_up_to_what_blocks_it():
    lethal = np.zeros((120, 120), np.bool_)
    lethal[:, 80:84] = True  # from x = 1.0
    count = free_poses(_window(lethal), STRAIGHT, 0.2)
    assert STRAIGHT[count - 1, 0] == pytest.approx(0.8, abs=0.06)
    assert free_poses(_window(lethal), STRAIGHT[:10], 0.2) == 10


def moving_of(tracks):
    return Foreseen.straight(tracks.positions, tracks.velocities), tracks.radii


def scene_with(window, tracks=NO_TRACKS):
    return Scene(window, np.empty((0, 2)), *moving_of(tracks))


def test_nearest_people_come_first_and_the_rest_stands_far_away(people):
    scene = scene_with(None, people((5.0, 0.0, 0.0, 0.0), (1.0, 1.0, 0.0, -0.5), (1.0, 0.8, 0.0, 1.0)))
    rows = relevant_movers(scene, STRAIGHT[::2, :2], 0.2, 0.4, 2)
    assert rows[..., 4] == pytest.approx(0.7)
    assert (rows == rows[0]).all()
    assert rows[0, 0, :4] == pytest.approx((1.0, 1.0, 0.0, -0.5))
    assert (relevant_movers(scene_with(None), STRAIGHT[:, :2], 0.2, 0.4, 2)[..., :2] == FAR).all()
    assert relevant_movers(scene, STRAIGHT[:, :2], 0.2, 0.4, 0).shape == (len(STRAIGHT), 0, 5)


def test_each_stage_has_the_leg_on_which_a_person_then_is():
    places = np.array((((1.0, 1.0), (1.0, 0.0)),))
    bent = Foreseen.of(np.array((0.0, 1.0)), places, np.array((((0.0, -1.0), (0.5, 0.0)),)))
    rows = relevant_movers(Scene(None, None, bent, np.array((0.3,))), STRAIGHT[::2, :2], 0.2, 0.4, 1)
    times = 0.2 * np.arange(len(rows))
    at = rows[:, 0, :2] + times[:, None] * rows[:, 0, 2:4]
    assert at[times < 0.9] == pytest.approx(np.column_stack((np.ones(5), 1.0 - times[:5])))
    assert at[times > 1.1] == pytest.approx(np.column_stack((0.5 + 0.5 * times[6:], np.zeros(len(times) - 6))))


def test_first_hit_is_when_the_discs_meet(people):
    plan, disc = Plan(STRAIGHT[::2], 0.1, np.zeros(21)), Discs(np.zeros((1, 2)), 0.2)  # 1 m/s
    assert first_hit(scene_with(None, people((2.0, 0.0, -1.0, 0.0))), plan, disc, 0.02) == pytest.approx(0.8)
    assert first_hit(scene_with(None, people((2.0, 3.0, 0.0, 0.0))), plan, disc, 0.02) == math.inf
    assert first_hit(scene_with(None, people()), plan, disc, 0.02) == math.inf


def test_way_out_of_contact_is_no_hit(people):
    plan, disc = Plan(STRAIGHT[::2], 0.1, np.zeros(21)), Discs(np.zeros((1, 2)), 0.2)
    assert first_hit(scene_with(None, people((-0.45, 0.0, 0.0, 0.0))), plan, disc, 0.02) == math.inf
    assert first_hit(scene_with(None, people((0.45, 0.0, 0.0, 0.0))), plan, disc, 0.02) == pytest.approx(0.05)


def test_plan_is_checked_between_its_stages():
    lethal = np.zeros((120, 120), np.bool_)
    lethal[:, 80] = True
    poses = np.array(((0.0, 0.0, 0.0), (2.0, 0.0, 0.0)))
    assert free_until(_window(lethal), footprint_outline(Footprint.circle(0.1)), poses, 0.0) == pytest.approx(
        0.45, abs=0.04
    )
    assert (
        free_until(_window(np.zeros((120, 120), np.bool_)), footprint_outline(Footprint.circle(0.1)), poses, 0.0) == 1.0
    )


@pytest.mark.parametrize(("step", "stages"), [(0.3, 25), (0.2, 20), (0.1, 15)])
def test_intervals_come_and_go_with_their_length(step, stages):
    plan = Plan(np.zeros((21, 5)), step, np.zeros(21))
    found, length = resize_grid(plan, GRID)
    assert found == stages
    assert found * length == pytest.approx(20 * step)


def test_number_of_intervals_stays_within_bounds():
    long, short = Plan(np.zeros((31, 5)), 0.4, np.zeros(31)), Plan(np.zeros((11, 5)), 0.05, np.zeros(11))
    assert resize_grid(long, GRID)[0] == 30
    assert resize_grid(short, GRID)[0] == 10


@pytest.mark.parametrize("model", ["unicycle", "bicycle", "omnidirectional"])
@pytest.mark.parametrize("form", ["minimum_time", "quadratic"])
@pytest.mark.parametrize("hard", [False, True])
def test_every_constraint_row_has_its_kind(model, form, hard):
    problem = formulate_problem(Shape(model, form, 4, 2, 3, 2, False, hard, hard))
    rows = problem.nlp["g"].numel()
    assert len(problem.equality) == len(problem.lower) == len(problem.upper) == rows
    assert (problem.lower[problem.equality] == 0.0).all()
    assert (problem.upper[problem.equality] == 0.0).all()


def test_problem_is_compiled_once_per_shape():
    shape, solver = (
        Shape("unicycle", "quadratic", 3, 1, 1, 1, False, False, False),
        SolverSettings("ipopt", 10, 10, 1e-3),
    )
    assert compiled_problem(shape, solver) is compiled_problem(dataclasses.replace(shape), solver)
    assert has_solver("ipopt")
    assert not has_solver("no_such_solver")


def test_every_size_that_resizing_leads_to_is_known_beforehand():
    assert reachable_sizes(GRID) == {10, 15, 20, 25, 30}
    assert reachable_sizes(dataclasses.replace(GRID, resize_by=50)) == {10, 20, 30}


def _boxed(x_low, x_high, y_low, y_high):
    middles = -3.0 + 0.05 * (np.arange(120) + 0.5)
    return _window(((middles > y_low) & (middles < y_high))[:, None] & ((middles > x_low) & (middles < x_high)))


def test_ways_round_a_box_lead_past_both_its_sides_and_the_shorter_one_first():
    window = _boxed(0.8, 1.2, -0.5, 0.2)
    left, right = path_detours(STRAIGHT, scene_with(window), 0.2, 0.3, 1.0, 1.5)
    assert 0.35 < left[:, 1].max() < 0.55
    assert -0.85 < right[:, 1].min() < -0.65
    for way in (left, right):
        assert free_poses(window, way, 0.2) == len(way)
        assert np.abs(np.diff(way[:, 1])).max() <= 0.05 + 1e-9
        assert way[[0, -1], 1] == pytest.approx(0.0, abs=0.1)


def test_free_path_needs_no_way_round_and_one_too_long_is_none():
    assert list(path_detours(STRAIGHT, scene_with(_boxed(0.8, 1.2, 0.5, 0.9)), 0.2, 0.3, 1.0, 1.5)) == []
    assert list(path_detours(STRAIGHT, scene_with(_boxed(0.8, 1.2, -2.9, 2.9)), 0.2, 0.3, 1.0, 1.5)) == []


@pytest.mark.parametrize(("speed", "blocked"), [(1.0, True), (0.25, False)])
def test_person_is_gone_round_where_robot_and_person_meet(speed, blocked):
    crossing = tracked((1.0, 1.0, 0.0, -1.0))  # on the path in 1 s
    ways = list(
        path_detours(STRAIGHT, scene_with(_window(np.zeros((120, 120), np.bool_)), crossing), 0.2, 0.1, speed, 1.5)
    )
    assert len(ways) == (2 if blocked else 0)
    for way in ways:
        meeting = np.hypot(way[:, 0] - 1.0, way[:, 1] - 1.0 + STRAIGHT[:, 0] / speed)
        assert meeting.min() > 0.3 + 0.2


def gap_in_a_wall(cells, depth=4):
    """Return a wall across the window from its middle on, with a gap of so many cells, and the
    height of the gap's middle, m.
    """
    lethal = np.zeros((80, 80), np.bool_)
    lethal[:, 40 : 40 + depth] = True
    lethal[36 : 36 + cells, 40 : 40 + depth] = False
    return _window(lethal), 0.05 * (36 + 0.5 * cells) - 2.0


def planes_at(window, x, y, radius, wanted):
    """Return the half-planes round a place with the wanted gap, and those without that give way nowhere."""
    centre, cells = np.array(((x, y),)), _cells(window)
    return half_planes(window, cells, centre, radius, wanted, 1.5, 6)[0], half_planes(
        window, cells, centre, radius + wanted, 0.0, 1.5, 6
    )[0]


@pytest.mark.parametrize("cells", range(7, 11))
@pytest.mark.parametrize("aside", [0.0, 0.01, 0.05])
def test_half_planes_in_a_passage_are_parallel_and_hold_its_middle(cells, aside):
    window, middle = gap_in_a_wall(cells, 20)
    eased, strict = planes_at(window, 0.5, middle + aside, 0.165, 0.1)
    used = eased[eased[:, 2] > 0.5 * FREE]
    assert np.abs(used[:, :2] @ used[0, :2]) == pytest.approx(1.0)
    assert np.abs(used[:, 0]).max() < 0.05  # the nearest cell's centre lies a little ahead
    # between which a disc's middle may lie
    left, right = (sign * used[used[:, 1] * sign > 0.0, 2].max() for sign in (-1.0, 1.0))
    lean = 0.5 * 0.05  # what a line that leans so much is off by half a metre ahead
    assert left - right == pytest.approx(max(0.04, cells * 0.05 - 2.0 * 0.265), abs=lean)
    assert 0.5 * (left + right) == pytest.approx(middle, abs=lean)
    if cells * 0.05 < 2.0 * 0.265:
        assert not (strict[:, :2] @ (0.5, middle) >= strict[:, 2]).all()
    assert (used[:, :2] @ (0.5, middle) >= used[:, 2] - 1e-9).all()


def test_the_gap_gives_way_by_no_more_than_is_wanted():
    window, middle = gap_in_a_wall(7, 20)
    eased, strict = planes_at(window, 0.525, middle, 0.172, 0.01)  # discs that have 3 mm on either side
    assert (strict[:, :2] @ (0.525, middle) < strict[:, 2]).any()
    for plane in eased[eased[:, 2] > 0.5 * FREE]:
        assert plane[:2] @ (0.525, middle) - plane[2] == pytest.approx(0.003, abs=1e-6)


@pytest.mark.parametrize("away", [0.1, 0.15, 0.2])
def test_before_a_door_its_posts_push_nothing_back(away):
    window, middle = gap_in_a_wall(8)
    eased, strict = planes_at(window, -away, middle, 0.165, 0.1)
    assert (strict[:, :2] @ (0.1, middle) < strict[:, 2]).any()  # what lies in the door is shut out
    assert (eased[:, :2] @ (0.1, middle) >= eased[:, 2]).all()


@settings(derandomize=True, deadline=None, max_examples=60)
@given(st.floats(0.0, 1.0), st.floats(-1.0, 1.0), st.floats(0.05, 0.3), st.floats(0.0, 0.2))
def test_a_wall_ahead_is_no_passage(away, y, radius, wanted):
    lethal = np.zeros((80, 80), np.bool_)
    lethal[:, 60:] = True
    eased, strict = planes_at(_window(lethal), 1.0 - away, y, radius, wanted)
    assert eased == pytest.approx(strict, abs=1e-9)


@settings(derandomize=True, deadline=None, max_examples=200)
@given(st.floats(0.03, 0.8), st.floats(0.03, 0.8), st.floats(0.05, 0.3), st.floats(0.0, 0.2))
def test_a_right_angled_corner_is_no_passage(x, y, radius, wanted):
    lethal = np.zeros((80, 80), np.bool_)
    lethal[60:, :] = lethal[:, 60:] = True
    eased, strict = planes_at(_window(lethal), 1.0 - x, 1.0 - y, radius, wanted)
    assert eased == pytest.approx(strict, abs=1e-9)


@settings(derandomize=True, deadline=None, max_examples=100)
@given(st.integers(0, 10**6), st.floats(0.05, 0.3), st.floats(0.0, 0.2))
def test_where_the_wanted_gap_fits_half_planes_stay_as_they_are(seed, radius, wanted):
    random = np.random.default_rng(seed)
    lethal = np.zeros((80, 80), np.bool_)
    for row, column in random.integers(0, 76, (10, 2)):
        lethal[row : row + 4, column : column + 4] = True
    x, y = random.uniform(-1.0, 1.0, 2)
    eased, strict = planes_at(_window(lethal), x, y, radius, wanted)
    if (strict[:, :2] @ (x, y) >= strict[:, 2] + 0.04).all():
        assert eased == pytest.approx(strict, abs=1e-9)
