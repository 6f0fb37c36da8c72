"""Robots, windows and observations made by hand, planners from the presets that are shipped, and bands to solve."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from arena_core import Costmap, EpisodeStart, Observation, Planner, Pose, Robot, Tracks
from arena_core.testing import boxes_costmap, component, tracked, view
from arena_kernels.costmap_window import CostmapWindow, window_of


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
def window(costmap: Callable[..., Costmap]) -> Callable[..., CostmapWindow]:
    """Give a function that makes the window of such a costmap."""

    def _window(*boxes: tuple[float, float, float, float]) -> CostmapWindow:
        return window_of(costmap(*boxes))

    return _window


@pytest.fixture(scope="session")
def costmap() -> Callable[..., Costmap]:
    """Give a function that makes a costmap, 6 m wide about the origin, of boxes (x_min, x_max, y_min, y_max) in m."""
    return boxes_costmap


@pytest.fixture(scope="session")
def people() -> Callable[..., Tracks]:
    """Give a function that makes tracks of rows (x, y, vx, vy), 0.3 m in radius."""
    return tracked


@pytest.fixture(scope="session")
def observe() -> Callable[..., Observation]:
    """Give a function that makes an observation of a costmap, pose, path rows (x, y), twist, stamp and tracks."""
    return view
