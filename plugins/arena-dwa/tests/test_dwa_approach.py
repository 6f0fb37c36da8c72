import numpy as np
import pytest

from arena_core import Costmap, Pose, Twist
from arena_dwa.approach import ClosingSpeeds, approach_cost, clearance_shortfall
from arena_dwa.settings import Approach, Body, BodyOnWindow
from arena_dwa.trajectory import planar_pose
from arena_kernels.costmap_window import outline_of, window_of
from arena_kernels.distance import distance_field

DISC = Body(outline_of(None, 0.113, 0.113, 0.05), 0.03, 0.25, 0.2)
CRITIC = Approach(1.0, 2.0, 0.4)
AHEAD = [(0.1 * k, 0.0) for k in range(40)]


def speeds_of(costmap, *positions_x, lapse=0.9):
    """Return the closing speeds after a box has stood at these places, one a step of 0.1 s."""
    memory = ClosingSpeeds(lapse, 0.1, 1.0)
    for k, x in enumerate(positions_x):
        window = costmap((x, x + 0.3, -0.3, 0.3))
        speeds = memory.update(0.1 * k, window_of(window))
    return speeds, window_of(window)


def test_box_that_comes_nearer_closes_at_its_speed_before_it_and_not_behind(costmap):
    speeds, _ = speeds_of(costmap, *np.linspace(2.0, 1.55, 10))
    assert speeds[60, 60] == pytest.approx(0.5, abs=1e-5)
    assert speeds[60, 115] == 0.0
    assert speeds.max() <= 1.0


def test_nothing_closes_where_all_stands(costmap):
    speeds, _ = speeds_of(costmap, *[1.5] * 10)
    assert not speeds.any()


def test_moved_window_is_compared_place_by_place(costmap):
    whole = costmap((1.5, 1.8, -0.3, 0.3))
    memory = ClosingSpeeds(0.9, 0.1, 1.0)
    part = Costmap(whole.costs[:100, :100], whole.distance[:100, :100], 0.05, whole.origin_xy)
    memory.update(0.0, window_of(part))
    moved_on = Costmap(
        whole.costs[10:110, 5:105], whole.distance[10:110, 5:105], 0.05, whole.origin_xy + 0.05 * np.array((5, 10))
    )
    assert not memory.update(0.5, window_of(moved_on)).any()


def test_wall_that_comes_into_the_window_does_not_come_at_the_robot():
    memory = ClosingSpeeds(0.9, 0.1, 1.0)
    for k in range(5):
        blocked = np.zeros((100, 100), bool)
        blocked[:, 102 - k :] = True  # in the window from the fourth step on
        distance = distance_field(blocked, 0.05)
        costmap = Costmap(np.where(blocked, 254, 0).astype(np.uint8), distance, 0.05, np.array((0.05 * k, 0.0)))
        assert not memory.update(0.1 * k, window_of(costmap)).any()


def test_only_the_lapse_is_looked_back(costmap):
    speeds, _ = speeds_of(costmap, 2.5, 2.0, *[1.5] * 9, lapse=0.5)
    assert not speeds.any()


def test_standing_before_what_comes_costs_and_going_out_of_its_way_costs_less(costmap):
    speeds, window = speeds_of(costmap, *np.linspace(1.1, 0.65, 10))
    start = planar_pose(0.0, 0.0, 0.0)
    stay = approach_cost(BodyOnWindow(window, DISC), speeds, CRITIC, start, (0.0, 0.0, 0.0))
    back = approach_cost(BodyOnWindow(window, DISC), speeds, CRITIC, start, (-0.22, 0.0, 0.0))
    on = approach_cost(BodyOnWindow(window, DISC), speeds, CRITIC, start, (0.22, 0.0, 0.0))
    assert 0.0 < back < stay < on


def test_what_stands_costs_nothing(costmap):
    speeds, window = speeds_of(costmap, *[0.5] * 10)
    assert (
        approach_cost(BodyOnWindow(window, DISC), speeds, CRITIC, planar_pose(0.0, 0.0, 0.0), (0.22, 0.0, 0.0)) == 0.0
    )


def test_lack_is_none_at_the_margin_and_one_in_contact():
    assert clearance_shortfall(0.4, 0.4) == 0.0
    assert clearance_shortfall(0.0, 0.4) == 1.0
    assert clearance_shortfall(-0.4, 0.4) == 4.0


def test_planner_makes_way_for_what_comes_at_it(build, costmap, observe):
    def last_command(scale):
        planner = build(approach={"scale": scale})
        for k in range(10):
            x = 1.2 - 0.04 * k
            command = planner.compute_velocity(
                observe(costmap((x, x + 0.4, -0.3, 0.3)), Pose(0.0, 0.0), AHEAD, Twist(0.0), stamp=0.1 * k)
            )
        return command

    assert last_command(0.0).vx > 0.1
    assert abs(last_command(200.0).wz) > 0.3 or last_command(200.0).vx < 0.0
