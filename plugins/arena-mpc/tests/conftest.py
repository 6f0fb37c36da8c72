"""Robots, costmaps and observations made by hand, and planners built from the presets that are shipped."""

from __future__ import annotations

import math
from collections.abc import Callable
from importlib.resources import files
from typing import Any

import numpy as np
import pytest
import yaml
from numpy.typing import ArrayLike

from arena_core import (
    NO_TRACKS,
    Costmap,
    EpisodeStart,
    Footprint,
    LaserScan,
    Lidar,
    Observation,
    OdometryModel,
    Path,
    Pose,
    Robot,
    Tracks,
    Twist,
    VelocityLimits,
)
from arena_kernels.distance import distance_field
from arena_mpc.parameters import Grid, Limits, Obstacles, SolverSettings, Weights
from arena_mpc.planner import MpcPlanner

LIDAR = Lidar(360, 0.0, 2.0 * math.pi / 360, 0.12, 3.5, 0.1, 0.01, Pose(0.0, 0.0))
ODOMETRY = OdometryModel(0.02, 0.0, 0.0, 0.0, 0.0)
REST = Twist(0.0)
JACKAL_BODY = Footprint.polygon([[0.21, -0.165], [0.21, 0.165], [-0.21, 0.165], [-0.21, -0.165]])
CAR_BODY = Footprint.polygon([[0.341, -0.165], [0.341, 0.165], [-0.079, 0.165], [-0.079, -0.165]])
SMALL = VelocityLimits(-0.22, 0.22, 0.0, 2.84, 2.5, 0.0, 3.2)
FAST = VelocityLimits(-2.0, 2.0, 0.0, 4.0, 10.0, 0.0, 20.0)
SIDEWAYS = VelocityLimits(-2.78, 2.78, 2.78, 1.0, 2.5, 2.5, 3.2)
ROBOTS = {
    "turtlebot3": Robot("turtlebot3", "differential", Footprint.circle(0.113), SMALL, LIDAR, ODOMETRY, 0.1),
    "jackal": Robot("jackal", "differential", JACKAL_BODY, FAST, LIDAR, ODOMETRY, 0.1),
    "robotino": Robot("robotino", "omnidirectional", Footprint.circle(0.225), SIDEWAYS, LIDAR, ODOMETRY, 0.1),
    "jackal_ackermann": Robot("jackal_ackermann", "ackermann", CAR_BODY, FAST, LIDAR, ODOMETRY, 0.1, 0.262, 0.5),
}
GROUPS = {"limits": Limits, "grid": Grid, "weights": Weights, "obstacles": Obstacles, "solver": SolverSettings}


def preset_values(preset: str, robot: str) -> dict[str, Any]:
    """Read a preset and its tuning for a robot, as Hydra merges them."""
    folder = files("arena_mpc.conf") / "planner"
    values = yaml.safe_load((folder / f"{preset}.yaml").read_text())
    tuning = folder / ("mpc_as_released_tuning" if preset == "mpc_as_released" else "mpc_tuning") / f"{robot}.yaml"
    if tuning.is_file():
        values = merged(values, yaml.safe_load(tuning.read_text()))
    return {key: value for key, value in values.items() if key not in ("defaults", "name", "control_period")}


def merged(values: dict[str, Any], changes: dict[str, Any]) -> dict[str, Any]:
    """Return nested mappings with changes."""
    changed = {k: merged(values[k], v) if isinstance(v, dict) else v for k, v in changes.items()}
    return {**values, **changed}


def make_planner(robot: Robot, preset: str = "mpc", **changes: Any) -> MpcPlanner:
    """Build and reset a planner from a preset, with changes to it."""
    values = merged(preset_values(preset, robot.name), changes)
    planner = MpcPlanner(robot, **{key: GROUPS[key](**value) if key in GROUPS else value for key, value in values.items()})
    planner.reset(EpisodeStart(None, Pose(0.0, 0.0), 0.1, np.random.default_rng(0)))
    return planner


@pytest.fixture(scope="session")
def build() -> Callable[..., MpcPlanner]:
    """Give a function that builds and resets a planner: robot's name, preset, changed values."""
    return lambda robot="turtlebot3", preset="mpc", **changes: make_planner(ROBOTS[robot], preset, **changes)


@pytest.fixture(scope="session")
def robots() -> dict[str, Robot]:
    """Give the robots by name."""
    return ROBOTS


@pytest.fixture(scope="session")
def planner_of() -> Callable[..., MpcPlanner]:
    """Give a function that builds a planner for any robot."""
    return make_planner


@pytest.fixture(scope="session")
def costmap() -> Callable[..., Costmap]:
    """Give a function that makes a costmap, 6 m wide, the origin in the middle, of boxes (x_min, x_max, y_min, y_max) in m."""

    def _costmap(*boxes: tuple[float, float, float, float], cells: int = 120) -> Costmap:
        lethal = np.zeros((cells, cells), np.bool_)
        centres = (np.arange(cells) - 0.5 * (cells - 1)) * 0.05
        for x_min, x_max, y_min, y_max in boxes:
            lethal |= ((centres >= y_min) & (centres <= y_max))[:, None] & ((centres >= x_min) & (centres <= x_max))[None, :]
        costs = np.where(lethal, 254, 0).astype(np.uint8)
        return Costmap(costs, distance_field(lethal, 0.05), 0.05, np.full(2, -0.025 * cells))

    return _costmap


@pytest.fixture(scope="session")
def people() -> Callable[..., Tracks]:
    """Give a function that makes tracks of 0.3 m radius from rows (x, y, vx, vy)."""

    def _people(*rows: tuple[float, float, float, float]) -> Tracks:
        values = np.array(rows, dtype=np.float64).reshape(-1, 4)
        count = len(values)
        return Tracks(np.arange(count, dtype=np.int32), values[:, :2], values[:, 2:], np.full(count, 0.3), np.zeros((count, 4, 4)))

    return _people


@pytest.fixture(scope="session")
def observe() -> Callable[..., Observation]:
    """Give a function that makes an observation of a costmap, pose, path rows (x, y), twist, tracks and stamp."""

    def _observe(
        costmap: Costmap, pose: Pose, path_xy: ArrayLike, twist: Twist = REST, tracks: Tracks = NO_TRACKS, stamp: float = 0.0
    ) -> Observation:
        rows = np.asarray(path_xy, dtype=np.float64).reshape(-1, 2)
        path = Path(np.column_stack((rows, np.zeros(len(rows)))))
        scan = LaserScan(stamp, 0.0, 0.1, 0.12, 3.5, np.full(4, np.nan, np.float32), Pose(0.0, 0.0))
        goal = Pose.of(path.poses[-1]) if len(rows) else Pose(1.0, 0.0)
        return Observation(stamp, pose, np.zeros((3, 3)), twist, scan, goal, goal, path, None, lambda: costmap, lambda: tracks)

    return _observe
