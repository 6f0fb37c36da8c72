"""A robot is a YAML file in a third-party package: it drives with every planner."""

import csv
from pathlib import Path

import pytest

ROBOT = """
    name: scout
    kinematics: differential
    control_period: 0.1  # [s]
    wheelbase: 0.0  # [m]
    steering_max: 0.0  # [rad]
    footprint:
      radius: null  # [m]
      vertices_xy: [[0.3, 0.2], [-0.3, 0.2], [-0.3, -0.2], [0.3, -0.2]]  # [m]
    limits:
      vx_min: -0.3  # [m/s]
      vx_max: 0.9  # [m/s]
      vy_max: 0.0  # [m/s]
      wz_max: 1.8  # [rad/s]
      ax_max: 1.5  # [m/s^2]
      ay_max: 0.0  # [m/s^2]
      alpha_max: 3.0  # [rad/s^2]
    lidar:
      beams: 270  # [-]
      angle_min: -2.356  # [rad]
      angle_increment: 0.01745  # [rad]
      range_min: 0.05  # [m]
      range_max: 12.0  # [m]
      period: 0.1  # [s]
      noise_std: 0.01  # [m]
      mount: {x: 0.2, y: 0.0, theta: 0.0}
    odometry:
      period: 0.02  # [s]
      alpha1: 0.1  # [-]
      alpha2: 0.1  # [rad^2/m^2]
      alpha3: 0.1  # [-]
      alpha4: 0.001  # [m^2/rad^2]
"""
HOOKS = """
    from arena_core import hookimpl

    @hookimpl
    def register_robots(register):
        register("scout", "arena_core:make_robot")

    @hookimpl
    def config_package():
        return "scout.conf"
"""


@pytest.fixture
def scout(third_party):
    third_party.package("scout", HOOKS, {"robot/scout": ROBOT})


def test_keeps_the_contract_of_a_robot(scout, arena):
    answer = arena("check", "robot=scout")
    assert (answer.status, answer.errors) == (0, [])


@pytest.mark.slow
def test_drives_to_its_goal(scout, arena):
    words = (
        "planner=dwa",
        "robot=scout",
        "world=warehouse",
        "task.pedestrians=0",
        "episodes=1",
        "executor=serial",
        "report=false",
    )
    answer = arena("run", *words, "hydra.run.dir=run")
    assert answer.status == 0
    with Path("run/episodes.csv").open(newline="") as file:
        (row,) = csv.DictReader(file)
    assert (row["robot"], row["outcome"]) == ("scout", "goal_reached")


OWN = """
defaults:
  - jackal
  - _self_

limits:
  vx_max: 0.8  # [m/s]
"""


@pytest.mark.slow
def test_a_robot_of_ones_own_folder_carries_its_own_name_without_a_package(arena):
    for path, text in {
        "robot/jackal_slow": OWN,
        "world/hall": "defaults:\n  - empty\n  - _self_\nwidth: 9.0\nheight: 9.0\n",
    }.items():
        Path("conf", path).parent.mkdir(parents=True, exist_ok=True)
        Path("conf", f"{path}.yaml").write_text(text)
    words = (
        "planner=dwa",
        "robot=jackal_slow",
        "world=hall",
        "localizer=ground_truth",
        "task.pedestrians=0",
        "episodes=1",
        "executor=serial",
    )
    answer = arena("run", *words, "hydra.run.dir=run")
    assert answer.status == 0
    assert any("untuned for jackal_slow" in line for line in answer.errors)
    with Path("run/episodes.csv").open(newline="") as file:
        (row,) = csv.DictReader(file)
    assert (row["robot"], row["world"]) == ("jackal_slow", "hall")
    assert "jackal_slow" in Path("run/report/index.html").read_text()
    assert "robot=jackal_slow" in arena("list", "preset").out
