import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arena_core import Pose
from arena_dwa.parameters import TurnParameters
from arena_dwa.turning import TurnInPlace, path_bearing

PATH = np.column_stack((np.linspace(0.0, 4.0, 81), np.zeros(81), np.zeros(81)))
ANY = np.array(((-0.25, 0.25), (0.0, 0.0), (-0.32, 0.32)))


def turn(begin=1.8):
    return TurnInPlace(TurnParameters(begin, 0.2, 0.5), 3.2, differential=True)


def test_robot_that_faces_the_path_is_left_alone():
    assert turn().turn_window(ANY, Pose(0.0, 0.0, 1.7), 0.0, PATH) is None


def test_robot_with_its_back_to_the_path_may_only_turn_towards_it():
    window = turn().turn_window(ANY, Pose(0.0, 0.0, 2.5), 0.0, PATH)
    assert window.tolist() == [[0.0, 0.0], [0.0, 0.0], [-0.32, -0.32]]


def test_turn_once_begun_goes_on_until_the_path_is_ahead():
    shim = turn()
    for theta in (2.5, 1.0, 0.3):
        assert shim.turn_window(ANY, Pose(0.0, 0.0, theta), 0.0, PATH) is not None
    assert shim.turn_window(ANY, Pose(0.0, 0.0, 0.1), 0.0, PATH) is None


def test_nothing_is_narrowed_where_turning_is_switched_off():
    assert turn(None).turn_window(ANY, Pose(0.0, 0.0, 3.0), 0.0, PATH) is None


def test_a_robot_that_moves_is_braked_as_hard_as_the_window_allows():
    moving = np.array(((0.1, 0.2), (0.0, 0.0), (-0.32, 0.32)))
    assert turn().turn_window(moving, Pose(0.0, 0.0, 3.0), 0.0, PATH)[0].tolist() == [0.1, 0.1]


@pytest.mark.parametrize(("wz", "side"), [(0.0, 1.0), (0.9, 1.0), (1.3, -1.0)])
def test_the_turn_goes_the_shorter_way_from_where_the_robot_could_stop(wz, side):
    """The path lies 2.9 rad to the left. While it brakes with 3.2 rad/s^2 the robot turns on by wz^2 / 6.4."""
    free = np.array(((0.0, 0.0), (0.0, 0.0), (-9.0, 9.0)))
    found = turn().turn_window(free, Pose(0.0, 0.0, -2.9), -wz, PATH)
    assert found[2].tolist() == pytest.approx([side * math.sqrt(3.2 * 2.9)] * 2, rel=0.01)


@settings(derandomize=True, deadline=None)
@given(theta=st.floats(-3.1, 3.1), wz=st.floats(-2.8, 2.8))
def test_the_turn_comes_to_rest_facing_the_path(theta, wz):
    shim, period = turn(), 0.1
    if abs(theta) <= 1.8:
        theta = math.copysign(2.5, theta)
    for _ in range(100):
        window = shim.turn_window(
            np.array(((0.0, 0.0), (0.0, 0.0), (max(wz - 0.32, -2.84), min(wz + 0.32, 2.84)))),
            Pose(0.0, 0.0, theta),
            wz,
            PATH,
        )
        if window is None:
            break
        wz = float(window[2, 0])
        theta += wz * period
    assert window is None
    assert abs(math.remainder(theta, 2.0 * math.pi)) <= 0.2
    assert abs(wz) <= 1.2


def test_bearing_is_taken_ahead_of_the_nearest_point():
    assert path_bearing(Pose(1.0, 0.5, 0.0), PATH, 0.5) == pytest.approx(math.atan2(-0.5, 0.5))


def test_bearing_of_a_path_that_ends_sooner_is_that_of_its_end():
    assert path_bearing(Pose(4.2, 0.0, 0.0), PATH, 0.5) == pytest.approx(math.pi)
