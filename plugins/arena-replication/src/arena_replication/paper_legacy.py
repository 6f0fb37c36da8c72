"""The pack ``paper_legacy``: the figures as the original evaluation scripts computed them, so that published numbers
can be compared.

The definitions are those of arena-evaluation, ``02_evaluation/get_metrics_elias.py``, and are not in SI units:
differences are per record (about 0.4 s) and never divided by time. Use ``si`` for everything else. docs/metrics.md
lists every oddity. The preset ``paper_legacy`` rounds and cleans as that script does, ``paper_published`` does neither,
as the published rows were made.
"""

from __future__ import annotations

import math
from bisect import bisect_left
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from arena_core import EpisodeRecord, Metric, MetricPack
from arena_core.parameters import NonNegativeInt, Positive
from arena_core.records import Better

SIGNED = ("acceleration", "jerk")  # means of signed changes

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class LegacyRows:
    """The rows of one episode as the release recorded and cleaned them; per-row figures were taken before cleaning.

    ``time`` s, ``position`` (N, 2) m, ``yaw`` rad, ``laser`` m (nearest return), ``speed``, ``acceleration`` and
    ``jerk`` in m/s per record (NaN where undefined), ``curvature`` 1/m, ``curvature_normalised`` and ``roughness``;
    ``collision`` marks rising edges.
    """

    time: FloatArray
    position: FloatArray
    yaw: FloatArray
    laser: FloatArray
    collision: NDArray[np.bool_]
    speed: FloatArray
    acceleration: FloatArray
    jerk: FloatArray
    curvature: FloatArray
    curvature_normalised: FloatArray
    roughness: FloatArray

    def select_rows(self, rows: NDArray[np.intp]) -> LegacyRows:
        """Return only these rows."""
        return LegacyRows(*(getattr(self, name)[rows] for name in self.__slots__))


class PaperLegacyMetrics(MetricPack):
    """Metrics after the original release."""

    def __init__(
        self,
        record_period: Positive,
        decimals: NonNegativeInt | None,
        radii: Mapping[str, Positive],
        goal_distance: Positive,
        goal_check_period: Positive,
        time_out: Positive,
        collisions_allowed: NonNegativeInt,
        speed_max: Positive | None,
        jump_max: Positive | None,
    ) -> None:
        self._record_period = record_period
        self._decimals = decimals
        self._radii = radii
        self._goal_distance = goal_distance
        self._goal_check_period = goal_check_period
        self._time_out = time_out
        self._collisions_allowed = collisions_allowed
        self._speed_max = speed_max
        self._jump_max = jump_max

    def metrics(self) -> Sequence[Metric]:
        """Return the columns of the release's summary that a record can give."""
        return [
            Metric(
                "success",
                "0/1",
                "higher",
                "within 1 m of the goal before 177 s, at most two collisions",
                self._episode_success,
            ),
            Metric(
                "collision",
                "-",
                "lower",
                "rising edges of nearest return <= radius",
                self._reduce_rows(_collision_rows),
            ),
            self._path_metric("time", "s", "lower", "last record less first", rows_duration),
            self._path_metric("path_length", "m", "lower", "sum of distances between records", path_length),
            self._path_metric("velocity", "m/s", "higher", "mean speed", lambda rows: _finite_mean(rows.speed)),
            self._path_metric(
                "acceleration",
                "m/s/record",
                "neither",
                "mean signed change of speed",
                lambda rows: _finite_mean(rows.acceleration),
            ),
            self._path_metric(
                "jerk", "m/s/record^2", "lower", "mean second difference of speed", lambda rows: _finite_mean(rows.jerk)
            ),
            self._path_metric(
                "curvature",
                "1/m",
                "lower",
                "mean Menger curvature of records",
                lambda rows: _finite_mean(rows.curvature),
            ),
            self._path_metric(
                "curvature_max",
                "1/m",
                "lower",
                "greatest Menger curvature of records",
                lambda rows: _finite_max(rows.curvature),
            ),
            self._path_metric(
                "curvature_normalised",
                "-",
                "lower",
                "mean curvature times chords",
                lambda rows: _finite_mean(rows.curvature_normalised),
            ),
            self._path_metric(
                "roughness",
                "-",
                "lower",
                "mean height over base of records' triangles",
                lambda rows: _finite_mean(rows.roughness),
            ),
            self._path_metric(
                "angle_over_length", "rad/m", "lower", "unwrapped change of heading over path length", angle_over_length
            ),
            self._path_metric(
                "clearing_distance_min", "m", "higher", "mean nearest return", lambda rows: _finite_mean(rows.laser)
            ),
        ]

    def rows(self, record: EpisodeRecord) -> LegacyRows:
        """Return the episode as the release recorded it, ended it at the goal, and cleaned it."""
        stamps = record["stamp"][: goal_row(record, self._goal_distance, self._goal_check_period) + 1]
        kept = recorded_rows(stamps[: len(record["stamp"]) - 1], self._record_period)
        rows = row_figures(record, kept, self._decimals, self._robot_radius(record))
        return clean_rows(rows, record["twist"][kept, :2], self._speed_max, self._jump_max)

    def _robot_radius(self, record: EpisodeRecord) -> float:
        robot = record.meta["robot"]
        return float(self._radii.get(robot["name"], robot["footprint"]["radius"]))

    def _episode_success(self, record: EpisodeRecord) -> float:
        rows = self.rows(record)
        end = goal_row(record, self._goal_distance, self._goal_check_period)
        arrived = goal_distances(record)[end] < self._goal_distance
        return float(
            arrived and rows_duration(rows) < self._time_out and _collision_rows(rows) <= self._collisions_allowed
        )

    def _reduce_rows(self, reduce: Callable[[LegacyRows], float]) -> Callable[[EpisodeRecord], float]:
        return lambda record: reduce(self.rows(record))

    def _path_metric(
        self, name: str, unit: str, better: Better, text: str, reduce: Callable[[LegacyRows], float]
    ) -> Metric:
        bounds = (-math.inf, math.inf) if name in SIGNED else (0.0, math.inf)
        return Metric(name, unit, better, text, self._reduce_rows(reduce), path_metric=True, bounds=bounds)


