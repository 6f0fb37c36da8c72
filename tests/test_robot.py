import math
from dataclasses import replace

import numpy as np
import pytest

from arena_core import ConfigurationError, Pose, make_robot
from arena_core.testing import robot
from arena_core.values.robot import FootprintShape

SAMPLE = robot()
FIGURES = {
    "name": "mine",
    "kinematics": "differential",
    "footprint": FootprintShape(0.2, None),
    "limits": SAMPLE.limits,
    "lidar": SAMPLE.lidar,
    "odometry": SAMPLE.odometry,
    "control_period": 0.1,
    "wheelbase": 0.0,
    "steering_max": 0.0,
}
BOX = [[-0.2, -0.1], [0.2, -0.1], [0.2, 0.1], [-0.2, 0.1]]


def test_figures_make_a_robot():
    mine = make_robot(**FIGURES)
    assert (mine.name, mine.footprint.radius, mine.holonomic) == ("mine", 0.2, False)


def test_an_omnidirectional_robot_is_holonomic():
    limits = replace(SAMPLE.limits, vy_max=1.0, ay_max=1.0)
    assert make_robot(**{**FIGURES, "kinematics": "omnidirectional", "limits": limits}).holonomic


def test_vertices_make_a_polygon():
    assert not make_robot(**{**FIGURES, "footprint": FootprintShape(None, BOX)}).footprint.is_circle


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"footprint": FootprintShape(0.2, BOX)}, "either radius or vertices_xy"),
        ({"footprint": FootprintShape(None, None)}, "either radius or vertices_xy"),
        ({"kinematics": "ackermann"}, "wheelbase and steering_max must be > 0"),
        ({"kinematics": "ackermann", "wheelbase": 0.3}, "wheelbase and steering_max must be > 0"),
        ({"limits": replace(SAMPLE.limits, vy_max=0.5)}, "limits.vy_max is 0.5; allowed: 0 for differential"),
        ({"lidar": replace(SAMPLE.lidar, range_min=9.0)}, "lidar.range_min is 9.0; allowed: below range_max 8.0"),
    ],
)
def test_figures_that_contradict_each_other_are_named(change, message):
    with pytest.raises(ConfigurationError, match=f"robot mine: .*{message}"):
        make_robot(**{**FIGURES, **change})


def test_beams_run_counter_clockwise_from_the_first_angle():
    lidar = replace(SAMPLE.lidar, beams=4, angle_min=-1.0, angle_increment=0.5, mount=Pose(0.1, 0.0))
    assert np.allclose(lidar.angles(), [-1.0, -0.5, 0.0, 0.5])


def test_limits_that_are_not_wanted_otherwise_are_the_robots_own():
    assert SAMPLE.limits_with(vx_max=None, wz_max=None) == SAMPLE.limits
    assert SAMPLE.limits_with(vx_max=9, ax_max=None) == replace(SAMPLE.limits, vx_max=9.0)


def test_only_a_robot_that_moves_sideways_plans_to():
    assert SAMPLE.limits_with(vy_max=0.4).vy_max == 0.0
    assert robot("omnidirectional").limits_with(vy_max=0.4).vy_max == 0.4


def test_only_a_robot_that_steers_has_a_turn_radius():
    car = robot("ackermann")
    assert SAMPLE.turn_radius == 0.0
    assert car.turn_radius == car.wheelbase / math.tan(car.steering_max)
