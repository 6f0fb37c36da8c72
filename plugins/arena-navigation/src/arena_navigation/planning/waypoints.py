"""Waypoint generators: the intermediate goal ahead on the path, for all robots in one compiled call."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from arena_core import ConfigurationError, PathBatch, WaypointGenerator, Waypoints
from arena_core.hosting import OFF_PATH, WAYPOINT_FOUND, WAYPOINT_TIMEOUT
from arena_core.parameters import NonNegative, Positive
from arena_kernels.compiled import compiled
from arena_navigation.columns import X, Y
from arena_navigation.planning.path_progress import FloatArray, Progress, distance_to_pose, follow_path, is_on_time

Slots = NDArray[np.int64]


class SpatialHorizon(WaypointGenerator):
    """Puts the waypoint where the path leaves the horizon of ``d_ahead`` m (Kaestner et al. 2021, Arena-Rosnav)."""

    def __init__(
        self, d_ahead: Positive, tolerance: Positive, t_lim: Positive | None, min_progress: NonNegative
    ) -> None:
        if tolerance >= d_ahead:
            raise ConfigurationError(f"waypoints.tolerance is {tolerance}; allowed: less than d_ahead, {d_ahead} (m)")
        self._numbers = d_ahead, tolerance, _timeout_seconds(t_lim), min_progress
        self._progress = Progress.of(0)

    def reset(self, slots: NDArray[np.int64], total: int) -> None:
        """Forget the progress of these slots."""
        self._progress = _forget_slots(self._progress, slots, total)

    def next(self, paths: PathBatch, poses: FloatArray, stamps: FloatArray, slots: Slots | None = None) -> Waypoints:
        """Return each robot's waypoint; OFF_PATH if no pose lies in the horizon, WAYPOINT_TIMEOUT
        without progress for ``t_lim``.
        """
        found = Waypoints(np.empty((len(poses), 3)), np.empty(len(poses), np.int8))
        _horizon_waypoints(
            self._progress,
            _all_of(poses) if slots is None else slots,
            paths.poses,
            paths.offsets,
            poses,
            stamps,
            self._numbers,
            found.poses,
            found.status,
        )
        return found


class Subsample(WaypointGenerator):
    """Puts a waypoint every ``spacing`` m of path; the next one is due when one is reached or passed."""

    def __init__(
        self,
        spacing: Positive,
        reached_within: Positive,
        off_path_beyond: Positive,
        t_lim: Positive | None,
        min_progress: NonNegative,
    ) -> None:
        self._numbers = spacing, reached_within, off_path_beyond, _timeout_seconds(t_lim), min_progress
        self._progress = Progress.of(0)
        self._current = np.zeros(0, np.int64)

    def reset(self, slots: NDArray[np.int64], total: int) -> None:
        """Forget the progress of these slots."""
        self._progress = _forget_slots(self._progress, slots, total)
        if len(self._current) != total:
            self._current = np.zeros(total, np.int64)

    def next(self, paths: PathBatch, poses: FloatArray, stamps: FloatArray, slots: Slots | None = None) -> Waypoints:
        """Return each robot's waypoint; OFF_PATH too far beside the path, WAYPOINT_TIMEOUT
        without progress for ``t_lim``.
        """
        found = Waypoints(np.empty((len(poses), 3)), np.empty(len(poses), np.int8))
        at = self._progress, self._current, _all_of(poses) if slots is None else slots
        _spaced_waypoints(*at, paths.poses, paths.offsets, poses, stamps, self._numbers, found.poses, found.status)
        return found


def _timeout_seconds(t_lim: float | None) -> float:
    return math.inf if t_lim is None else t_lim


def _forget_slots(progress: Progress, slots: NDArray[np.int64], total: int) -> Progress:
    """Return the state for ``total`` robots, in which these slots have no path yet."""
    if len(progress.place) != total:
        return Progress.of(total)
    progress.paths[slots] = -1.0
    return progress


def _all_of(poses: FloatArray) -> Slots:
    return np.arange(len(poses))


@compiled
def _horizon_waypoints(
    progress: Progress,
    slots: NDArray[np.int64],
    packed: FloatArray,
    offsets: NDArray[np.int64],
    robots: FloatArray,
    stamps: FloatArray,
    numbers: tuple[float, float, float, float],
    poses: FloatArray,
    status: NDArray[np.int8],
) -> None:
    d_ahead, tolerance, t_lim, min_progress = numbers
    for k in range(len(robots)):
        path = packed[offsets[k] : offsets[k + 1]]
        slot = slots[k]
        follow_path(progress, slot, path, robots[k], stamps[k])
        waypoint = _leaves_horizon(path, progress.place[slot], robots[k], d_ahead, tolerance)
        status[k] = (
            WAYPOINT_FOUND
            if is_on_time(progress, slot, path, robots[k], stamps[k], t_lim, min_progress)
            else WAYPOINT_TIMEOUT
        )
        if waypoint < 0:
            waypoint, status[k] = progress.place[slot], OFF_PATH
        _copy_pose(path, waypoint, poses, k)


@compiled
def _leaves_horizon(path: FloatArray, place: int, robot: FloatArray, d_ahead: float, tolerance: float) -> int:
    """Return the last pose in the band about the horizon before the path first leaves it, the
    goal if it never does, -1 if none.
    """
    found = -1
    for i in range(place, len(path)):
        away = distance_to_pose(path, i, robot)
        if away >= d_ahead + tolerance:
            return found
        if away > d_ahead - tolerance:
            found = i
    return len(path) - 1


@compiled
def _spaced_waypoints(
    progress: Progress,
    current: NDArray[np.int64],
    slots: NDArray[np.int64],
    packed: FloatArray,
    offsets: NDArray[np.int64],
    robots: FloatArray,
    stamps: FloatArray,
    numbers: tuple[float, float, float, float, float],
    poses: FloatArray,
    status: NDArray[np.int8],
) -> None:
    spacing, reached_within, off_path_beyond, t_lim, min_progress = numbers
    for k in range(len(robots)):
        path = packed[offsets[k] : offsets[k + 1]]
        slot = slots[k]
        if follow_path(progress, slot, path, robots[k], stamps[k]):
            current[slot] = _pose_further_on(path, 0, spacing)
        end = len(path) - 1
        while current[slot] < end and (
            current[slot] <= progress.place[slot] or distance_to_pose(path, current[slot], robots[k]) <= reached_within
        ):
            current[slot] = _pose_further_on(path, current[slot], spacing)
        status[k] = (
            WAYPOINT_FOUND
            if is_on_time(progress, slot, path, robots[k], stamps[k], t_lim, min_progress)
            else WAYPOINT_TIMEOUT
        )
        if distance_to_pose(path, progress.place[slot], robots[k]) > off_path_beyond:
            status[k] = OFF_PATH
        _copy_pose(path, current[slot], poses, k)


@compiled
def _pose_further_on(path: FloatArray, start: int, spacing: float) -> int:
    """Return the first pose at least ``spacing`` m of path after ``start``, or the last one."""
    way, i = 0.0, start
    while i + 1 < len(path) and way < spacing - 1e-9:
        i += 1
        way += math.hypot(path[i, X] - path[i - 1, X], path[i, Y] - path[i - 1, Y])
    return i


@compiled
def _copy_pose(path: FloatArray, i: int, poses: FloatArray, k: int) -> None:
    for axis in range(3):
        poses[k, axis] = path[i, axis]
