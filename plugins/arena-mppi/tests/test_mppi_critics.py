"""Each critic of roll-outs alone, against figures worked out by hand."""

import math

import numpy as np
import pytest

from arena_core import Footprint
from arena_kernels.compiled import borrowing
from arena_kernels.costmap_window import window_of
from arena_mppi.critics import (
    COLLISION_COST,
    FAR,
    add_alignment_cost,
    add_goal_cost,
    add_moving_cost,
    add_progress_cost,
    add_static_cost,
)
from arena_mppi.parameters import Body, Critics, Scene
from arena_mppi.rollout import COSINE, COST, HIT, LANES, ROWS, SINE, SPEED, TRAVELLED, X, Y
from arena_mppi.scene import body_of

SINGLE = np.float32
ROUND = body_of(Footprint.circle(0.2))
WEIGHTS = dict.fromkeys(Critics._fields, 0.0) | {
    **{"static": 4.0, "inflation_radius": 0.5, "critical": 30.0, "near_collision_gap": 0.1, "reaction_time": 0.2},
    **{"moving": 20.0, "contact": 300.0, "margin": 0.5, "moving_reaction_time": 0.1},
}
CRITICS = Critics(*(SINGLE(WEIGHTS[name]) for name in Critics._fields))


@borrowing
def _static(lanes, scene, body, critics, least, share):
    add_static_cost(lanes, scene, body, critics, least, share)


@borrowing
def _moving(lanes, scene, body, critics, step, speeds, dt):
    add_moving_cost(lanes, scene, body, critics, step, speeds[0], speeds[1], dt)


@borrowing
def _aims(lanes, scene, weights):
    add_alignment_cost(lanes, scene, weights[0])
    add_progress_cost(lanes, scene, weights[1])
    add_goal_cost(lanes, scene, weights[2], weights[3])


@pytest.fixture
def scene(costmap):
    """Return an open scene; gaps and what is left of the way are 1 m everywhere."""
    window, ones = window_of(costmap()), np.ones((8, 8), np.float32)
    corner = (SINGLE(-4.0), SINGLE(-4.0), SINGLE(1.0))
    moving, belief = np.zeros((3, 0, 3), np.float32), np.array((1.0, 0.5, 0.25), np.float32)
    path = np.array([(0.05 * k, 0.3) for k in range(5)], np.float32)
    goal = np.array((1.0, 2.0, 0.6, 0.8), np.float32)
    return Scene(ones, *corner, ones, *corner, moving, belief, path, goal, window, 0.0, 0.0)


def lanes_of(**values):
    """Return a block whose first lane has these values; all others stand far away."""
    lanes = np.zeros(ROWS * LANES, np.float32)
    lanes[X : X + LANES], lanes[COSINE : COSINE + LANES] = 1e4, 1.0
    rows = {"x": X, "y": Y, "speed": SPEED, "travelled": TRAVELLED, "hit": HIT, "cosine": COSINE, "sine": SINE}
    for name, value in ({"x": 0.0} | values).items():
        lanes[rows[name]] = value
    return lanes


def static(scene, gap, share=1.0, least=-1.0, body=ROUND, critics=CRITICS, **values):
    """Return what the first lane costs whose disc is ``gap`` from walls, and whether it has collided."""
    lanes = lanes_of(**values)
    _static(lanes, scene._replace(gaps=np.full((8, 8), gap + 0.2, np.float32)), body, critics, least, SINGLE(share))
    assert not lanes[COST + 1 : COST + LANES].any()
    return float(lanes[COST]), bool(lanes[HIT])


@pytest.mark.parametrize(
    ("gap", "cost"),
    [(0.6, 0.0), (0.5, 0.0), (0.25, 4.0 * 0.25), (0.1, 4.0 * 0.64), (0.05, 4.0 * 0.81 + 15.0), (0.0, 34.0)],
)
def test_walls_repel_by_the_square_of_the_missing_gap_and_more_close_by(scene, gap, cost):
    assert static(scene, gap)[0] == pytest.approx(cost, abs=1e-4)
    assert static(scene, gap, share=0.25)[0] == pytest.approx(0.25 * cost, abs=1e-4)


