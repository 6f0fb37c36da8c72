"""How far an episode came along its path, and where it came no farther."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from arena_core import EpisodeRecord
from arena_metrics.packs.motion import polyline_length
from arena_metrics.packs.outcome import PERSON
from arena_metrics.packs.people_gaps import row_times

FloatArray = NDArray[np.float64]


def timed_out(record: EpisodeRecord) -> float:
    """Return 1 where the time was over before the robot had arrived, else 0."""
    return float(record.meta["outcome"] == "time_out")


def failures_to_progress(record: EpisodeRecord, progress_window: float, progress_least: float) -> float:
    """Count windows of ``progress_window`` s, one after the other, in which the robot came less than
    ``progress_least`` m forward along the path in force when the window began; NaN for an episode shorter than one.
    """
    stamps = record["stamp"]
    count = math.floor((stamps[-1] - stamps[0]) / progress_window + 1e-6)
    if count < 1:
        return math.nan
    ends = stamps[0] + progress_window * np.arange(count + 1)
    places = np.stack([np.interp(ends, stamps, record["pose"][:, axis]) for axis in (0, 1)], axis=1)
    gained = [_gain(record, ends[k], places[k : k + 2]) for k in range(count)]
    return float(sum(gain < progress_least - 1e-9 for gain in gained))


def _gain(record: EpisodeRecord, stamp: float, places: FloatArray) -> float:
    """Return how much farther along the path in force at ``stamp`` the second of two places is, m."""
    before, after = along_path(path_in_force(record, stamp), places)
    return float(after - before)


def path_in_force(record: EpisodeRecord, stamp: float) -> FloatArray:
    """Return the global path that was planned last at ``stamp`` s, (M, 2), m: the straight line to the goal where there
    is none.
    """
    offsets = record["path_offsets"]
    latest = max(int(np.searchsorted(record["path_stamps"], stamp + 1e-9, side="right")) - 1, 0)
    path: FloatArray = np.empty((0, 2))
    if len(offsets) > 1:
        path = record["path_poses"][offsets[latest] : offsets[latest + 1], :2]
    if len(path) < 2:
        scenario = record.meta["scenario"]
        path = np.array((scenario["start"][:2], scenario["goal"][:2]), float)
    return path


def along_path(path_xy: FloatArray, places: FloatArray) -> FloatArray:
    """Return the arc length of the point of a path (M, 2) nearest to each place (K, 2), m."""
    starts, sides = path_xy[:-1], np.diff(path_xy, axis=0)
    squares = (sides**2).sum(axis=1)
    relative = places[:, None] - starts
    share = (relative * sides).sum(axis=2) / np.where(squares > 0.0, squares, 1.0)
    share = np.clip(share, 0.0, 1.0)
    off = ((relative - share[..., None] * sides) ** 2).sum(axis=2)
    nearest = off.argmin(axis=1)
    lengths = np.sqrt(squares)
    reached = np.concatenate(([0.0], np.cumsum(lengths)))[nearest]
    found: FloatArray = reached + share[np.arange(len(places)), nearest] * lengths[nearest]
    return found


def completion(record: EpisodeRecord) -> float:
    """Return the share of the first global path behind the robot at the end, 1 where the goal was reached; NaN for a
    path of no length.
    """
    path = path_in_force(record, float(record["stamp"][0]))
    length = polyline_length(path)
    if length <= 0.0:
        return math.nan
    if record.meta["outcome"] == "goal_reached":
        return 1.0
    return min(float(along_path(path, record["pose"][-1:, :2])[0]) / length, 1.0)


def goal_distance_min(record: EpisodeRecord) -> float:
    """Return the least true distance to the goal, m."""
    goal = np.asarray(record.meta["scenario"]["goal"][:2], float)
    return float(np.hypot(*(record["pose"][:, :2] - goal).T).min())


def stalled_time(record: EpisodeRecord, standing_speed: float, turning_speed: float) -> float:
    """Return the time in which the robot neither drove nor turned, s (trapezoidal over the control steps)."""
    speeds, turns = np.hypot(*record["twist"][:, :2].T), np.abs(record["twist"][:, 2])
    return float(row_times(record)[(speeds < standing_speed) & (turns < turning_speed)].sum())


def people_touched(record: EpisodeRecord) -> float:
    """Count the people who were touched, each once, however often."""
    return float(len(np.unique(record["contact_person"][record["contact_kind"] == PERSON])))
