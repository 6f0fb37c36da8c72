from dataclasses import replace

import numpy as np
import pytest

from arena_core import ConfigurationError, ImpossibleScenario, Obstacle, Pose
from arena_core.testing import robot, scenario
from arena_core.testing.samples import person


@pytest.mark.parametrize(
    ("start", "words"),
    [
        (Pose(4.9, 0.0), "overlaps a wall"),
        (Pose(7.0, 0.0), "lies outside the map"),
        (Pose(1.0, 1.2), "overlaps a person"),
        (Pose(-1.0, 0.1), "overlaps an obstacle"),
    ],
)
def test_start_that_is_not_free_is_refused(simulate, start, words):
    problem = replace(
        scenario(start=start, people=[person(1, 1.0, 1.0)]), obstacles=(Obstacle(np.array([[-1.0, 0.0]]), 0.2),)
    )
    with pytest.raises(ImpossibleScenario, match=f"sample/0: the robot's start .* {words}"):
        simulate(robot()).reset([problem])


@pytest.mark.parametrize("vertices", [[[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]], [[2.0, 0.0], [3.0, 0.0]]])
def test_obstacle_that_is_no_simple_polygon_is_refused(simulate, vertices):
    with pytest.raises(ImpossibleScenario, match="no simple polygon"):
        simulate(robot()).reset([replace(scenario(), obstacles=(Obstacle(np.array(vertices)),))])


def test_unknown_cells_block_neither_beams_nor_bodies(simulate):
    problem = scenario(start=Pose(0.0, 0.0, 0.0))
    data = problem.world.grid.data.copy()
    data[100:, 110:190] = -1
    grid = replace(problem.world.grid, data=data, _derived={})
    simulator = simulate(robot())
    seen = simulator.reset([replace(problem, world=replace(problem.world, grid=grid))])
    assert seen.ranges[0, 90] == pytest.approx(4.95, abs=1e-4)
    assert simulator.advance(np.array([[1.0, 0.0, 0.0]]), 200).poses[0, 0] > 1.2


@pytest.mark.parametrize(
    ("part", "values", "words"),
    [
        ("lidar", {"period": 0.033}, "lidar.period of sample is 0.033 s"),
        ("odometry", {"period": 0.005}, "odometry.period of sample is 0.005 s"),
    ],
)
def test_period_that_is_no_multiple_of_the_inner_step_is_refused(simulate, alter, part, values, words):
    with pytest.raises(ConfigurationError, match=words):
        simulate(alter(robot(), part, **values))


def test_control_and_crowd_periods_must_be_multiples_too(simulate):
    with pytest.raises(ConfigurationError, match="control_period of sample"):
        simulate(replace(robot(), control_period=0.125))
    with pytest.raises(ConfigurationError, match=r"crowd_period is 0\.045 s; allowed: a multiple"):
        simulate(robot(), "simulator.crowd_period=0.045")
