"""Robots, costmaps and observations made by hand, and planners built from the presets that are shipped."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from omegaconf import OmegaConf

from arena_core import Costmap, EpisodeStart, Footprint, Observation, Pose, Robot, VelocityLimits
from arena_core.hosting import compose, load_registry, to_plain
from arena_core.testing import component, view
from arena_dwa.planner import DwaPlanner
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


@cache
def preset(name: str, robot: str) -> Any:
    """Return a preset with its tuning for a robot, as ``arena run`` composes it."""
    tuned = [] if robot == "stranger" else [f"robot={robot}"]
    return compose([f"planner={name}", *tuned], "component")["planner"]


@pytest.fixture(scope="session")
def build() -> Callable[..., DwaPlanner]:
    """Give a function that builds and resets a planner: robot's name, preset, changed values of
    each group of parameters.
    """

    def _build(robot: str = "turtlebot3", name: str = "dwa", **changes: Any) -> DwaPlanner:
        node = to_plain(OmegaConf.merge(preset(name, robot), changes))
        planner: DwaPlanner = load_registry().build("planner", node, robot=ROBOTS[robot])
        planner.reset(EpisodeStart(None, Pose(0.0, 0.0), 0.1, np.random.default_rng(0)))
        return planner

    return _build


def _inflate(lethal: NDArray[np.bool_], resolution: float = 0.05, inscribed: float = 0.113) -> Costmap:
    distance = distance_field(lethal, resolution)
    costs = np.where(distance <= inscribed, 253.0, 252.0 * np.exp(-3.0 * (distance - inscribed)))
    costs = np.where(lethal, 254.0, np.where(distance > 1.0, 0.0, costs))
    half = 0.5 * resolution * np.array(lethal.shape[::-1])
    return Costmap(costs.astype(np.uint8), distance, resolution, -half)


@pytest.fixture(scope="session")
def inflate() -> Callable[..., Costmap]:
    """Give a function that inflates lethal cells (H, W) to a costmap centred on the origin, as costmap_2d does."""
    return _inflate


@pytest.fixture(scope="session")
def costmap() -> Callable[..., Costmap]:
    """Give a function that makes a costmap, 6 m wide, the origin in the middle, of boxes (x_min,
    x_max, y_min, y_max) in m.
    """

    def _costmap(*boxes: tuple[float, float, float, float], cells: int = 121) -> Costmap:
        lethal = np.zeros((cells, cells), np.bool_)
        centres = (np.arange(cells) - 0.5 * (cells - 1)) * 0.05
        for x_min, x_max, y_min, y_max in boxes:
            lethal |= ((centres >= y_min) & (centres <= y_max))[:, None] & ((centres >= x_min) & (centres <= x_max))[
                None, :
            ]
        return _inflate(lethal)

    return _costmap


@pytest.fixture(scope="session")
def observe() -> Callable[..., Observation]:
    """Give a function that makes an observation of a costmap, pose, path rows (x, y), twist, stamp and tracks."""
    return view
