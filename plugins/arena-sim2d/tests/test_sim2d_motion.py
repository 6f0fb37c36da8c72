from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arena_core import Pose
from arena_core.testing import robot, scenario
from arena_kernels.motion import chassis_of, drive_arc, next_velocity

DT = 0.01
speed = st.floats(-1e3, 1e3)
commands = st.lists(st.tuples(speed, speed, speed), min_size=1, max_size=40)


def follow(kinematics, commands, share=1.0):
    """Return the velocities that a robot takes under commands within a share of its limits, one a tick,
    starting at rest; (K + 1, 3).
    """
    body = chassis_of(robot(kinematics))
    velocities = [np.zeros(3)]
    for command in commands:
        velocities.append(np.array(next_velocity(body, share, tuple(velocities[-1].tolist()), np.array(command), DT)))
    return np.array(velocities)


@pytest.mark.parametrize("kinematics", ["differential", "omnidirectional", "ackermann"])
@given(commands=commands, share=st.floats(0.01, 1.0))
@settings(derandomize=True, deadline=None)
def test_speeds_stay_within_the_share_of_the_limits_whatever_is_commanded(kinematics, commands, share):
    limits = robot(kinematics).limits
    vx, vy, wz = follow(kinematics, commands, share).T
    assert share * limits.vx_min <= vx.min()
    assert vx.max() <= share * limits.vx_max
    assert np.abs(vy).max() <= share * limits.vy_max
    assert np.abs(wz).max() <= share * limits.wz_max


@pytest.mark.parametrize("kinematics", ["differential", "omnidirectional", "ackermann"])
def test_a_robot_drives_as_fast_as_its_share_lets_it(kinematics):
    limits = robot(kinematics).limits
    ahead = follow(kinematics, [(9.0, 0.0, 0.0)] * 200, 0.4)[-1]
    assert ahead.tolist() == pytest.approx([0.4 * limits.vx_max, 0.0, 0.0])


@pytest.mark.parametrize("kinematics", ["differential", "omnidirectional"])
@given(commands=commands)
@settings(derandomize=True, deadline=None)
def test_accelerations_stay_within_the_limits_whatever_is_commanded(kinematics, commands):
    limits = robot(kinematics).limits
    ax, ay, alpha = np.abs(np.diff(follow(kinematics, commands), axis=0)).max(axis=0) / DT
    assert ax <= limits.ax_max + 1e-9
    assert ay <= limits.ay_max + 1e-9
    assert alpha <= limits.alpha_max + 1e-9


@given(commands=commands)
@settings(derandomize=True, deadline=None)
def test_car_never_turns_tighter_than_its_steering_allows(commands):
    body = robot("ackermann")
    velocities = follow("ackermann", commands)
    radius = body.wheelbase / np.tan(body.steering_max)
    assert (np.abs(velocities[:, 0]) >= radius * np.abs(velocities[:, 2]) - 1e-12).all()
    assert np.abs(np.diff(velocities[:, 0])).max() <= body.limits.ax_max * DT + 1e-12


def test_car_gathers_turn_rate_within_its_angular_acceleration():
    velocities = follow("ackermann", [(1.0, 0.0, 2.0)] * 100)
    assert np.diff(velocities[:, 2]).max() <= robot("ackermann").limits.alpha_max * DT + 1e-12
    assert velocities[-1, 2] == pytest.approx(2.0)


def test_car_does_not_turn_on_the_spot():
    assert not follow("ackermann", [(0.0, 0.0, 2.0)] * 10).any()


def test_car_keeps_the_commanded_curvature_while_it_speeds_up():
    velocities = follow("ackermann", [(1.0, 0.0, 0.5)] * 30)[1:]
    np.testing.assert_allclose(velocities[:, 2], 0.5 * velocities[:, 0])


@given(st.tuples(*[st.floats(-3.0, 3.0)] * 3), st.floats(1e-3, 0.5))
@settings(derandomize=True, deadline=None)
def test_arc_is_that_of_many_small_steps(velocity, seconds):
    x, y, theta = 1.0, 2.0, 0.5
    count = 2000
    h = seconds / count
    for _ in range(count):
        middle = theta + velocity[2] * h / 2
        x += h * (np.cos(middle) * velocity[0] - np.sin(middle) * velocity[1])
        y += h * (np.sin(middle) * velocity[0] + np.cos(middle) * velocity[1])
        theta += velocity[2] * h
    pose = drive_arc((1.0, 2.0, 0.5), velocity, seconds)
    assert pose[:2] == pytest.approx((x, y), abs=1e-6)
    assert pose[2] == pytest.approx((theta + np.pi) % (2 * np.pi) - np.pi, abs=1e-9)


@pytest.mark.parametrize("turn", [1e-9, 1e-3, 0.0999999])
def test_gentle_arc_is_exact_to_rounding(turn):
    x, y, theta = drive_arc((0.0, 0.0, 0.0), (1.0, 0.0, turn), 1.0)
    assert (x, y) == pytest.approx((np.sin(turn) / turn, 2.0 * np.sin(turn / 2.0) ** 2 / turn), rel=1e-14)
    assert theta == pytest.approx(turn)


def test_every_world_of_a_batch_has_the_share_of_its_scenario(simulate):
    shares = (1.0, 0.5, 0.25)
    together, alone = simulate(robot()), simulate(robot())
    problems = [replace(scenario(start=Pose(-3.0, 0.0, 0.0)), speed_share=share) for share in shares]
    together.reset(problems)
    for _ in range(10):
        many = together.advance(np.tile((9.0, 0.0, 0.0), (3, 1)), 10)
    assert many.twists[:, 0].tolist() == pytest.approx(shares)
    alone.reset([problems[1]])
    for _ in range(10):
        one = alone.advance(np.array([[9.0, 0.0, 0.0]]), 10)
    assert one.poses[0].tobytes() == many.poses[1].tobytes()


def test_commands_are_held_for_the_whole_advance(simulate):
    one, many = simulate(robot()), simulate(robot())
    one.reset([scenario(start=Pose(-1.5, 0.0, 0.3))])
    many.reset([scenario(start=Pose(-1.5, 0.0, 0.3))])
    command = np.array([[0.8, 0.0, 0.5]])
    together = one.advance(command, 30)
    for _ in range(30):
        apart = many.advance(command, 1)
    assert together.poses.tolist() == apart.poses.tolist()
    assert together.stamps[0] == pytest.approx(0.3)
