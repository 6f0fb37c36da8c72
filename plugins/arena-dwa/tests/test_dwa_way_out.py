import math

import numpy as np
import pytest

from arena_core import Pose
from arena_dwa.map_grid import map_grids
from arena_dwa.settings import Body, BodyOnWindow
from arena_dwa.stuck_detection import StuckDetector
from arena_dwa.way_out import LineRules, best_line
from arena_kernels.costmap_window import outline_of, window_of

DISC = Body(outline_of(None, 0.113, 0.113, 0.05), 0.08, 0.25, 0.2)
BAR = Body(outline_of(np.array(((0.3, -0.1), (0.3, 0.1), (-0.3, 0.1), (-0.3, -0.1))), 0.32, 0.1, 0.05), 0.02, 0.25, 0.2)
PATH = np.array([(0.1 * k, 0.0, 0.0) for k in range(25)])


def line_out(
    costmap, body: Body, theta: float, sideways: bool = False, backwards: bool = True
) -> tuple[float, float, float]:
    window = window_of(costmap)
    grids = map_grids(BodyOnWindow(window, body), PATH, (0.0, 0.0), 0.325)
    return best_line(
        BodyOnWindow(window, body),
        grids.goal,
        (0.0, 0.0, math.cos(theta), math.sin(theta)),
        LineRules(0.5, sideways, backwards),
    )


def test_free_ground_is_crossed_straight_towards_the_goal(costmap):
    direction, heading, length = line_out(costmap(), DISC, -1.0)
    assert direction == pytest.approx(1.0, abs=0.25)  # the goal's steps are counted along an octagon
    assert heading == pytest.approx(direction)
    assert length >= 0.4


def test_a_post_before_the_robot_is_passed_beside_it(costmap):
    direction, heading, length = line_out(costmap((0.2, 0.3, -0.6, 0.05)), DISC, 0.0)
    assert 0.3 < direction < 2.0
    assert heading == pytest.approx(direction)
    assert length >= 0.1


def test_there_is_no_line_out_of_a_closed_box(costmap):
    box = costmap((0.2, 0.3, -0.3, 0.3), (-0.3, -0.2, -0.3, 0.3), (-0.3, 0.3, 0.2, 0.3), (-0.3, 0.3, -0.3, -0.2))
    assert line_out(box, DISC, 0.0)[2] == 0.0


def test_a_robot_that_cannot_turn_there_backs_out(costmap):
    aisle = costmap((-1.0, 0.6, 0.2, 0.3), (-1.0, 0.6, -0.3, -0.2))  # narrower than the bar is long
    direction, heading, length = line_out(aisle, BAR, math.pi)
    assert heading == pytest.approx(0.0, abs=1e-9)
    assert abs(math.remainder(direction, 2.0 * math.pi)) == pytest.approx(math.pi, abs=0.25)
    assert length >= 0.4
    assert line_out(aisle, BAR, math.pi, backwards=False)[2] == 0.0


def test_a_holonomic_robot_need_not_turn(costmap):
    direction, heading, length = line_out(costmap(), DISC, 0.5 * math.pi, sideways=True)
    assert heading == 0.0
    assert math.remainder(direction, 2.0 * math.pi) == pytest.approx(-0.5 * math.pi, abs=0.25)
    assert length >= 0.4


def test_standing_and_shuffling_wear_patience_out_and_driving_does_not():
    still, shuffling, driving = StuckDetector(3.0), StuckDetector(3.0), StuckDetector(3.0)
    seen = [
        (
            still.is_stuck(Pose(0.0, 0.0), 0.1 * k),
            shuffling.is_stuck(Pose(0.31 * ((k // 60) % 2), 0.0), 0.1 * k),
            driving.is_stuck(Pose(0.011 * k, 0.0), 0.1 * k),
        )
        for k in range(200)
    ]
    stood, shuffled, drove = np.array(seen).T
    assert not stood[:30].any()
    assert stood[32:].all()
    assert shuffled[-50:].all()
    assert not drove.any()
    assert not any(StuckDetector(None).is_stuck(Pose(0.0, 0.0), stamp) for stamp in (0.0, 1e6))