def goal_distances(record: EpisodeRecord) -> FloatArray:
    """Return the true distance to the goal at every control step, shape (T,), m."""
    goal = record.meta["scenario"]["goal"]
    offsets: FloatArray = record["pose"][:, :2] - goal[:2]
    return np.hypot(offsets[:, 0], offsets[:, 1])


def goal_row(record: EpisodeRecord, goal_distance: float, check_period: float) -> int:
    """Return the control step at which the release ended the episode: the first check near the
    goal, else the last step.
    """
    stamps = record["stamp"] - record["stamp"][0]
    near = goal_distances(record) < goal_distance
    checks = np.searchsorted(
        stamps, check_period * np.arange(1, math.floor(stamps[-1] / check_period + 1e-6) + 1) - 1e-6
    )
    arrivals = checks[near[checks]]
    return int(arrivals[0]) if len(arrivals) else len(stamps) - 1


def recorded_rows(stamps: FloatArray, period: float) -> list[int]:
    """Return the control steps that the recorder kept: the first, then each that is ``period`` s
    or more after the last kept one.
    """
    times, kept = stamps.tolist(), []
    row = 0
    while row < len(times):
        kept.append(row)
        row = bisect_left(times, times[row] + period - 1e-6, row + 1)
    return kept


def _triangle_geometry(points_xy: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Return area and sides |ab|, |bc|, |ac| of the triangles of three consecutive points, each of shape (K - 2,)."""
    ab, bc = points_xy[1:-1] - points_xy[:-2], points_xy[2:] - points_xy[1:-1]
    area = 0.5 * np.abs(ab[:, 0] * bc[:, 1] - ab[:, 1] * bc[:, 0])
    return area, np.hypot(*ab.T), np.hypot(*bc.T), np.hypot(*(ab + bc).T)


def row_figures(record: EpisodeRecord, kept: list[int], decimals: int | None, radius: float) -> LegacyRows:
    """Return the per-row figures of the recorded rows, all values rounded as the recorder did, or not at all."""
    stamp, pose, twist, laser = (record[name][kept] for name in ("stamp", "pose", "twist", "scan_min"))
    if decimals is not None:
        stamp, pose, twist, laser = (values.round(decimals) for values in (stamp, pose, twist, laser))
    hit = laser <= radius
    speed = np.hypot(twist[:, 0], twist[:, 1])
    area, ab, bc, ac = _triangle_geometry(pose[:, :2])
    with np.errstate(divide="ignore", invalid="ignore"):  # what is not finite is left out of every mean
        curvature, roughness = 4.0 * area / (ab * bc * ac), 2.0 * area / ac**2
    acceleration = np.diff(speed)
    return LegacyRows(
        time=stamp,
        position=pose[:, :2],
        yaw=pose[:, 2],
        laser=laser,
        collision=hit & ~np.concatenate(([False], hit[:-1])),
        speed=speed,
        acceleration=_pad_nan(acceleration[:-1], len(kept)),
        jerk=_pad_nan(np.abs(np.diff(acceleration)), len(kept)),
        curvature=_pad_nan(curvature, len(kept)),
        curvature_normalised=_pad_nan(curvature * (ab + bc), len(kept)),
        roughness=_pad_nan(roughness, len(kept)),
    )


def _pad_nan(values: FloatArray, length: int) -> FloatArray:
    """Append NaN up to ``length``: a triple's figure belongs to its first row."""
    return np.concatenate((values, np.full(length - len(values), np.nan)))


def clean_rows(
    rows: LegacyRows, velocities_xy: FloatArray, speed_max: float | None, jump_max: float | None
) -> LegacyRows:
    """Drop the rows up to and with the first jump (a late odometry reset), then those with a velocity component too
    high.

    None for either limit drops nothing for it.
    """
    jumps = np.flatnonzero(np.hypot(*np.diff(rows.position, axis=0).T) > (math.inf if jump_max is None else jump_max))
    begin = int(jumps[0]) + 2 if len(jumps) else 0
    slow = np.flatnonzero(velocities_xy.max(axis=1, initial=-math.inf) < (math.inf if speed_max is None else speed_max))
    return rows.select_rows(slow[slow >= begin])


def rows_duration(rows: LegacyRows) -> float:
    """Return the time from the first to the last row, s."""
    return float(rows.time[-1] - rows.time[0]) if len(rows.time) else math.nan


def path_length(rows: LegacyRows) -> float:
    """Return the sum of distances between rows, m."""
    return float(np.hypot(*np.diff(rows.position, axis=0).T).sum())


def angle_over_length(rows: LegacyRows) -> float:
    """Return the sum of changes of heading, not wrapped, over path length, rad/m; NaN where the path has no length."""
    length = path_length(rows)
    return float(np.abs(np.diff(rows.yaw)).sum()) / length if length > 0.0 else math.nan


def _collision_rows(rows: LegacyRows) -> float:
    return float(np.count_nonzero(rows.collision))


def _finite_mean(values: FloatArray) -> float:
    finite = values[np.isfinite(values)]
    return float(finite.mean()) if len(finite) else math.nan


def _finite_max(values: FloatArray) -> float:
    finite = values[np.isfinite(values)]
    return float(finite.max()) if len(finite) else math.nan
