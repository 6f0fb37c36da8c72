"""Whole drives in simulation: the same runs as those whose figures docs/localization.md states."""

import importlib.util
import sys
from pathlib import Path

import numpy as np
import pytest

from arena_core import Pose

ROOT = Path(__file__).resolve().parents[3]
MAPS = ROOT.parent / "shared" / "data" / "maps"
WORLDS = {
    "warehouse": None,
    "turtlebot3": MAPS / "turtlebot3" / "map.yaml",
    "aws_small_warehouse": MAPS / "aws_small_warehouse" / "005" / "map.yaml",
    "depot": MAPS / "nav2" / "depot.yaml",
}


@pytest.fixture(scope="module")
def drives():
    spec = importlib.util.spec_from_file_location("localization_error", ROOT / "benchmarks" / "localization_error.py")
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module.run_drives


def overrides(world, robot, people):
    path = WORLDS[world]
    if path is not None and not path.exists():
        pytest.skip(f"{path} is not there")
    place = [f"world={world}"] if path is None else ["world=ros_map", f"world.path={path}"]
    return [*place, f"robot={robot}", f"task.pedestrians={people}"]


def mean_errors(driven, name):
    return np.array([drive.errors[name].mean() for drive in driven])


@pytest.mark.slow
@pytest.mark.parametrize(
    ("world", "robot", "people"),
    [
        pytest.param("warehouse", "turtlebot3", 5, marks=pytest.mark.long),  # it drives for minutes
        ("warehouse", "jackal", 5),
        ("warehouse", "robotino", 5),
        ("turtlebot3", "turtlebot3", 0),
        pytest.param("aws_small_warehouse", "turtlebot3", 3, marks=pytest.mark.long),
        ("depot", "robotino", 5),
    ],
)
def test_amcl_is_within_a_decimetre_where_odometry_drifts_three_times_as_far(drives, world, robot, people):
    driven = drives(overrides(world, robot, people), ["amcl", "odometry"], 3)
    assert sum(drive.travelled for drive in driven) > 8.0
    assert mean_errors(driven, "amcl").max() < 0.1
    assert mean_errors(driven, "odometry").mean() > 3.0 * mean_errors(driven, "amcl").mean()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("robot", "wrong"),
    [
        pytest.param("turtlebot3", Pose(0.4, 0.3, 0.3), marks=pytest.mark.long),
        ("jackal", Pose(-0.3, 0.4, -0.3)),
        ("robotino", Pose(0.5, 0.0, 0.3)),
    ],
)
def test_amcl_recovers_from_a_start_that_is_half_a_metre_off(drives, robot, wrong):
    for drive in drives(overrides("warehouse", robot, 5), ["amcl"], 2, wrong):
        errors = drive.errors["amcl"]
        assert errors[len(errors) // 2 :].mean() < 0.1
