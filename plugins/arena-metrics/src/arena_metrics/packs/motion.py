"""How the robot moved: length, velocity and its derivatives, curvature and roughness of the true path."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from arena_core import EpisodeRecord, wrap_angle

FloatArray = NDArray[np.float64]
MOST_SAMPLES = 5_000_000  # of one episode: a day at 0.02 s
ROUGHNESS_MAX = 1.0  # what a reversal counts, whose triangle has no base


def polyline_length(points_xy: FloatArray) -> float:
    """Return the length of a polyline (K, 2), m."""
    return float(np.hypot(*np.diff(points_xy, axis=0).T).sum())


def path_length(record: EpisodeRecord) -> float:
    """Return the length of the true path, m."""
    return polyline_length(record["pose"][:, :2])


def mean_speed(record: EpisodeRecord) -> float:
    """Return the mean speed, path length over time, m/s; NaN for an episode of no duration."""
    time = float(record["stamp"][-1] - record["stamp"][0])
    return path_length(record) / time if time > 0.0 else math.nan


def longest_stand(record: EpisodeRecord, stand_radius: float) -> float:
    """Return the longest time that the robot took to leave a circle about where it had left the one before, s."""
    stamps, positions = record["stamp"], record["pose"][:, :2]
    longest, begun = 0.0, 0
    while begun < len(stamps) - 1:
        outside = np.flatnonzero(np.hypot(*(positions[begun:] - positions[begun]).T) >= stand_radius)
        left = begun + int(outside[0]) if len(outside) else len(stamps) - 1
        longest, begun = max(longest, float(stamps[left] - stamps[begun])), left
    return longest


def reverse_share(record: EpisodeRecord, standing_speed: float) -> float:
    """Return the share of time in which the robot's front moved back faster than
    ``standing_speed`` m/s; NaN for no duration.
    """
    back = (record["twist"][:, 0] < -standing_speed).astype(float)
    periods = np.diff(record["stamp"])
    return float((periods * 0.5 * (back[1:] + back[:-1])).sum() / periods.sum()) if len(periods) else math.nan


def mean_acceleration(record: EpisodeRecord, derivative_period: float) -> float:
    """Return the mean magnitude of the acceleration vector, m/s^2."""
    return _mean_derivative(record, derivative_period, order=1)


def mean_jerk(record: EpisodeRecord, derivative_period: float) -> float:
    """Return the mean magnitude of the jerk vector, m/s^3 (after Flash and Hogan 1985)."""
    return _mean_derivative(record, derivative_period, order=2)


def jerk_without_contact(record: EpisodeRecord, derivative_period: float) -> float:
    """Return the mean jerk over the triples of velocities during which the robot touched
    nothing, m/s^3; NaN where there is none.
    """
    samples = velocities_map(record["stamp"], record["pose"], record["twist"], derivative_period)
    begins = record["stamp"][0] + derivative_period * np.arange(len(samples) - 2)
    free = ~contact_spans(record, begins, begins + 2.0 * derivative_period)
    jerks = np.hypot(*np.diff(samples, n=2, axis=0).T)[free] / derivative_period**2
    return float(jerks.mean()) if len(jerks) else math.nan


def contact_spans(record: EpisodeRecord, begins: FloatArray, ends: FloatArray) -> NDArray[np.bool_]:
    """Tell which spans of time (K,) share more than an instant with a control step in contact."""
    stamps = record["stamp"]
    before = np.concatenate(([0], np.cumsum(record["contact_time"][1:] > 0.0)))  # steps in contact up to each row
    first = np.searchsorted(stamps, begins + 1e-6, side="right") - 1
    last = np.searchsorted(stamps, ends - 1e-6, side="left")
    return before[np.minimum(last, len(stamps) - 1)] > before[np.maximum(first, 0)]


def _mean_derivative(record: EpisodeRecord, period: float, order: int) -> float:
    """Return the mean magnitude of the velocity's difference quotient of this order; NaN for too short an episode."""
    samples = velocities_map(record["stamp"], record["pose"], record["twist"], period)
    if len(samples) <= order:
        return math.nan
    return float(np.hypot(*np.diff(samples, n=order, axis=0).T).mean()) / period**order


