"""Robots, windows and observations made by hand, and planners built from the presets that are shipped."""

from __future__ import annotations

import math
from collections.abc import Callable
from importlib.resources import files
from typing import Any

import numpy as np
import pytest
from numpy.typing import ArrayLike, NDArray

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
    Planner,
    Pose,
    Robot,
    Tracks,
    Twist,
    VelocityLimits,
    compose,
    load_registry,
)
from arena_kernels.distance import distance_field

LIDAR = Lidar(360, 0.0, 2.0 * math.pi / 360, 0.12, 3.5, 0.1, 0.01, Pose(0.0, 0.0))
ODOMETRY = OdometryModel(0.02, 0.0, 0.0, 0.0, 0.0)
JACKAL_BODY = Footprint.polygon([[0.21, -0.165], [0.21, 0.165], [-0.21, 0.165], [-0.21, -0.165]])
CAR_BODY = Footprint.polygon([[0.341, -0.165], [0.341, 0.165], [-0.079, 0.165], [-0.079, -0.165]])


def _robot(
    name: str, kinematics: Any, footprint: Footprint, limits: VelocityLimits, wheelbase: float = 0.0, steering: float = 0.0
) -> Robot:
    return Robot(name, kinematics, footprint, limits, LIDAR, ODOMETRY, 0.1, wheelbase, steering)


ROBOTS = {
    "turtlebot3": _robot("turtlebot3", "differential", Footprint.circle(0.113), VelocityLimits(-0.22, 0.22, 0.0, 2.84, 2.5, 0.0, 3.2)),
    "jackal": _robot("jackal", "differential", JACKAL_BODY, VelocityLimits(-2.0, 2.0, 0.0, 4.0, 10.0, 0.0, 20.0)),
    "robotino": _robot("robotino", "omnidirectional", Footprint.circle(0.225), VelocityLimits(-2.78, 2.78, 2.78, 1.0, 2.5, 2.5, 3.2)),
    "jackal_ackermann": _robot("jackal_ackermann", "ackermann", CAR_BODY, VelocityLimits(-2.0, 2.0, 0.0, 4.0, 10.0, 0.0, 20.0), 0.262, 0.5),
    "stranger": _robot("stranger", "differential", Footprint.circle(0.3), VelocityLimits(-0.2, 0.8, 0.0, 1.5, 0.8, 0.0, 2.0)),
}


@pytest.fixture(scope="session")
def build() -> Callable[..., Planner]:
    """Give a function that builds and resets a planner: robot's name, preset, overrides, control period."""

    def _build(robot: str = "turtlebot3", preset: str = "mppi", *overrides: str, period: float = 0.1, seed: int = 0) -> Planner:
        tuned = (files("arena_mppi.conf") / "planner" / "mppi_tuning" / f"{robot}.yaml").is_file()
        chosen = [f"planner={preset}", *([f"robot={robot}"] if tuned else []), *(f"planner.{change}" for change in overrides)]
        node = compose(chosen, config_name="component")["planner"]
        values = {key: value for key, value in _plain(node).items() if key != "control_period"}
        planner: Planner = load_registry().build("planner", values, robot=ROBOTS[robot])
        planner.reset(EpisodeStart(None, Pose(0.0, 0.0), period, np.random.default_rng(seed)))
        return planner

    return _build


def _plain(node: Any) -> dict[str, Any]:
    from omegaconf import OmegaConf

    return dict(OmegaConf.to_container(node, resolve=True)) if OmegaConf.is_config(node) else dict(node)


def _costmap(lethal: NDArray[np.bool_], resolution: float = 0.05) -> Costmap:
    half = 0.5 * resolution * np.array(lethal.shape[::-1])
    return Costmap(np.where(lethal, 254, 0).astype(np.uint8), distance_field(lethal, resolution), resolution, -half)


@pytest.fixture(scope="session")
def costmap_of() -> Callable[..., Costmap]:
    """Give a function that makes a costmap centred on the origin of lethal cells (H, W)."""
    return _costmap


@pytest.fixture(scope="session")
def costmap() -> Callable[..., Costmap]:
    """Give a function that makes a costmap, 6 m wide, the origin in the middle, of boxes (x_min, x_max, y_min, y_max) in m."""

    def _boxes(*boxes: tuple[float, float, float, float], cells: int = 121) -> Costmap:
        lethal = np.zeros((cells, cells), np.bool_)
        centres = (np.arange(cells) - 0.5 * (cells - 1)) * 0.05
        for x_min, x_max, y_min, y_max in boxes:
            lethal |= ((centres >= y_min) & (centres <= y_max))[:, None] & ((centres >= x_min) & (centres <= x_max))[None, :]
        return _costmap(lethal)

    return _boxes


@pytest.fixture(scope="session")
def people() -> Callable[..., Tracks]:
    """Give a function that makes tracks of rows (x, y, vx, vy)."""

    def _people(*rows: tuple[float, float, float, float]) -> Tracks:
        array, n = np.array(rows, dtype=np.float64).reshape(-1, 4), len(rows)
        covariances = np.tile(np.diag((0.01, 0.01, 0.01, 0.01)), (n, 1, 1))
        return Tracks(np.arange(n, dtype=np.int32), array[:, :2], array[:, 2:], np.full(n, 0.3), covariances)

    return _people


@pytest.fixture(scope="session")
def observe() -> Callable[..., Observation]:
    """Give a function that makes an observation of a costmap, pose, path rows (x, y), twist, stamp and tracks."""

    def _observe(
        costmap: Costmap, pose: Pose, path_xy: ArrayLike, twist: Twist | None = None, stamp: float = 0.0, tracks: Tracks = NO_TRACKS
    ) -> Observation:
        rows = np.asarray(path_xy, dtype=np.float64).reshape(-1, 2)
        path = Path(np.column_stack((rows, np.zeros(len(rows)))))
        scan = LaserScan(0.0, 0.0, 0.1, 0.12, 3.5, np.full(4, np.inf, np.float32), Pose(0.0, 0.0))
        goal = Pose.of(path.poses[-1]) if len(rows) else Pose(2.0, 0.0)
        speed = twist or Twist(0.0)
        return Observation(stamp, pose, np.zeros((3, 3)), speed, scan, goal, goal, path, None, lambda: costmap, lambda: tracks)

    return _observe
