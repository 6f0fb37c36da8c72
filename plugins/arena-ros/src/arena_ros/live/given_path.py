"""A path that a client sends, as the navigator follows it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from arena_core import GlobalPlanner, NoPath, OccupancyGrid, Path, Pose
from arena_core.hosting import Navigator, ReplanRules

SPACING = 0.05  # m between two poses, as those of a grid planner are
APART = 1e-3  # m within which two poses are one
NEVER = ReplanRules(period=None, on_request=False, blocked_for=None, min_interval=0.0, gain=0.0)


class GivenPath(GlobalPlanner):
    """Plans nothing: its path is the last one that was given."""

    def __init__(self) -> None:
        self.path: Path | None = None

    def plan(self, grid: OccupancyGrid, start: Pose, goal: Pose) -> Path:
        """Return the path that was given; raise NoPath where none was."""
        if self.path is None:
            raise NoPath("no path was given")
        return self.path


def follow_given_paths(navigator: Navigator) -> GivenPath:
    """Have a navigator follow the paths that it is given: it plans none and recovers from nothing, which others do."""
    given, rules = GivenPath(), replace(navigator.rules, behaviours=[], lean_time=None, circle_time=None)
    navigator.global_planner, navigator.replan, navigator.rules = given, NEVER, rules
    navigator.recoveries = type(navigator.recoveries)(rules, navigator.robot)
    return given


def resample_path(positions: NDArray[np.float64]) -> Path | None:
    """Return a path through positions (M, 2), its poses at equal distances along it; None where all are one."""
    steps = np.hypot(*np.diff(positions, axis=0).T)
    positions = positions[np.concatenate(([True], steps > APART))]
    if len(positions) < 2:
        return None
    stations = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(positions, axis=0).T))))
    places = np.linspace(0.0, stations[-1], max(round(stations[-1] / SPACING), 1) + 1)
    x, y = (np.interp(places, stations, column) for column in positions.T)
    heading = np.arctan2(np.diff(y), np.diff(x))
    return Path(np.stack((x, y, np.append(heading, heading[-1])), axis=1))


def length_ahead(path: Path, pose: Pose) -> float:
    """Return how far it is from a pose along a path to its end, m."""
    offsets = path.poses[:, :2] - (pose.x, pose.y)
    nearest = int((offsets**2).sum(axis=1).argmin())
    return float(np.hypot(*offsets[nearest])) + Path(path.poses[nearest:]).length
