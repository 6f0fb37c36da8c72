import math
from dataclasses import replace

import numpy as np
import pytest

from arena_core import Pose, Twist
from arena_dwa.arrival import Arrival
from arena_dwa.parameters import GoalParameters
from arena_dwa.settings import Limits

LIMITS = Limits(-0.22, 0.22, 0.0, 2.75, 0.11, 0.22, 1.37, 2.5, 0.0, 3.2, 0.0)
PATH = np.array(((0.0, 0.0, 0.0), (1.0, 0.0, 0.0)))
REST = np.zeros(3)


def arrival(latched: bool) -> Arrival:
    return Arrival(GoalParameters(0.1, 0.17, latched), LIMITS)


def test_away_from_the_end_the_path_is_driven():
    assert arrival(False).target_velocity(Pose(0.8, 0.0), REST, PATH, 0.0, 0.1) is None
    assert (
        Arrival(GoalParameters(None, 0.17, False), LIMITS).target_velocity(Pose(1.0, 0.0), REST, PATH, 1.0, 0.1) is None
    )


def test_robot_brakes_first_and_then_turns_to_the_goals_heading():
    there, controller = Pose(0.95, 0.0), arrival(False)
    braked = controller.target_velocity(there, np.array((0.2, 0.0, -0.5)), PATH, 1.5, 0.05)
    assert braked == pytest.approx((0.2 - 0.125, 0.0, -0.5 + 0.16))
    turning = controller.target_velocity(there, REST, PATH, 1.5, 0.05)
    assert turning.tolist() == [0.0, 0.0, 1.37]  # no slower than theta_min, though 0.05 s do not get there
    # it does not brake again for turning
    faster = controller.target_velocity(there, np.array((0.0, 0.0, 1.3)), PATH, 1.5, 0.05)
    assert faster[2] == pytest.approx(1.46)
    assert controller.target_velocity(there, np.array((0.0, 0.0, 1.3)), PATH, 0.1, 0.05).tolist() == [0.0, 0.0, 0.0]


def test_turn_goes_the_shorter_way_and_can_be_braked():
    for heading in (-3.0, -0.3, 0.4, 3.1):
        wz = arrival(False).target_velocity(Pose(1.0, 0.0), REST, PATH, heading, 10.0)[2]
        assert math.copysign(1.0, wz) == math.copysign(1.0, heading)
        assert abs(wz) <= max(1.37, math.sqrt(2.0 * 3.2 * abs(heading))) + 1e-9


def test_a_latched_robot_that_slips_away_goes_on_turning_until_there_is_a_new_path():
    slipped = Pose(0.85, 0.0)
    for latched in (True, False):
        controller = arrival(latched)
        controller.target_velocity(Pose(0.95, 0.0), REST, PATH, 1.5, 0.05)
        assert (controller.target_velocity(slipped, REST, PATH, 1.5, 0.05) is not None) == latched
        assert controller.target_velocity(slipped, REST, PATH.copy(), 1.5, 0.05) is None


@pytest.mark.parametrize("robot", ["turtlebot3", "jackal", "robotino"])
def test_as_released_ends_at_the_goals_heading(robot, build, costmap, observe):
    planner, pose, twist = build(robot, name="dwa_as_released", goal={"xy_tolerance": 0.3}), Pose(0.9, 0.05), Twist(0.0)
    goal, path = Pose(1.0, 0.0, 2.5), [(0.1 * k, 0.0) for k in range(11)]
    for _ in range(100):
        twist = planner.compute_velocity(replace(observe(costmap(), pose, path, twist), goal=goal))
        pose = pose.compose(Pose(0.05 * twist.vx, 0.05 * twist.vy, 0.05 * twist.wz))
    assert twist == Twist(0.0, 0.0, 0.0)
    assert pose.distance(goal) < 0.3
    assert abs(pose.theta - goal.theta) <= 0.17 + 1e-9
