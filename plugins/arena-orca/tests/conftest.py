"""Robots, windows and observations made by hand, and planners built from the presets that are shipped."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import pytest
from numpy.typing import ArrayLike

from arena_core import NO_TRACKS, Costmap, EpisodeStart, LaserScan, Observation, Path, Planner, Pose, Robot, Tracks, Twist
from arena_core.testing import component
from arena_kernels.distance import distance_field

REST = Twist(0.0)


@pytest.fixture(scope="session")
def robot() -> Callable[[str], Robot]:
    """Give a function that builds an installed robot by name."""
    built: dict[str, Robot] = {}
    return lambda name: built.setdefault(name, component("robot", name))


@pytest.fixture(scope="session")
def build(robot: Callable[[str], Robot]) -> Callable[..., Planner]:
    """Give a function that builds and resets a planner: robot's name, overrides, preset."""

    built: dict[tuple[str, ...], Planner] = {}

    def _build(name: str = "turtlebot3", *overrides: str, preset: str = "orca") -> Planner:
        body, key = robot(name), (name, preset, *overrides)
        planner = built[key] if key in built else component("planner", preset, overrides, name, robot=body)
        built[key] = planner
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
def people() -> Callable[..., Tracks]:
    """Give a function that makes tracks of rows (x, y, vx, vy), 0.3 m in radius."""

    def _people(*rows: Sequence[float]) -> Tracks:
        if not rows:
            return NO_TRACKS
        table, count = np.array(rows, dtype=np.float64), len(rows)
        ids = np.arange(count, dtype=np.int32)
        return Tracks(ids, table[:, :2].copy(), table[:, 2:].copy(), np.full(count, 0.3), np.zeros((count, 4, 4)))

    return _people


@pytest.fixture(scope="session")
def observe() -> Callable[..., Observation]:
    """Give a function that makes an observation of a costmap, pose, path rows (x, y), twist and tracks."""

    def _observe(
        costmap: Costmap, pose: Pose, path_xy: ArrayLike, twist: Twist = REST, tracks: Tracks = NO_TRACKS, stamp: float = 0.0
    ) -> Observation:
        rows = np.asarray(path_xy, dtype=np.float64).reshape(-1, 2)
        path = Path(np.column_stack((rows, np.zeros(len(rows)))))
        scan = LaserScan(0.0, 0.0, 0.1, 0.12, 3.5, np.full(4, np.inf, np.float32), Pose(0.0, 0.0))
        goal = Pose.of(path.poses[-1]) if len(rows) else Pose(1.0, 0.0)
        return Observation(stamp, pose, np.zeros((3, 3)), twist, scan, goal, goal, path, None, lambda: costmap, lambda: tracks)

    return _observe
