import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arena_dwa.trajectory import compose_poses, planar_pose, pose_after_arc


@settings(derandomize=True, deadline=None)
@given(st.floats(-3.0, 3.0), st.floats(-1.0, 1.0), st.floats(-1.0, 1.0), st.floats(-3.0, 3.0), st.floats(0.0, 2.0))
def test_arc_equals_many_small_steps(theta, vx, vy, wz, time):
    x, y = 0.3, -0.2
    for k in range(1000):
        heading = theta + wz * time * (k + 0.5) / 1000
        x += (vx * math.cos(heading) - vy * math.sin(heading)) * time / 1000
        y += (vx * math.sin(heading) + vy * math.cos(heading)) * time / 1000
    expected = planar_pose(x, y, theta + wz * time)
    assert compose_poses(planar_pose(0.3, -0.2, theta), pose_after_arc(vx, vy, wz, time)) == pytest.approx(
        expected, abs=1e-4
    )


def test_two_half_arcs_make_a_whole_one():
    half = pose_after_arc(0.7, 0.1, 1.3, 0.5)
    assert compose_poses(half, half) == pytest.approx(pose_after_arc(0.7, 0.1, 1.3, 1.0))
