"""Courses on which problems are laid out."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from arena_break.bounds import read_bounds
from arena_break.course import Course
from arena_core import OccupancyGrid, Pose, World
from arena_core.hosting import compose, load_registry, to_plain


def walled_room(width: float, height: float, resolution: float = 0.1) -> World:
    """Return a room with walls of a cell around it, sizes in m."""
    data = np.zeros((round(height / resolution) + 2, round(width / resolution) + 2), np.int8)
    data[[0, -1]], data[:, [0, -1]] = 100, 100
    return World("room", OccupancyGrid(data, resolution, Pose(0.0, 0.0, 0.0)))


@pytest.fixture(scope="session")
def course_of() -> Callable[..., Course]:
    """Return the course of a jackal in a room of some size."""
    registry = load_registry()
    robot = registry.build("robot", to_plain(compose(["robot=jackal", "planner=pure_pursuit"]))["robot"])

    def _course(width: float = 14.0, height: float = 10.0) -> Course:
        return Course(walled_room(width, height), robot, read_bounds(None))

    return _course
