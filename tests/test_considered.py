"""What planners of the suite say that they considered."""

import math

import numpy as np
import pytest

from arena_core import Pose
from arena_core.loop.extras import kept_candidates
from arena_core.testing import samples


def told(name):
    body = samples.robot()
    planner = samples.planner(name, body)
    planner.reset(samples.episode_start(body))
    assert kept_candidates(planner.considered(), name) == []
    pose = Pose(-2.0, 0.3, 0.4)
    command = planner.compute_velocity(samples.observation(pose, Pose(0.0, 0.0), Pose(2.5, 0.0), body=body))
    return pose, command, kept_candidates(planner.considered(), name)


@pytest.mark.parametrize("name", ["dwa", "teb", "mpc", "mppi"])
def test_ways_begin_at_the_robot_and_one_is_driven(name):
    pose, command, ways = told(name)
    assert [way.chosen for way in ways].count(True) == 1
    for way in ways:
        assert np.hypot(*(way.points_xy[0] - (pose.x, pose.y))) < 0.05
    (driven,) = (way for way in ways if way.chosen)
    heading = math.atan2(*(driven.points_xy[2] - driven.points_xy[0])[::-1]) if command.vx > 0.05 else pose.theta
    assert abs(heading - pose.theta) < 0.8


@pytest.mark.parametrize("name", ["dwa", "mppi"])
def test_samplers_tell_many(name):
    _, _, ways = told(name)
    assert len(ways) > 10
    assert len({round(way.cost, 6) for way in ways if math.isfinite(way.cost)}) > 5
