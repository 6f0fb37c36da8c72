"""Robots, windows and observations made by hand, planners from the presets that are shipped, and bands to solve."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import pytest
from numpy.typing import ArrayLike

from arena_core import NO_TRACKS, Costmap, EpisodeStart, LaserScan, Observation, Path, Planner, Pose, Robot, Tracks, Twist
from arena_core.testing import component
from arena_kernels.distance import distance_field
from arena_kernels.window import Window

REST = Twist(0.0)


@pytest.fixture(scope="session")
def build() -> Callable[..., Planner]:
    """Give a function that builds and resets a planner: robot's name, overrides, preset."""
    robots: dict[str, Robot] = {}

    def _build(name: str = "turtlebot3", *overrides: str, preset: str = "teb") -> Planner:
        body = robots.setdefault(name, component("robot", name))
        planner = component("planner", preset, overrides, name, robot=body)
        planner.reset(EpisodeStart(None, Pose(3.0, 0.0), body.control_period, np.random.default_rng(0)))
        return planner

    return _build


@pytest.fixture(scope="session")
def costmap() -> Callable[..., Costmap]:
    """Give a function that makes a costmap, 6 m wide about the origin, of boxes (x_min, x_max, y_min, y_max) in m."""

    def _costmap(*boxes: tuple[float, float, float, float], cells: int = 121) -> Costmap:
        lethal = np.zeros((cells, cells), np.bool_)
        centres = (np.arange(cells) - 0.5 * (cells - 1)) * 0.05
        for x_min, x_max, y_min, y_max in boxes:
            lethal |= ((centres >= y_min) & (centres <= y_max))[:, None] & ((centres >= x_min) & (centres <= x_max))[None, :]
        half = 0.5 * 0.05 * cells
        return Costmap(np.where(lethal, 254, 0).astype(np.uint8), distance_field(lethal, 0.05), 0.05, np.array((-half, -half)))

    return _costmap


@pytest.fixture(scope="session")
def window(costmap: Callable[..., Costmap]) -> Callable[..., Window]:
    """Give a function that makes the window of such a costmap."""

    def _window(*boxes: tuple[float, float, float, float]) -> Window:
        made = costmap(*boxes)
        return Window(made.costs, made.distance, made.resolution, *made.origin_xy.tolist())

    return _window


@pytest.fixture(scope="session")
def people() -> Callable[..., Tracks]:
    """Give a function that makes tracks of rows (x, y, vx, vy), 0.3 m in radius."""

    def _people(*rows: Sequence[float]) -> Tracks:
        table, count = np.array(rows, dtype=np.float64).reshape(-1, 4), len(rows)
        ids = np.arange(count, dtype=np.int32)
        return Tracks(ids, table[:, :2].copy(), table[:, 2:].copy(), np.full(count, 0.3), np.zeros((count, 4, 4)))

    return _people


@pytest.fixture(scope="session")
def observe(costmap: Callable[..., Costmap]) -> Callable[..., Observation]:
    """Give a function that makes an observation of a costmap, pose, path rows (x, y), twist, stamp and tracks."""

    def _observe(
        local_map: Costmap | None = None,
        pose: Pose | None = None,
        path_xy: ArrayLike = tuple((0.1 * k, 0.0) for k in range(26)),
        twist: Twist = REST,
        stamp: float = 0.0,
        tracks: Tracks = NO_TRACKS,
    ) -> Observation:
        rows = np.asarray(path_xy, dtype=np.float64).reshape(-1, 2)
        path = Path(np.column_stack((rows, np.zeros(len(rows)))))
        scan = LaserScan(stamp, 0.0, 0.1, 0.12, 3.5, np.full(4, np.nan, np.float32), Pose(0.0, 0.0))
        goal = Pose.of(path.poses[-1]) if len(rows) else Pose(2.5, 0.0)
        seen, at = local_map or costmap(), pose or Pose(0.0, 0.0)
        return Observation(stamp, at, np.zeros((3, 3)), twist, scan, goal, goal, path, None, lambda: seen, lambda: tracks)

    return _observe