def test_to_a_fast_robot_walls_are_nearer(scene):
    assert static(scene, 0.35, speed=0.5)[0] == pytest.approx(4.0 * 0.25, abs=1e-5)


def test_a_roll_out_beyond_the_window_feels_no_wall(scene):
    assert static(scene, 0.1, x=5.0)[0] == 0.0
    assert static(scene, float(FAR))[0] == 0.0


def test_the_nearest_disc_of_the_footprint_counts(scene):
    """The gap grows by 0.1 m with each metre along y: it is nearest for the disc that lies to the right."""
    discs = np.array(((0.3, 0.0, 0.1), (-0.3, 0.0, 0.2)), np.float32)
    heights = 0.6 + 0.1 * (np.arange(8) - 3.5)
    gaps = np.repeat(heights[:, None], 8, axis=1).astype(np.float32)
    lanes = lanes_of(cosine=0.0, sine=-1.0, y=0.5)
    _static(lanes, scene._replace(gaps=gaps), Body(ROUND.outline, discs), CRITICS, -1.0, SINGLE(1.0))
    gap = min(0.6 + 0.1 * 0.2 - 0.1, 0.6 + 0.1 * 0.8 - 0.2)
    assert lanes[COST] == pytest.approx(4.0 * (1.0 - gap / 0.5) ** 2, abs=1e-5)


def test_the_first_contact_costs_a_million_and_as_much_for_each_metre_a_second(scene, costmap):
    near = scene._replace(window=window_of(costmap((0.22, 0.5, -1.0, 1.0))))
    cost, hit = static(near, 0.02, least=0.05, speed=0.5)
    assert hit
    assert cost == pytest.approx(float(COLLISION_COST) * 1.5 + 34.0, rel=1e-6)
    assert static(near, 0.02, least=0.05, hit=1.0) == (0.0, True), "once"
    assert not static(near, 0.06, least=0.05)[1], "discs tell that the outline need not be looked at"
    assert not static(scene, 0.02, least=0.05)[1], "the outline itself has room"


def test_every_lane_is_judged_where_it_is(scene, costmap):
    """Lane 7, 0.75 m to the left, collides with a box there; lane 0 has as little gap and no box."""
    near = scene._replace(window=window_of(costmap((0.22, 0.5, 0.6, 0.9))), gaps=np.full((8, 8), 0.22, np.float32))
    lanes = lanes_of()
    lanes[X + 7], lanes[Y + 7] = 0.0, 0.75
    _static(lanes, near, ROUND, CRITICS, 0.05, SINGLE(1.0))
    assert (lanes[HIT], lanes[HIT + 7]) == (0.0, 1.0)
    assert lanes[COST + 7] == pytest.approx(float(lanes[COST]) + float(COLLISION_COST), rel=1e-6)
    assert lanes[COST] == pytest.approx(4.0 * 0.96**2 + 30.0 * 0.8, rel=1e-4)


def moving(scene, others, step=0, dt=0.1, fastest=1.0, cover=0.2, **values):
    lanes = lanes_of(**values)
    people = np.tile(np.array(others, np.float32).reshape(1, -1, 3), (3, 1, 1))
    speeds = np.array((fastest, cover), np.float32)
    _moving(lanes, scene._replace(moving=people), ROUND, CRITICS, step, speeds, SINGLE(dt))
    assert not lanes[COST + 1 : COST + LANES].any()
    return float(lanes[COST])


