"""Each critic alone, against figures worked out by hand: the scales of all others are 0."""

import math

import numpy as np
import pytest

from arena_dwa.approach import ClosingSpeeds, approach_cost
from arena_dwa.map_grid import map_grids
from arena_dwa.obstacles import REJECTED, free_around, obstacle_cost, stopping_time
from arena_dwa.search import cheapest_sample
from arena_dwa.settings import Approach, Body, BodyOnWindow, Limits, RollOut, Scales, Settings
from arena_dwa.trajectory import planar_pose
from arena_kernels.costmap_window import CostmapWindow, outline_clearance, outline_of, window_of

LIMITS = Limits(-0.5, 0.5, 0.0, 2.0, 0.0, 0.5, 0.0, 2.0, 0.0, 4.0, 0.0)
ROLL_OUT = RollOut(2.0, 0.05, 0.2, 0.2, 20, 0, 40)
DISC = Body(outline_of(None, 0.113, 0.113, 0.05), 0.03, 0.25, 0.0)
NONE = Scales(0.0, 0.0, 0.0, False, 0.3, 0.0, 0.0, 0.0)
LOOK = Approach(1.0, 2.0, 0.4)
ORIGIN = planar_pose(0.0, 0.0, 0.0)


OFF = LOOK._replace(scale=0.0)


def score(window, sample, scales=NONE, approach=OFF, speeds=None, path=None, body=DISC, pose=(0, 0, 0)):
    """Return what a single sample costs on the way along the x axis; infinite where it is rejected."""
    path = np.array([(0.05 * k, 0.0, 0.0) for k in range(41)]) if path is None else path
    grids = map_grids(BodyOnWindow(window, body), path, (float(pose[0]), float(pose[1])), scales.forward_point_distance)
    velocities = np.column_stack((sample, sample)).astype(float)
    state, free = np.array((*pose, 0.0, 0.0, 0.0), float), np.zeros(3, np.int8)
    field = np.zeros(window.distance.shape, np.float32) if speeds is None else speeds
    settings = Settings(LIMITS, ROLL_OUT, body, scales, approach)
    return cheapest_sample(window, grids, field, path, state, velocities, 0.1, settings, free)[3]


@pytest.fixture
def hall(costmap):
    """Return a window without an obstacle."""
    return window_of(costmap())


def test_without_scales_nothing_costs(hall):
    assert score(hall, (0.25, 0.0, 1.0)) == 0.0


@pytest.mark.parametrize("vx", [0.1, 0.25, 0.5])
def test_goal_critics_cost_half_the_bias_for_each_metre_left_of_the_robot_and_of_its_front(hall, vx):
    """In two seconds along the path: of 2 m the rest is left, as the front's goal lies as far beyond the goal."""
    assert score(hall, (vx, 0.0, 0.0), NONE._replace(goal_distance_bias=3.0)) == pytest.approx(3.0 * (2.0 - 2.0 * vx))


def test_path_critics_cost_half_the_bias_for_each_metre_beside_the_path(hall):
    """At the robot's place 0.4 m beside it, and at its front 0.3 m ahead, which is as far beside."""
    bias = NONE._replace(path_distance_bias=3.0)
    assert score(hall, (0.2, 0.0, 0.0), bias, pose=(0.0, 0.4, 0.0)) == pytest.approx(3.0 * 0.4)
    assert score(hall, (0.2, 0.0, 0.0), bias) == pytest.approx(0.0, abs=1e-9)
    turned = score(hall, (0.0, 0.0, 0.25 * math.pi), bias)  # for two seconds: to the left
    assert turned == pytest.approx(0.5 * 3.0 * 0.3, rel=1e-5)


def test_near_the_goal_the_front_is_not_held_to_the_path(hall):
    """Within 0.3 m, as far ahead as the front is: there it would lie past the path's end."""
    bias = NONE._replace(path_distance_bias=3.0)
    for end, counted in ((0.2, 0.5), (0.25, 1.0)):  # m ahead, 0.2 m beside: 0.28 and 0.32 m away
        beside = np.array([(0.0, 0.2, 0.0), (end, 0.2, 0.0)])
        found = score(hall, (0.0, 0.0, 0.0), bias, path=beside)
        assert found == pytest.approx(3.0 * 0.2 * counted, abs=1e-3)


def test_twirling_and_reversing_cost_their_speeds(hall):
    assert score(hall, (0.2, 0.0, -0.8), NONE._replace(twirling_scale=2.0)) == pytest.approx(1.6)
    assert score(hall, (-0.2, 0.0, 0.0), NONE._replace(reverse_scale=2.0)) == pytest.approx(0.4)
    assert score(hall, (0.2, 0.0, 0.0), NONE._replace(reverse_scale=2.0)) == 0.0


