from dataclasses import replace

import numpy as np
import pytest

from arena_core import Pose
from arena_core.testing import component, robot, scenario

COMMANDS = {
    "turtlebot3": (0.2, 0.0, 0.5),
    "jackal": (1.0, 0.0, 0.5),
    "robotino": (1.0, 0.5, 0.5),
    "jackal_ackermann": (1.0, 0.0, 1.0),
}


def path(simulator, command, steps=40):
    simulator.reset([replace(scenario(start=Pose(-2.0, -2.0, 0.3)), obstacles=())])
    return [simulator.advance(np.array([command], float), 10) for _ in range(steps)]


@pytest.mark.parametrize("name", COMMANDS)
def test_planar_base_drives_as_in_the_plane(simulate, known, name):
    body = known(name)
    crowd = component("pedestrians", "social_force")
    flat = path(component("simulator", "sim2d", robot=body, pedestrians=crowd), COMMANDS[name])
    there = path(simulate(body, f"robot={name}"), COMMANDS[name])
    apart = [np.hypot(*(a.poses[0, :2] - b.poses[0, :2])) for a, b in zip(flat, there, strict=True)]
    assert max(apart) < 0.02
    assert there[-1].twists[0] == pytest.approx(COMMANDS[name], abs=1e-3)


@pytest.mark.parametrize("name", COMMANDS)
def test_wheels_drive_roughly_as_commanded_and_odometry_misses_what_slips(simulate, known, name):
    body = known(name)
    simulator = simulate(body, f"robot={name}", "simulator.drive=wheels")
    last = path(simulator, COMMANDS[name])[-1]
    assert not last.failures
    assert last.twists[0] == pytest.approx(COMMANDS[name], abs=0.25 if name == "jackal" else 0.06)
    assert last.odometry_twists[0] == pytest.approx(COMMANDS[name], abs=0.03)
    by_wheels = Pose(-2.0, -2.0, 0.3).compose(Pose.of(last.odometry_poses[0]))
    assert 1e-4 < by_wheels.distance(Pose.of(last.poses[0])) < 0.6


def test_skid_steer_turns_on_the_spot_nearly_as_its_maker_reckons(simulate, known):
    snapshots = path(simulate(known("jackal"), "robot=jackal", "simulator.drive=wheels"), (0.0, 0.0, 1.5))
    rates = [snapshot.twists[0, 2] for snapshot in snapshots[10:]]
    assert np.mean(rates) == pytest.approx(1.5, abs=0.15)


@pytest.mark.parametrize("kinematics", ["differential", "omnidirectional", "ackermann"])
def test_robot_of_a_yaml_alone_gets_wheels_that_drive_it(simulate, kinematics):
    last = path(simulate(robot(kinematics), "simulator.drive=wheels"), (0.5, 0.0, 0.3))[-1]
    assert last.twists[0] == pytest.approx((0.5, 0.0, 0.3), abs=0.05)


def test_same_command_on_a_slippery_floor_takes_longer(simulate, known):
    def seconds_to_half_speed(friction):
        simulator = simulate(
            known("jackal"), "robot=jackal", "simulator.drive=wheels", f"simulator.floor_friction={friction}"
        )
        return next(s.stamps[0] for s in path(simulator, (2.0, 0.0, 0.0)) if s.twists[0, 0] > 1.0)

    assert seconds_to_half_speed(0.1) > 2.0 * seconds_to_half_speed(0.8)