@pytest.mark.parametrize(("step", "belief"), [(0, 1.0), (1, 0.5), (2, 0.25)])
@pytest.mark.parametrize(("apart", "lack"), [(1.0, 0.0), (0.75, 0.5), (0.5, 1.0)])
def test_people_cost_by_the_square_of_the_missing_margin_and_by_belief(scene, apart, lack, step, belief):
    """Discs of 0.2 and 0.3 m, and 0.5 m that is wanted between them."""
    found = moving(scene, [(0.6 * apart, 0.8 * apart, 0.3)], step)
    assert found == pytest.approx(0.1 * belief * 20.0 * lack**2, abs=1e-5)


def test_touching_people_costs_beyond_the_margin(scene):
    assert moving(scene, [(0.4, 0.0, 0.3)]) == pytest.approx(0.1 * (20.0 * 1.2**2 + 300.0 * 1.2), rel=1e-5)


def test_past_people_a_fast_robot_needs_more_room(scene):
    assert moving(scene, [(0.8, 0.0, 0.3)], speed=0.5) == pytest.approx(0.1 * 20.0 * 0.5**2, rel=1e-5)


def test_people_add_up_and_far_ones_cost_nothing(scene):
    one, both = moving(scene, [(0.75, 0.0, 0.3)]), moving(scene, [(0.75, 0.0, 0.3), (0.0, 0.75, 0.3), (9.0, 9.0, 0.3)])
    assert both == pytest.approx(2.0 * one)
    assert moving(scene, [(9.0, 9.0, 0.3)]) == 0.0


def test_many_lanes_near_people_cost_as_each_alone(scene):
    lanes, people = lanes_of(), np.tile(np.array((0.75, 0.0, 0.3), np.float32), (3, 1, 1))
    lanes[X : X + 60] = 0.0
    _moving(lanes, scene._replace(moving=people), ROUND, CRITICS, 0, np.array((1.0, 0.2), np.float32), SINGLE(0.1))
    assert lanes[COST : COST + 60] == pytest.approx(np.full(60, moving(scene, [(0.75, 0.0, 0.3)])))


def aims(scene, align=0.0, progress=0.0, goal=0.0, angle=0.0, **values):
    lanes = lanes_of(**values)
    _aims(lanes, scene, np.array((align, progress, goal, angle), np.float32))
    return float(lanes[COST])


@pytest.mark.parametrize(("travelled", "x"), [(0.0, 0.0), (0.04, 0.0), (0.06, 0.05), (0.16, 0.15), (9.0, 0.2)])
def test_alignment_costs_the_distance_from_the_path_point_as_far_along(scene, travelled, x):
    assert aims(scene, align=3.0, x=0.5, y=-0.1, travelled=travelled) == pytest.approx(
        3.0 * math.hypot(0.5 - x, 0.4), rel=1e-5
    )


def test_progress_costs_what_is_left_of_the_way_and_the_way_back_into_the_window(scene):
    left = np.repeat(np.arange(8.0, dtype=np.float32)[None, :], 8, axis=0)  # 1 m more a column
    sloped = scene._replace(left=left)
    assert aims(sloped, progress=2.0, x=0.5, y=0.3) == pytest.approx(2.0 * 4.0), (
        "between cell centres 3.5 m from the edge"
    )
    assert aims(sloped, progress=2.0, x=0.75, y=0.3) == pytest.approx(2.0 * 4.25)
    assert aims(sloped, progress=2.0, x=6.5, y=7.5) == pytest.approx(2.0 * (7.0 + 5.0))
    assert aims(sloped, progress=2.0, x=-3.5, y=-4.5) == pytest.approx(2.0 * 1.0)
    assert aims(sloped, progress=2.0, x=0.5, hit=1.0) == 0.0


def test_goal_costs_its_distance_and_one_less_the_cosine_of_the_angle_to_its_heading(scene):
    assert aims(scene, goal=2.0, x=0.4, y=1.2) == pytest.approx(2.0 * 1.0)
    assert aims(scene, angle=2.0) == pytest.approx(2.0 * (1.0 - 0.6))
    assert aims(scene, angle=2.0, cosine=0.0, sine=-1.0) == pytest.approx(2.0 * 1.8)
