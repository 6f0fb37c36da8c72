"""How the robot drove: extremes of speed and its derivatives, turns and changes of direction."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from arena_core import EpisodeRecord, wrap_angle
from arena_metrics.packs.motion import path_length, polyline_length, resample_by_length, velocities_map
from arena_metrics.packs.people_gaps import row_times
from arena_metrics.packs.progress import path_in_force

FloatArray = NDArray[np.float64]
STILL = 1e-9  # m of path below which a ratio to its length says nothing


def extreme_rate(
    record: EpisodeRecord, derivative_period: float, order: int, reduce: Callable[[FloatArray], Any]
) -> float:
    """Return the least or greatest magnitude of the velocity's difference quotient of this order (0: speed m/s, 1:
    acceleration m/s^2, 2: jerk m/s^3); NaN for too short an episode.
    """
    samples = velocities_map(record["stamp"], record["pose"], record["twist"], derivative_period)
    if len(samples) <= order:
        return math.nan
    return float(reduce(np.hypot(*np.diff(samples, n=order, axis=0).T))) / derivative_period**order


def heading_change(record: EpisodeRecord) -> float:
    """Return the sum of wrapped changes of heading, rad."""
    return float(np.abs(wrap_angle(np.diff(record["pose"][:, 2]))).sum())


def path_efficiency(record: EpisodeRecord) -> float:
    """Return the length of the first global path over that driven, at most 1; NaN for a robot that stood."""
    driven = path_length(record)
    first = polyline_length(path_in_force(record, float(record["stamp"][0])))
    return min(first / driven, 1.0) if driven > STILL else math.nan


def path_irregularity(record: EpisodeRecord, path_step: float) -> float:
    """Return by how much the path driven turns more than the first global path, rad/m of path driven, 0 at least; NaN
    for a path shorter than two steps.
    """
    driven = path_length(record)
    if driven < 2.0 * path_step:
        return math.nan
    needed = _turning(path_in_force(record, float(record["stamp"][0])), path_step)
    return max(_turning(record["pose"][:, :2], path_step) - needed, 0.0) / driven


def _turning(points_xy: FloatArray, path_step: float) -> float:
    """Return the sum of changes of direction between points every ``path_step`` m of arc length, rad."""
    steps = np.diff(resample_by_length(points_xy, path_step), axis=0)
    moved = steps[np.hypot(*steps.T) > STILL]
    return float(np.abs(wrap_angle(np.diff(np.arctan2(moved[:, 1], moved[:, 0])))).sum())


def motion_energy(record: EpisodeRecord) -> float:
    """Return the time integral of the squared speed, m^2/s: of the kinetic energy, twice, for each kilogram."""
    return float((row_times(record) * (record["twist"][:, :2] ** 2).sum(axis=1)).sum())


def reversals(record: EpisodeRecord, standing_speed: float) -> float:
    """Return how often the robot changed between forward and backward, 1/min, a pause between not counted; NaN for
    no duration.
    """
    forward = record["twist"][:, 0]
    signs = np.sign(forward[np.abs(forward) > standing_speed])
    time = float(record["stamp"][-1] - record["stamp"][0])
    return 60.0 * float(np.count_nonzero(np.diff(signs))) / time if time > 0.0 else math.nan


def yaw_rate_mean(record: EpisodeRecord) -> float:
    """Return the mean magnitude of the yaw rate over time, rad/s; NaN for no duration."""
    times = row_times(record)
    total = float(times.sum())
    return float((times * np.abs(record["twist"][:, 2])).sum()) / total if total > 0.0 else math.nan
