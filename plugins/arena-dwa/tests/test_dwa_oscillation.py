import numpy as np

from arena_core import Pose, Twist
from arena_dwa.oscillation import OscillationFlags, is_oscillating
from arena_dwa.parameters import OscillationParameters


def flags_after(*commands, still_below=0.0):
    flags = OscillationFlags(OscillationParameters(0.05, 0.2, 2.0), still_below)
    for command in commands:
        flags.record_command(0.0, Pose(0.0, 0.0), Twist(*command))
    return flags


def test_reversal_forbids_the_old_direction():
    flags = flags_after((0.2, 0.0, 0.0), (-0.1, 0.0, 0.0))
    assert is_oscillating(flags.only, 0.1, 0.0, 0.0)
    assert not is_oscillating(flags.only, -0.1, 0.0, 0.5)
    assert not is_oscillating(flags.only, 0.0, 0.0, 0.5)


def test_turning_back_on_the_spot_is_forbidden_but_not_while_driving():
    assert flags_after((0.0, 0.0, 1.0), (0.0, 0.0, -1.0)).only.tolist() == [0, 0, -1]
    assert flags_after((0.2, 0.0, 1.0), (0.2, 0.0, -1.0)).only.tolist() == [0, 0, 0]


def test_strafing_back_is_forbidden():
    assert flags_after((0.0, 0.4, 0.0), (0.0, -0.4, 0.0)).only.tolist() == [0, -1, 0]


def test_flags_fall_when_the_robot_has_moved_on():
    flags = flags_after((0.2, 0.0, 0.0), (-0.1, 0.0, 0.0))
    flags.record_command(0.1, Pose(-0.04, 0.0), Twist(-0.1))
    assert flags.only.any()
    flags.record_command(0.1, Pose(-0.06, 0.0), Twist(-0.1))
    assert not flags.only.any()


def test_flags_fall_when_the_robot_has_turned():
    flags = flags_after((0.0, 0.0, 1.0), (0.0, 0.0, -1.0))
    flags.record_command(0.1, Pose(0.0, 0.0, -0.25), Twist(0.0, 0.0, -1.0))
    assert not flags.only.any()


def test_flags_fall_with_time_so_that_a_waiting_robot_can_turn_back():
    flags = flags_after((0.0, 0.0, 1.0), (0.0, 0.0, -1.0))
    flags.record_command(1.9, Pose(0.0, 0.0), Twist(0.0))
    assert flags.only.any()
    flags.record_command(2.1, Pose(0.0, 0.0), Twist(0.0))
    assert not flags.only.any()


def test_nothing_is_forbidden_at_first():
    assert not is_oscillating(np.zeros(3, np.int8), 1.0, -1.0, 1.0)