def velocities_map(stamps: FloatArray, poses: FloatArray, twists: FloatArray, period: float) -> FloatArray:
    """Return the velocity in ``map`` at every ``period`` s from the first stamp on, interpolated, shape (K, 2)."""
    c, s = np.cos(poses[:, 2]), np.sin(poses[:, 2])
    vx = c * twists[:, 0] - s * twists[:, 1]
    vy = s * twists[:, 0] + c * twists[:, 1]
    count = math.floor((stamps[-1] - stamps[0]) / period + 1e-6) + 1
    at = stamps[0] + period * np.arange(_check_count(count))
    return np.stack((np.interp(at, stamps, vx), np.interp(at, stamps, vy)), axis=1)


def resample_by_length(points_xy: FloatArray, step: float) -> FloatArray:
    """Return points on the polyline every ``step`` m of arc length from its start, shape (K, 2); standing adds none."""
    along = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(points_xy, axis=0).T))))
    at = step * np.arange(_check_count(math.floor(along[-1] / step + 1e-6) + 1))
    return np.stack((np.interp(at, along, points_xy[:, 0]), np.interp(at, along, points_xy[:, 1])), axis=1)


def _check_count(samples: int) -> int:
    """Return a number of samples that memory has room for; raise ValueError for more."""
    if samples > MOST_SAMPLES:
        raise ValueError(f"{samples} samples of one episode; allowed: {MOST_SAMPLES}, by a larger period or step")
    return samples


def triangle_geometry(points_xy: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Return area and sides |ab|, |bc|, |ac| of the triangles of three consecutive points, each of shape (K - 2,)."""
    ab, bc = points_xy[1:-1] - points_xy[:-2], points_xy[2:] - points_xy[1:-1]
    area = 0.5 * np.abs(ab[:, 0] * bc[:, 1] - ab[:, 1] * bc[:, 0])
    return area, np.hypot(*ab.T), np.hypot(*bc.T), np.hypot(*(ab + bc).T)


def menger_curvatures(points_xy: FloatArray, step: float) -> tuple[FloatArray, FloatArray]:
    """Return the Menger curvature of each triple of resampled points, 1/m, and the same times |ab| + |bc|.

    It is at most 2 / step, which is what a reversal counts: three points ``step`` apart lie on no smaller circle.
    """
    area, ab, bc, ac = triangle_geometry(resample_by_length(points_xy, step))
    sides = ab * bc * ac
    limit = 2.0 / step
    curvature = np.minimum(np.divide(4.0 * area, sides, out=np.full_like(sides, limit), where=sides > 1e-12), limit)
    return curvature, curvature * (ab + bc)


def curvature_mean(record: EpisodeRecord, path_step: float) -> float:
    """Return the mean curvature, 1/m; NaN for a path shorter than two steps."""
    curvature, _ = menger_curvatures(record["pose"][:, :2], path_step)
    return float(curvature.mean()) if len(curvature) else math.nan


def curvature_max(record: EpisodeRecord, path_step: float) -> float:
    """Return the greatest curvature, 1/m; NaN for a path shorter than two steps."""
    curvature, _ = menger_curvatures(record["pose"][:, :2], path_step)
    return float(curvature.max()) if len(curvature) else math.nan


def curvature_min(record: EpisodeRecord, path_step: float) -> float:
    """Return the least curvature, 1/m; NaN for a path shorter than two steps."""
    curvature, _ = menger_curvatures(record["pose"][:, :2], path_step)
    return float(curvature.min()) if len(curvature) else math.nan


def curvature_normalised(record: EpisodeRecord, path_step: float) -> float:
    """Return the mean of curvature times the length of its two chords; NaN for a path shorter than two steps."""
    _, normalised = menger_curvatures(record["pose"][:, :2], path_step)
    return float(normalised.mean()) if len(normalised) else math.nan


def path_roughness(record: EpisodeRecord, path_step: float) -> float:
    """Return the mean height over base of the path's triangles, at most 1 each; NaN
    for a path shorter than two steps.
    """
    area, _, _, ac = triangle_geometry(resample_by_length(record["pose"][:, :2], path_step))
    base = ac**2
    heights = np.divide(2.0 * area, base, out=np.full_like(base, ROUGHNESS_MAX), where=base > 1e-12)
    return float(np.minimum(heights, ROUGHNESS_MAX).mean()) if len(heights) else math.nan


def angle_over_length(record: EpisodeRecord, path_step: float) -> float:
    """Return the sum of wrapped changes of heading over path length, rad/m; NaN for a path shorter than two steps."""
    length = path_length(record)
    turned = float(np.abs(wrap_angle(np.diff(record["pose"][:, 2]))).sum())
    return turned / length if length >= 2.0 * path_step else math.nan