def graded(costs, distance=9.0):
    """Return a window of 6 m whose cells cost by their column, and which is free everywhere."""
    cells = np.tile(np.asarray(costs, np.uint8), (120, 1))
    return CostmapWindow(cells, np.full(cells.shape, distance, np.float32), 0.05, -3.0, -3.0)


def test_obstacles_cost_the_greatest_or_the_mean_cell_on_the_way():
    """0.5 m in 20 steps from the edge of column 60 on: two on each of ten columns, which cost 0, 2, ... 18."""
    columns = np.zeros(120)
    columns[60:71] = 2.0 * np.arange(11)
    roll_out = ROLL_OUT._replace(sim_granularity=0.025)
    ground, stand = BodyOnWindow(graded(columns), DISC), planar_pose(-0.001, 0.0, 0.0)
    greatest, mean = (
        obstacle_cost(ground, LIMITS, roll_out, 0.1, stand, (0.25, 0.0, 0.0), 9.0, of, math.inf) for of in (False, True)
    )
    assert greatest == 18.0
    assert mean == pytest.approx(sum(2 * [2.0 * k for k in range(10)]) / 20.0)
    assert obstacle_cost(ground, LIMITS, roll_out, 0.1, stand, (0.25, 0.0, 0.0), 9.0, False, 5.0) == 6.0, "enough"


def test_the_obstacles_scale_multiplies_the_cell():
    columns = np.zeros(120)
    columns[:] = 7.0
    assert score(graded(columns), (0.2, 0.0, 0.0), NONE._replace(occdist_scale=0.5)) == 3.5


def test_escape_costs_what_is_missing_of_the_padding_at_the_end(costmap):
    """Only where the padding is not kept at the start."""
    window, escape = window_of(costmap((0.2, 0.5, -1.0, 1.0))), NONE._replace(escape_scale=2.0)
    body = DISC._replace(padding=0.15)
    gap = outline_clearance(window, body.outline, ORIGIN, 1.0)
    assert 0.0 < gap < 0.15
    assert score(window, (0.0, 0.0, 0.0), escape, body=body) == pytest.approx(2.0 * (0.15 - gap))
    assert score(window, (-0.01, 0.0, 0.0), escape, body=body) == pytest.approx(2.0 * (0.15 - gap - 0.02), rel=1e-3)
    assert score(window, (0.0, 0.0, 0.0), escape, body=body._replace(padding=0.5 * gap)) == 0.0


def lack(gap, margin=0.4):
    return max(0.0, 1.0 - gap / margin) ** 2


@pytest.mark.parametrize("speed", [0.1, 0.25])
def test_approach_costs_how_much_more_clearance_lacks_once_what_comes_has_come(costmap, speed):
    """Ten looks in two seconds: after 0.2 s a look what comes is nearer by its speed times that."""
    window = window_of(costmap((0.5, 0.8, -1.0, 1.0)))
    field = np.full(window.distance.shape, speed, np.float32)
    gap = outline_clearance(window, DISC.outline, ORIGIN, 1.0)
    by_hand = np.mean([lack(gap - speed * 0.2 * k) - lack(gap) for k in range(1, 11)])
    ground = BodyOnWindow(window, DISC)
    assert approach_cost(ground, field, LOOK, ORIGIN, (0.0, 0.0, 0.0)) == pytest.approx(by_hand, rel=1e-5)
    total = score(window, (0.0, 0.0, 0.0), approach=LOOK._replace(scale=3.0), speeds=field)
    assert total == pytest.approx(3.0 * by_hand, rel=1e-5)
    driven = np.mean(
        [lack(gap + 0.04 * k - speed * 0.2 * k) - lack(gap + 0.04 * k) for k in range(1, 11)]
    )  # 0.2 m/s backwards
    assert approach_cost(ground, field, LOOK, ORIGIN, (-0.2, 0.0, 0.0)) == pytest.approx(driven, rel=1e-3)


def test_approach_looks_at_the_speed_where_the_robot_will_be_and_not_beyond_the_window(costmap):
    """At 0.5 m/s: after 0.4 m, four looks of 0.1 m, the field says 0.5 m/s; at 3 m the window ends."""
    window = window_of(costmap((-1.0, 3.0, 0.2, 0.3)))
    gap = outline_clearance(window, DISC.outline, ORIGIN, 1.0)
    field = np.zeros(window.distance.shape, np.float32)
    column = int((0.45 - window.origin_x) / 0.05)
    field[:, column:] = 0.5
    looks = [lack(gap - 0.5 * 0.2 * k) - lack(gap) for k in range(5, 11)]
    found = approach_cost(BodyOnWindow(window, DISC), field, LOOK, ORIGIN, (0.5, 0.0, 0.0))
    assert found == pytest.approx(sum(looks) / 10.0, rel=1e-3)
    edge = planar_pose(2.75, 0.0, 0.0)
    looks = [lack(gap - 0.5 * 0.2 * k) - lack(gap) for k in range(1, 3)]
    found = approach_cost(BodyOnWindow(window, DISC), field, LOOK, edge, (0.5, 0.0, 0.0))
    assert found == pytest.approx(sum(looks) / 10.0, rel=1e-2)


