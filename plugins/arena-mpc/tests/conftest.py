"""Robots, costmaps and observations made by hand, and planners built from the presets that are shipped."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
import pytest

from arena_core import Costmap, EpisodeStart, Observation, Pose, Robot, Tracks
from arena_core.hosting import NAVIGATOR_KEYS, compose, to_plain
from arena_core.testing import boxes_costmap, component, tracked, view
from arena_mpc.parameters import Grid, Limits, Obstacles, SolverSettings, Weights
from arena_mpc.planner import MpcPlanner

ROBOTS: dict[str, Robot] = {
    name: component("robot", name) for name in ("turtlebot3", "jackal", "robotino", "jackal_ackermann")
}
GROUPS = {"limits": Limits, "grid": Grid, "weights": Weights, "obstacles": Obstacles, "solver": SolverSettings}


@cache
def preset_node(preset: str, robot: str) -> dict[str, Any]:
    """Return a preset with its tuning for a robot, as ``arena run`` composes it."""
    return to_plain(compose([f"planner={preset}", f"robot={robot}"], "component")["planner"])


def preset_values(preset: str, robot: str) -> dict[str, Any]:
    """Return what of a preset the planner is told."""
    return {key: value for key, value in preset_node(preset, robot).items() if key not in ("name", *NAVIGATOR_KEYS)}


def merged(values: dict[str, Any], changes: dict[str, Any]) -> dict[str, Any]:
    """Return nested mappings with changes."""
    changed = {k: merged(values[k], v) if isinstance(v, dict) else v for k, v in changes.items()}
    return {**values, **changed}


def make_planner(robot: Robot, preset: str = "mpc", **changes: Any) -> MpcPlanner:
    """Build and reset a planner from a preset, with changes to it."""
    values = merged(preset_values(preset, robot.name), changes)
    planner = MpcPlanner(
        robot, **{key: GROUPS[key](**value) if key in GROUPS else value for key, value in values.items()}
    )
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


@pytest.fixture(scope="session")
def released() -> dict[str, Any]:
    """Give the released preset, and what of it the planner is told."""
    return {**preset_node("mpc_as_released", "jackal"), "planner": preset_values("mpc_as_released", "jackal")}
