import math
from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arena_core import Pose
from arena_core.testing import observation, planner, robot


@cache
def pursuer():
    return planner("pure_pursuit", robot())


def test_drives_straight_at_full_speed_to_a_waypoint_ahead():
    command = planner("pure_pursuit", robot()).compute_velocity(observation(waypoint=Pose(2.0, 0.0)))
    assert (command.vx, command.vy, command.wz) == (robot().limits.vx_max, 0.0, 0.0)


def test_turns_on_the_spot_to_a_waypoint_behind():
    command = planner("pure_pursuit", robot()).compute_velocity(observation(waypoint=Pose(-1.0, 0.1)))
    assert command.vx == 0.0
    assert command.wz > 0.0


@settings(derandomize=True, deadline=None)
@given(bearing=st.floats(-0.95, 0.95), distance=st.floats(0.5, 3.0), heading=st.floats(-3.0, 3.0))
def test_the_arc_leads_through_the_waypoint(bearing, distance, heading):
    waypoint = Pose(0.0, 0.0, heading).compose(Pose(distance * math.cos(bearing), distance * math.sin(bearing)))
    command = pursuer().compute_velocity(observation(pose=Pose(0.0, 0.0, heading), waypoint=waypoint))
    if abs(command.wz) < 1e-9:
        assert abs(bearing) < 1e-6
        return
    radius = command.vx / command.wz
    centre = np.array((-radius * math.sin(heading), radius * math.cos(heading)))
    assert np.hypot(*(np.array((waypoint.x, waypoint.y)) - centre)) == pytest.approx(abs(radius), rel=1e-6)
