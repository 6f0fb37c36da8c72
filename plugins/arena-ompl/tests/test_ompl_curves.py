import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from ompl import base

from arena_ompl.curves import DUBINS, REEDS_SHEPP, STRAIGHT, pose_along, shortest_curve

COORDINATE = st.floats(-6.0, 6.0) | st.sampled_from((0.0, 1.0, -1.0))
HEADING = st.floats(-10.0, 10.0) | st.sampled_from((0.0, math.pi, -math.pi / 2))
POSE = st.tuples(COORDINATE, COORDINATE, HEADING)
SPACES = {DUBINS: base.DubinsStateSpace, REEDS_SHEPP: base.ReedsSheppStateSpace}


def curve(
    kind: int, radius: float, start: tuple[float, float, float], end: tuple[float, float, float]
) -> tuple[float, np.ndarray]:
    pieces = np.empty((5, 2))
    return shortest_curve(kind, radius, tuple(start), tuple(end), pieces), pieces


def length_by_ompl(kind: int, radius: float, *poses: tuple[float, float, float]) -> float:
    space = SPACES[kind](radius)
    states = []
    for x, y, theta in poses:
        state = space.allocState()
        state.setXY(x, y)
        state.setYaw(math.remainder(theta, 2.0 * math.pi))
        states.append(state)
    return float(space.distance(*states))


@settings(derandomize=True, deadline=None, max_examples=300)
@given(st.sampled_from((DUBINS, REEDS_SHEPP)), st.floats(0.2, 3.0), POSE, POSE)
def test_curves_end_where_they_should_and_are_as_short_as_ompls(kind, radius, start, end) -> None:
    heading, pieces = curve(kind, radius, start, end)
    pose = (start[0], start[1], heading)
    for turn, length in pieces:
        pose = pose_along(radius, pose, turn, length)
    assert math.dist(pose[:2], end[:2]) < 1e-6
    assert math.remainder(pose[2] - end[2], 2.0 * math.pi) == pytest.approx(0.0, abs=1e-6)
    assert np.abs(pieces[:, 1]).sum() == pytest.approx(length_by_ompl(kind, radius, start, end), abs=1e-6)


@settings(derandomize=True, deadline=None, max_examples=100)
@given(POSE, POSE)
def test_dubins_curves_never_run_backwards(start, end) -> None:
    assert (curve(DUBINS, 0.7, start, end)[1][:, 1] >= 0.0).all()


def test_a_straight_line_has_the_heading_of_its_direction() -> None:
    heading, pieces = curve(STRAIGHT, 1.0, (1.0, 1.0, 3.0), (1.0, 4.0, -2.0))
    assert heading == pytest.approx(math.pi / 2)
    assert pieces[0].tolist() == [0.0, 3.0]
    assert not pieces[1:].any()


def test_parking_sideways_is_shorter_backwards_and_forwards() -> None:
    ahead = np.abs(curve(DUBINS, 1.0, (0.0, 0.0, 0.0), (0.0, 0.5, 0.0))[1][:, 1]).sum()
    both = curve(REEDS_SHEPP, 1.0, (0.0, 0.0, 0.0), (0.0, 0.5, 0.0))[1][:, 1]
    assert (both < 0.0).any()
    assert np.abs(both).sum() < 0.5 * ahead
