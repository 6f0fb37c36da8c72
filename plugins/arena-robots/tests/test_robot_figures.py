"""Every robot's YAML builds a robot, and its figures agree with each other."""

import math
import re
from importlib.resources import files
from typing import Any

import numpy as np
import pytest
import yaml

from arena_core import Lidar, OdometryModel, Pose, Robot, VelocityLimits, make_robot
from arena_core.contracts.hookspecs import Factory
from arena_core.values.robot import FootprintShape
from arena_robots import ROBOTS, config_package, register_robots

CONF = files("arena_robots.conf") / "robot"


def read(name: str) -> dict[str, Any]:
    return dict(yaml.safe_load((CONF / f"{name}.yaml").read_text()))


def build(name: str) -> Robot:
    figures = read(name)
    lidar = figures.pop("lidar")
    mount = Pose(**lidar.pop("mount"))
    return make_robot(
        footprint=FootprintShape(**figures.pop("footprint")),
        limits=VelocityLimits(**figures.pop("limits")),
        lidar=Lidar(**lidar, mount=mount),
        odometry=OdometryModel(**figures.pop("odometry")),
        **figures,
    )


def test_hooks_offer_every_yaml_file_by_its_own_name() -> None:
    registered: dict[str, Factory] = {}

    def register(name: str, factory: Factory) -> None:
        registered[name] = factory

    register_robots(register)
    assert sorted(registered) == sorted(file.name[:-5] for file in CONF.iterdir())
    assert set(registered.values()) == {"arena_core:make_robot"}
    assert all(read(name)["name"] == name for name in ROBOTS)
    assert config_package() == "arena_robots.conf"


@pytest.mark.parametrize("name", ROBOTS)
def test_every_number_has_a_unit(name: str) -> None:
    lines = (CONF / f"{name}.yaml").read_text().splitlines()
    values = [line for line in lines if re.match(r"\s*\w+: +[-\d.\[n]", line)]
    assert len(values) > 20
    assert [line for line in values if not re.search(r"# \[[^\]]+\]", line)] == []


@pytest.mark.parametrize(
    ("name", "kinematics", "radius", "speed", "beams", "field"),
    [
        ("turtlebot3", "differential", 0.113, 0.22, 360, 2 * math.pi * 359 / 360),
        ("jackal", "differential", 0.267, 2.0, 720, 4.712),
        ("robotino", "omnidirectional", 0.225, 2.78, 552, 4.8),
        ("jackal_ackermann", "ackermann", 0.379, 2.0, 720, 4.712),
    ],
)
def test_robot_has_its_published_figures(
    name: str, kinematics: str, radius: float, speed: float, beams: int, field: float
) -> None:
    robot = build(name)
    assert robot.kinematics == kinematics
    assert robot.footprint.radius == pytest.approx(radius, abs=5e-4)
    assert robot.limits.vx_max == speed
    assert robot.limits.vy_max == (speed if robot.holonomic else 0.0)
    assert robot.lidar.beams == beams
    angles = robot.lidar.angles()
    assert angles[-1] - angles[0] == pytest.approx(field, abs=1e-9)


@pytest.mark.parametrize("name", ROBOTS)
def test_periods_are_multiples_of_an_inner_step_of_20_ms(name: str) -> None:
    robot = build(name)
    for period in (robot.control_period, robot.lidar.period, robot.odometry.period):
        assert period / 0.02 == pytest.approx(round(period / 0.02))


def test_beams_of_a_full_circle_do_not_overlap() -> None:
    lidar = build("turtlebot3").lidar
    assert lidar.beams * lidar.angle_increment == pytest.approx(2 * math.pi)


def test_lidar_sits_inside_the_footprint() -> None:
    for robot in map(build, ROBOTS):
        assert math.hypot(robot.lidar.mount.x, robot.lidar.mount.y) < robot.footprint.radius


def test_ackermann_jackal_is_the_jackal_seen_from_its_rear_axle() -> None:
    jackal, steered = build("jackal"), build("jackal_ackermann")
    shift = steered.wheelbase / 2
    assert steered.footprint.vertices_xy == pytest.approx(jackal.footprint.vertices_xy + np.array((shift, 0.0)))
    assert steered.lidar.mount.x == pytest.approx(jackal.lidar.mount.x + shift)
    assert 0.4 < steered.wheelbase / math.tan(steered.steering_max) < 0.6
