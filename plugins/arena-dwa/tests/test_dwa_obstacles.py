import math

import numpy as np
import pytest

from arena_dwa.obstacles import REJECTED, obstacle_cost, outline_growth
from arena_dwa.settings import Body, BodyOnWindow, Limits, RollOut
from arena_dwa.trajectory import planar_pose
from arena_kernels.costmap_window import outline_clearance, outline_of, window_of

LIMITS = Limits(-0.22, 0.22, 0.0, 2.84, 0.0, 0.22, 0.0, 2.5, 0.0, 3.2, 0.0)
ROLL_OUT = RollOut(1.5, 0.05, 0.2, 0.2, 20, 0, 40)
DISC = Body(outline_of(None, 0.113, 0.113, 0.05), 0.03, 0.25, 0.2)
JACKAL = np.array([[0.21, -0.165], [0.21, 0.165], [-0.21, 0.165], [-0.21, -0.165]])
BOX = Body(outline_of(JACKAL, math.hypot(0.21, 0.165), 0.165, 0.05), 0.02, 0.25, 0.2)
ORIGIN = planar_pose(0.0, 0.0, 0.0)


def cost(window, body, sample, pose=(0.0, 0.0, 0.0), mean=False):
    stand = planar_pose(*pose)
    start = outline_clearance(window, body.outline, stand, 1.0)
    return obstacle_cost(BodyOnWindow(window, body), LIMITS, ROLL_OUT, 0.1, stand, sample, start, mean, math.inf)


def test_sample_that_reaches_a_wall_within_its_time_is_rejected(costmap):
    window = window_of(costmap((0.4, 0.6, -1.0, 1.0)))
    assert cost(window, DISC, (0.22, 0.0, 0.0)) == REJECTED
    assert cost(window, DISC, (0.1, 0.0, 0.0)) > 0.0
    assert cost(window, DISC, (-0.22, 0.0, 0.0)) > 0.0


def test_sample_that_leaves_the_window_is_rejected(costmap):
    window = window_of(costmap(cells=11))
    assert cost(window, DISC, (0.22, 0.0, 0.0)) == REJECTED
    assert cost(window, DISC, (0.1, 0.0, 0.0)) == 0.0


def test_fast_sample_is_followed_until_it_could_have_stopped(costmap):
    ground = BodyOnWindow(window_of(costmap((0.9, 1.0, -1.0, 1.0))), DISC)
    slow_brakes, short = LIMITS._replace(vx_max=1.0, trans_max=1.0, ax_max=0.5), ROLL_OUT._replace(sim_time=0.2)
    slow, fast = (
        obstacle_cost(ground, slow_brakes, short, 0.1, ORIGIN, (speed, 0.0, 0.0), 1.0, False, math.inf)
        for speed in (0.3, 0.9)
    )
    assert slow != REJECTED
    assert fast == REJECTED


def test_polygon_passes_a_gap_that_its_circumscribed_disc_does_not(costmap):
    window = window_of(costmap((-1.0, 1.0, 0.25, 0.6), (-1.0, 1.0, -0.6, -0.25)))
    disc = outline_of(None, BOX.outline.radius, BOX.outline.radius, 0.05)
    assert cost(window, BOX, (0.2, 0.0, 0.0)) > 0.0
    assert outline_clearance(window, disc, ORIGIN, 1.0) < 0.0 < outline_clearance(window, BOX.outline, ORIGIN, 1.0)


def test_polygon_across_a_gap_is_in_collision(costmap):
    window = window_of(costmap((-1.0, 1.0, 0.2, 0.6), (-1.0, 1.0, -0.6, -0.2)))
    assert outline_clearance(window, BOX.outline, ORIGIN, 1.0) > 0.0
    assert outline_clearance(window, BOX.outline, planar_pose(0.0, 0.0, math.pi / 2), 1.0) < 0.0


def test_robot_in_contact_may_drive_away_but_not_on(costmap):
    window = window_of(costmap((0.1, 0.5, -1.0, 1.0)))
    assert outline_clearance(window, DISC.outline, ORIGIN, 1.0) < 0.0
    assert cost(window, DISC, (-0.1, 0.0, 0.0)) > 0.0
    assert cost(window, DISC, (0.1, 0.0, 0.0)) == REJECTED


def test_outline_grows_above_the_scaling_speed_only():
    limits = LIMITS._replace(trans_max=2.25)
    assert outline_growth(DISC, limits, 0.25) == 0.0
    assert outline_growth(DISC, limits, 2.25) == pytest.approx(0.2 * 0.113)
    assert outline_growth(DISC, limits, 1.25) == pytest.approx(0.1 * 0.113)


def test_mean_cost_falls_on_the_way_out_where_the_greatest_stays(costmap):
    window = window_of(costmap((0.25, 0.5, -1.0, 1.0)))
    away, stay = (-0.22, 0.0, 0.0), (0.0, 0.0, 0.0)
    assert cost(window, DISC, away, mean=True) < cost(window, DISC, stay, mean=True) - 10.0
