import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arena_core import ConfigurationError, InvalidCommand
from arena_core.testing import robot
from arena_policies.actions import ActionRange, ActionScale

WHOLE = ActionRange(None, None, None, None, None)
FORWARDS = ActionRange(0.0, None, None, None, None)


def test_ends_of_an_action_are_the_robots_limits():
    body = robot("omnidirectional")
    commands = ActionScale.of(body, WHOLE).commands(np.array([(1.0, 1.0, 1.0), (-1.0, -1.0, -1.0)]))
    limits = body.limits
    assert commands.tolist() == [
        [limits.vx_max, limits.vy_max, limits.wz_max],
        [limits.vx_min, -limits.vy_max, -limits.wz_max],
    ]


def test_robot_that_only_drives_forwards_stands_at_minus_one():
    body = robot()
    scale = ActionScale.of(body, FORWARDS)
    assert scale.names == ("vx", "wz")
    assert scale.commands(np.array([(-1.0, 0.0), (0.0, 1.0)])).tolist() == [
        [0.0, 0.0, 0.0],
        [body.limits.vx_max / 2, 0.0, body.limits.wz_max],
    ]


def test_car_turns_as_its_steering_angle_and_speed_say():
    body = robot("ackermann")
    scale = ActionScale.of(body, FORWARDS)
    assert scale.names == ("vx", "steering")
    command = scale.commands(np.array([(0.0, 0.5)]))[0]
    wanted = command[0] * np.tan(0.5 * body.steering_max) / body.wheelbase
    assert command[2] == pytest.approx(min(wanted, body.limits.wz_max))
    assert scale.commands(np.array([(-1.0, 1.0)]))[0].tolist() == [0.0, 0.0, 0.0], "a car that stands does not turn"


@pytest.mark.parametrize("drive", ["differential", "omnidirectional", "ackermann"])
@settings(derandomize=True, deadline=None)
@given(numbers=st.lists(st.floats(-3, 3, width=32), min_size=12, max_size=12))
def test_commands_keep_the_limits_and_do_not_depend_on_the_batch(drive, numbers):
    body = robot(drive)
    scale = ActionScale.of(body, WHOLE)
    actions = np.array(numbers, np.float32).reshape(4, 3)[:, : len(scale.names)]
    commands, limits = scale.commands(actions), body.limits
    assert (commands <= (limits.vx_max, limits.vy_max, limits.wz_max)).all()
    assert (commands >= (limits.vx_min, -limits.vy_max, -limits.wz_max)).all()
    assert all((scale.commands(actions[k : k + 1])[0] == commands[k]).all() for k in range(4))


def test_action_that_is_no_number_is_refused():
    with pytest.raises(InvalidCommand, match="not finite"):
        ActionScale.of(robot(), WHOLE).commands(np.array([(np.nan, 0.0)]))


@pytest.mark.parametrize("wrong", [{"vx_max": 99.0}, {"vx_min": -99.0}, {"wz_max": 99.0}, {"vx_min": float("nan")}])
def test_range_beyond_the_robots_limits_is_refused(wrong):
    numbers = {"vx_min": None, "vx_max": None, "vy_max": None, "wz_max": None, "steering_max": None} | wrong
    with pytest.raises(ConfigurationError, match=rf"action\.{next(iter(wrong))} is .*; allowed: "):
        ActionScale.of(robot(), ActionRange(**numbers))


@pytest.mark.parametrize("drive", ["differential", "omnidirectional", "ackermann"])
@settings(derandomize=True, deadline=None)
@given(numbers=st.lists(st.floats(-0.9, 0.9), min_size=12, max_size=12))
def test_action_of_a_command_gives_that_command(drive, numbers):
    scale = ActionScale.of(robot(drive), WHOLE)
    commands = scale.commands(np.array(numbers).reshape(4, 3)[:, : len(scale.names)])
    assert scale.commands(scale.actions(commands)) == pytest.approx(commands, abs=1e-9)


def test_command_beyond_the_range_is_met_as_far_as_it_goes():
    scale = ActionScale.of(robot(), FORWARDS)
    assert scale.actions(np.array([(-1.0, 0.0, 99.0)])).tolist() == [[-1.0, 1.0]]
    assert ActionScale.of(robot("ackermann"), WHOLE).actions(np.array([(0.0, 0.0, 1.0)]))[0, 1] == 0.0, (
        "a car that stands: straight on"
    )


def test_range_of_no_width_gives_a_number():
    assert (
        ActionScale.of(robot("omnidirectional"), ActionRange(0.0, None, 0.0, None, None)).actions(np.ones((1, 3)))[0, 1]
        == 1.0
    )
