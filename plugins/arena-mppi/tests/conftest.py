"""Robots, windows and observations made by hand, and planners built from the presets that are shipped."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from importlib.resources import files

import numpy as np
import pytest
from numpy.typing import NDArray

from arena_core import Costmap, EpisodeStart, Footprint, Observation, Planner, Pose, Robot, Tracks, VelocityLimits
from arena_core.testing import boxes_costmap, component, tracked, view
from arena_kernels.distance import distance_field

ROBOTS: dict[str, Robot] = {
    name: component("robot", name) for name in ("turtlebot3", "jackal", "robotino", "jackal_ackermann")
}
ROBOTS["stranger"] = replace(
    ROBOTS["jackal"],
    name="stranger",
    footprint=Footprint.circle(0.3),
    limits=VelocityLimits(-0.2, 0.8, 0.0, 1.5, 0.8, 0.0, 2.0),
)


@pytest.fixture(scope="session")
def build() -> Callable[..., Planner]:
    """Give a function that builds and resets a planner: robot's name, preset, overrides, control period."""

    def _build(
        robot: str = "turtlebot3", preset: str = "mppi", *overrides: str, period: float = 0.1, seed: int = 0
    ) -> Planner:
        tuned = robot if (files("arena_mppi.conf") / "planner" / "mppi_tuning" / f"{robot}.yaml").is_file() else None
        planner: Planner = component(
            "planner", preset, [f"planner.{change}" for change in overrides], tuned, robot=ROBOTS[robot]
        )
        planner.reset(EpisodeStart(None, Pose(0.0, 0.0), period, np.random.default_rng(seed)))
        return planner

    return _build


def _costmap(lethal: NDArray[np.bool_], resolution: float = 0.05) -> Costmap:
    half = 0.5 * resolution * np.array(lethal.shape[::-1])
    return Costmap(np.where(lethal, 254, 0).astype(np.uint8), distance_field(lethal, resolution), resolution, -half)


@pytest.fixture(scope="session")
def costmap_of() -> Callable[..., Costmap]:
    """Give a function that makes a costmap centred on the origin of lethal cells (H, W)."""
    return _costmap


@pytest.fixture(scope="session")
def costmap() -> Callable[..., Costmap]:
    """Give a function that makes a costmap, 6 m wide about the origin, of boxes (x_min, x_max, y_min, y_max) in m."""
    return boxes_costmap


@pytest.fixture(scope="session")
def people() -> Callable[..., Tracks]:
    """Give a function that makes tracks of rows (x, y, vx, vy), 0.3 m in radius, 0.1 m and m/s uncertain."""
    return partial(tracked, variance=0.01)


@pytest.fixture(scope="session")
def observe() -> Callable[..., Observation]:
    """Give a function that makes an observation of a costmap, pose, path rows (x, y), twist, stamp and tracks."""
    return view