@pytest.mark.parametrize(("speed", "felt"), [(0.05, 0.0), (0.1, 0.1), (0.7, 0.7), (1.0, 1.0), (1.5, 1.0)])
def test_closing_speeds_below_the_least_are_noise_and_those_above_the_greatest_are_cut(speed, felt):
    was, now = (
        CostmapWindow(np.zeros((9, 9), np.uint8), np.full((9, 9), of, np.float32), 1.0, 0.0, 0.0)
        for of in (0.75 + 0.5 * speed, 0.75)
    )
    memory = ClosingSpeeds(0.9, 0.099, 1.0)
    memory.update(0.0, was)
    assert memory.update(0.5, now)[4, 4] == pytest.approx(felt)


@pytest.mark.parametrize(("apart", "rim"), [(0.75, 0), (1.75, 1), (2.75, 2)])
def test_nothing_closes_that_is_farther_off_than_the_edge_of_the_window_before(apart, rim):
    """A place k cells from the edge is k + 1 m from the nearest cell beyond: what is farther may just have come in."""
    was, now = (
        CostmapWindow(np.zeros((9, 9), np.uint8), np.full((9, 9), of, np.float32), 1.0, 0.0, 0.0)
        for of in (apart + 0.25, apart)
    )
    memory = ClosingSpeeds(0.9, 0.1, 1.0)
    memory.update(0.0, was)
    felt = memory.update(0.5, now)
    inside = np.zeros((9, 9), bool)
    inside[rim : 9 - rim, rim : 9 - rim] = True
    assert ((felt > 0.0) == inside).all()


def test_approach_counts_up_to_the_last_cells_of_the_window(hall):
    field, ground = np.full(hall.distance.shape, 0.5, np.float32), BodyOnWindow(graded(np.zeros(121), 0.3), DISC)
    middle = approach_cost(ground, field, LOOK, ORIGIN, (0.0, 0.0, 0.0))
    for x, y in ((-2.99, 0.0), (0.0, -2.99), (2.99, 0.0), (0.0, 2.99)):
        assert approach_cost(ground, field, LOOK, planar_pose(x, y, 0.0), (0.0, 0.0, 0.0)) == pytest.approx(middle)


def test_braking_takes_as_long_as_the_slowest_axis():
    slow = LIMITS._replace(ax_max=0.5, ay_max=0.25, alpha_max=2.0)
    assert stopping_time(-0.5, 0.0, 1.0, slow) == 1.0
    assert stopping_time(0.25, 0.0, -3.0, slow) == 1.5
    assert stopping_time(0.25, -0.5, 1.0, slow) == 2.0
    assert stopping_time(0.25, 0.5, 1.0, slow._replace(ay_max=0.0)) == 0.5


def test_room_round_the_robot_ends_at_the_nearest_cell_and_at_the_edge(hall):
    assert free_around(graded(np.zeros(120), 0.5), DISC, ORIGIN) == pytest.approx(0.5 - 0.025 - 0.113), (
        "to the edge of the cell"
    )
    assert free_around(graded(np.zeros(120)), DISC, ORIGIN) == 3.0
    assert free_around(graded(np.zeros(120)), DISC, planar_pose(2.5, 0.25, 0.0)) == pytest.approx(0.5)
    assert free_around(graded(np.zeros(120)), DISC, planar_pose(0.25, -2.75, 0.0)) == pytest.approx(0.25)


def test_an_arc_lasts_as_long_as_it_takes_to_stop_with_time_to_spare():
    """0.5 m/s and 0.5 m/s^2: half a second of way while braking for one, and 0.2 s to spare, and the period."""
    slow, short = LIMITS._replace(ax_max=0.5), ROLL_OUT._replace(sim_time=0.1)
    ground, reach = BodyOnWindow(graded(np.zeros(120)), DISC), 0.5 * (0.1 + 0.5 + 0.2)
    for spare, rejected in ((-0.01, True), (0.01, False)):
        stand = planar_pose(3.0 - reach - spare, 0.0, 0.0)
        found = obstacle_cost(ground, slow, short, 0.1, stand, (0.5, 0.0, 0.0), 9.0, False, math.inf)
        assert (found == REJECTED) == rejected
