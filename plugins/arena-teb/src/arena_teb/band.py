"""Bands: made from a line, and carried over from one control step to the next."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from arena_core import wrap_angle
from arena_kernels.compiled import compiled
from arena_teb.columns import THETA, TIME, X, Y
from arena_teb.problem import FloatArray

SPACING = 0.1  # m between the poses of a new band
TURN_FROM = 1.0  # rad between the robot's heading and the line's from which a new band begins with a turn on the spot
TURN_STEP = 0.5  # rad between the poses of that turn
TURN_ARM = 0.2  # m by which a turn is compared with a way
LEAST_TIME = 0.02  # s between two poses of a new band
LEAST_WAY = 1e-6  # m between two corners of a line: nearer ones are one
PRUNE_AHEAD = 10  # poses that the robot may have passed since the last step (teb_local_planner)


@dataclass(frozen=True, slots=True)
class FirstDrive:
    """How a new band is driven: at ``speed`` m/s, turning on the spot with ``turn`` rad/s; ``reverses``: a line that
    begins behind the robot is driven backwards.
    """

    speed: float
    turn: float
    reverses: bool


def band_along(line: FloatArray, start: FloatArray, goal: FloatArray, drive: FirstDrive) -> FloatArray:
    """Return a band (N, 4) along positions ``line`` (M, 2) from pose ``start`` to pose ``goal``.

    A first heading that differs from the line's is turned to on the spot.
    """
    points = resample_polyline(np.concatenate((start[None, :2], line, goal[None, :2])))
    if len(points) < 3:
        points = np.linspace(start[:2], goal[:2], 3)
    steps = np.diff(points, axis=0)
    headings = np.append(np.arctan2(steps[:, Y], steps[:, X]), goal[THETA])
    if drive.reverses and abs(wrap_angle(headings[0] - start[THETA])) > 0.5 * math.pi:
        headings[:-1] = wrap_angle(headings[:-1] + math.pi)
    times = np.append(np.maximum(np.hypot(*steps.T) / drive.speed, LEAST_TIME), LEAST_TIME)
    turning = turn_on_spot(start, float(wrap_angle(headings[0] - start[THETA])), drive.turn)
    if len(turning) == 0:
        headings[0] = start[THETA]
    return np.ascontiguousarray(np.concatenate((turning, np.column_stack((points, headings, times)))))


def turn_on_spot(start: FloatArray, angle: float, turn: float) -> FloatArray:
    """Return poses (N, 4) of a turn at ``start`` by ``angle``, none where it is small; the pose
    after the turn is left out.
    """
    if abs(angle) < TURN_FROM:
        return np.empty((0, 4))
    parts = math.ceil(abs(angle) / TURN_STEP)
    headings = start[THETA] + angle * np.arange(parts) / parts
    return np.column_stack((np.tile(start[:2], (parts, 1)), headings, np.full(parts, abs(angle) / turn / parts)))


@compiled
def resample_polyline(points: FloatArray) -> FloatArray:
    """Return positions at most SPACING apart along a polyline (M, 2), ends included."""
    along, kept, corners = np.zeros(len(points)), np.empty(len(points), np.int64), 0
    for i in range(len(points)):
        if i + 1 < len(points):
            along[i + 1] = along[i] + math.hypot(points[i + 1, X] - points[i, X], points[i + 1, Y] - points[i, Y])
        if i + 1 == len(points) or along[i + 1] - along[i] > LEAST_WAY:
            kept[corners] = i
            corners += 1
    count = max(2, math.ceil(along[-1] / SPACING) + 1)
    found, corner = np.empty((count, 2)), 0
    for i in range(count):
        at = i * (along[-1] / (count - 1)) if i + 1 < count else along[-1]
        while corner + 1 < corners and along[kept[corner + 1]] <= at:
            corner += 1
        before = kept[corner]
        if corner + 1 == corners or at <= along[before]:
            found[i] = points[before]
            continue
        behind = kept[corner + 1]
        for axis in range(2):
            slope = (points[behind, axis] - points[before, axis]) / (along[behind] - along[before])
            found[i, axis] = slope * (at - along[before]) + points[before, axis]
    return found


def prune_band(band: FloatArray, start: FloatArray, goal: FloatArray, fewest: int) -> FloatArray:
    """Return a band that begins at pose ``start``, without the poses that the robot
    has passed, and ends at ``goal``.
    """
    last = min(PRUNE_AHEAD, len(band) - fewest)
    passed = 0
    if last > 0:
        away = np.hypot(band[: last + 1, 0] - start[X], band[: last + 1, 1] - start[Y])
        passed = int(np.argmin(away))
    kept = band[passed:].copy()
    before = pose_distance(kept[0], kept[1])
    kept[0, :TIME] = start
    kept[0, TIME] *= min(max(pose_distance(kept[0], kept[1]) / before, 0.1), 1.0) if before > 0.0 else 1.0
    kept[-1, :TIME] = goal
    return kept


def pose_distance(pose: FloatArray, other: FloatArray) -> float:
    """Return how far apart two poses are, a turn counted as the way of a point TURN_ARM away."""
    return math.hypot(other[X] - pose[X], other[Y] - pose[Y]) + TURN_ARM * abs(
        float(wrap_angle(other[THETA] - pose[THETA]))
    )


def band_duration(band: FloatArray) -> float:
    """Return how long a band takes, s."""
    return float(band[:-1, TIME].sum())
