"""Records of what the recorder of the release wrote down, whose figures can be worked out by hand."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import pytest
from numpy.typing import ArrayLike

from arena_core import EpisodeRecord
from arena_core.hosting import compose, to_plain
from arena_replication.paper_legacy import PaperLegacyMetrics

Figures = dict[str, Callable[[EpisodeRecord], float]]


def make_record(
    poses: ArrayLike, dt: float = 0.1, meta: Mapping[str, Any] | None = None, **arrays: ArrayLike
) -> EpisodeRecord:
    """Make a record from poses (T, 3); the robot stands a metre from everything unless ``arrays`` say otherwise."""
    pose = np.asarray(poses, dtype=float).reshape(-1, 3)
    usual = {
        "stamp": dt * np.arange(len(pose)),
        "pose": pose,
        "twist": np.zeros((len(pose), 3)),
        "scan_min": np.ones(len(pose)),
    }
    scenario = {"goal": pose[-1].tolist(), "goal_radius": 0.3, "time_limit": 180.0}
    robot = {"name": "turtlebot3", "footprint": {"radius": 0.2, "vertices_xy": []}}
    merged = {name: np.asarray(arrays.get(name, value)) for name, value in usual.items()}
    return EpisodeRecord(merged, {"outcome": "goal_reached", "scenario": scenario, "robot": robot, **(meta or {})}, {})


def straight(length: float = 4.0, speed: float = 0.5, dt: float = 0.1) -> np.ndarray:
    """Return poses along x at constant speed, from the origin."""
    x = np.arange(round(length / (speed * dt)) + 1) * speed * dt
    return np.stack((x, np.zeros_like(x), np.zeros_like(x)), axis=1)


def circle(radius: float = 2.0, speed: float = 0.5, dt: float = 0.1) -> np.ndarray:
    """Return poses once round the origin, counter-clockwise, heading along the circle and wrapped to [-pi, pi)."""
    angle = np.arange(round(2.0 * np.pi * radius / (speed * dt)) + 1) * speed * dt / radius
    heading = (angle + 1.5 * np.pi) % (2.0 * np.pi) - np.pi
    return np.stack((radius * np.cos(angle), radius * np.sin(angle), heading), axis=1)


def preset(name: str) -> dict[str, Any]:
    """Return the parameters of a pack's preset."""
    values: dict[str, Any] = to_plain(compose([f"metrics=[{name}]"], "component"))["metrics"][name]
    return {key: value for key, value in values.items() if key != "name"}


@pytest.fixture(scope="session")
def record_of() -> Callable[..., EpisodeRecord]:
    """Give what makes a record of poses."""
    return make_record


@pytest.fixture(scope="session")
def straight_line() -> Callable[..., np.ndarray]:
    """Give what makes poses along x."""
    return straight


@pytest.fixture(scope="session")
def round_trip() -> Callable[..., np.ndarray]:
    """Give what makes poses on a circle."""
    return circle


@pytest.fixture(scope="session")
def preset_of() -> Callable[[str], dict[str, Any]]:
    """Give what composes the parameters of a pack's preset."""
    return preset


@pytest.fixture(scope="session")
def legacy() -> Figures:
    """Give the figures of the pack as the released script has them."""
    return {metric.name: metric.compute for metric in PaperLegacyMetrics(**preset("paper_legacy")).metrics()}
