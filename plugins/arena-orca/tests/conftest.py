"""Robots, windows and observations made by hand, and planners built from the presets that are shipped."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from arena_core import Costmap, EpisodeStart, Observation, Planner, Pose, Robot, Tracks
from arena_core.testing import boxes_costmap, component, tracked, view


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
    return boxes_costmap


@pytest.fixture(scope="session")
def people() -> Callable[..., Tracks]:
    """Give a function that makes tracks of rows (x, y, vx, vy), 0.3 m in radius."""
    return tracked


@pytest.fixture(scope="session")
def observe() -> Callable[..., Observation]:
    """Give a function that makes an observation of a costmap, pose, path rows (x, y), twist, stamp and tracks."""
    return view
