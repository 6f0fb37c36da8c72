"""What encoders have in common: their layout as bounds, and the kernels that look at the world from the robot."""

from __future__ import annotations

import math
import re
from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from arena_core import Lidar, ObservationBatch, ObservationEncoder, ObservationField, Robot
from arena_kernels.compiled import borrowing, inner

Floats = NDArray[np.float64]
Numbers = NDArray[np.float32]

BODY = re.compile(r"less \d+\.\d{3} m")  # in the meaning of a field that counts from the circle about the body


class BoundedEncoder(ObservationEncoder):
    """An encoder that fills rows by ``write`` and cuts them to the bounds of its layout."""

    def __init__(self, fields: tuple[ObservationField, ...]) -> None:
        self._fields = fields
        self._low = np.concatenate([np.full(f.size, f.low, np.float32) for f in fields])
        self._high = np.concatenate([np.full(f.size, f.high, np.float32) for f in fields])

    def layout(self) -> tuple[ObservationField, ...]:
        """Return the fields of an encoded observation."""
        return self._fields

    def encode(self, observations: ObservationBatch) -> Numbers:
        """Return new numbers (N, D) within the layout's bounds."""
        rows = np.empty((len(observations.poses), len(self._low)), np.float32)
        self.write(observations, rows)
        _clip_rows(rows, self._low, self._high)
        return rows

    @abstractmethod
    def write(self, observations: ObservationBatch, rows: Numbers) -> None:
        """Fill ``rows`` (N, D)."""


def field_columns(layout: Sequence[ObservationField], name: str) -> slice:
    """Return the columns that a field has in rows of this layout."""
    place = [field.name for field in layout].index(name)
    start = sum(field.size for field in layout[:place])
    return slice(start, start + layout[place].size)


def speed_scales(robot: Robot) -> Floats:
    """Return a robot's greatest speeds (vx, wz), for omnidirectional ones (vx, vy, wz), m/s and rad/s."""
    limits = robot.limits
    forward = max(limits.vx_max, -limits.vx_min)
    return np.array((forward, limits.vy_max, limits.wz_max) if robot.holonomic else (forward, limits.wz_max))


def closeness_field(name: str, size: int, range_max: float, robot: Robot, decay: float, when: str) -> ObservationField:
    """Return the field that ``write_closeness`` fills for a scan taken ``when``."""
    radius = robot.footprint.radius
    farthest = range_max - radius
    low = 2.0 * math.exp(-farthest / decay) - farthest / range_max
    high = 2.0 * math.exp(radius / decay) + radius / range_max
    meaning = f"2 exp(-gap / {decay:g} m) - gap / {range_max:g} m; gap: least range of a sector less {radius:.3f} m"
    return ObservationField(name, size, "-", low, high, meaning + when)


def without_body_radius(field: ObservationField) -> ObservationField:
    """Return what a field says whatever the body: a gap means the same on a larger one, only its
    bounds go with the radius.
    """
    if not BODY.search(field.meaning):
        return field
    return replace(field, low=0.0, high=0.0, meaning=BODY.sub("less the body's radius", field.meaning))


def sector_order(sectors: int, overlap: int, lidar: Lidar) -> NDArray[np.int64]:
    """Return which sectors are shown, one after the other.

    Those of a lidar that looks all round begin behind the robot, and the first ``overlap`` of them come once more.
    """
    if (lidar.beams + 0.5) * lidar.angle_increment < 2.0 * math.pi:
        return np.arange(sectors)
    behind = round((math.pi - lidar.angle_min) / (2.0 * math.pi) * sectors)
    return (np.arange(sectors + min(overlap, sectors)) + behind) % sectors


@borrowing
def _clip_rows(rows: Numbers, low: Numbers, high: Numbers) -> None:
    """Cut ``rows`` (N, D) to bounds (D,); what is not a number stays."""
    for k in range(rows.shape[0]):
        for j in range(rows.shape[1]):
            if rows[k, j] < low[j]:
                rows[k, j] = low[j]
            elif rows[k, j] > high[j]:
                rows[k, j] = high[j]


@borrowing
def all_finite(rows: Numbers) -> bool:
    """Return whether all of ``rows`` (N, D) are finite."""
    for k in range(rows.shape[0]):
        for j in range(rows.shape[1]):
            if not math.isfinite(rows[k, j]):
                return False
    return True


@borrowing
def write_ranges(ranges: Numbers, range_max: float, scale: float, sectors: int, rows: Numbers) -> None:
    """Write the least range of each sector to the first columns of ``rows`` (N, D), at most
    ``range_max`` m, over ``scale`` m.
    """
    for k in range(len(rows)):
        for s in range(sectors):
            rows[k, s] = _nearest_in_sector(ranges, k, s, sectors, range_max) / scale


@borrowing
def nearest_in_sectors(ranges: Numbers, range_max: float, out: Floats) -> None:
    """Fill ``out`` (N, S) with the least range of each sector, at most ``range_max`` m."""
    for k in range(len(out)):
        for s in range(out.shape[1]):
            out[k, s] = _nearest_in_sector(ranges, k, s, out.shape[1], range_max)


@borrowing
def nearest_in_scans(ranges: Numbers, earlier: NDArray[np.float32], range_max: float, out: Floats) -> None:
    """Fill ``out`` (N, 1 + L, S) with the least range of each sector, at most ``range_max`` m, of scans (N,
    B) and L earlier ones each.
    """
    for k in range(len(out)):
        for scan in range(out.shape[1]):
            for s in range(out.shape[2]):
                beams = ranges if scan == 0 else earlier[:, scan - 1]
                out[k, scan, s] = _nearest_in_sector(beams, k, s, out.shape[2], range_max)


@borrowing
def write_closeness(
    nearest: Floats, order: NDArray[np.int64], range_max: float, radius: float, decay: float, rows: Numbers
) -> None:
    """Write how close the sectors ``order`` (M,) are of scans whose nearest returns are (N, C, S), scan after scan.

    Closeness is 2 exp(-gap / decay) - gap / range_max, where the gap is the least range less ``radius``, m.
    """
    for k in range(len(rows)):
        for scan in range(nearest.shape[1]):
            for place in range(len(order)):
                gap = nearest[k, scan, order[place]] - radius
                rows[k, scan * len(order) + place] = 2.0 * math.exp(-gap / decay) - gap / range_max


@borrowing
def _nearest_in_sector(ranges: Numbers, k: int, sector: int, sectors: int, range_max: float) -> float:
    """Return the least range of a sector, ``range_max`` if none is less;

    NaN where one is, to be refused later. Sectors share the beams.
    """
    beams = ranges.shape[1]
    nearest = range_max
    for b in range(sector * beams // sectors, (sector + 1) * beams // sectors):
        if math.isnan(ranges[k, b]):
            return math.nan
        nearest = min(nearest, float(ranges[k, b]))
    return nearest


@borrowing
def write_distances_bearings(targets: Floats, poses: Floats, out: Floats) -> None:
    """Fill ``out`` (N, 4) with distance, m, bearing, its cosine and its sine of targets (N, 3) as seen from poses (N,
    3).

    In a kernel, for numpy's own sine differs in the last bit between batches of different sizes.
    """
    for k in range(len(poses)):
        out[k, 0], out[k, 1], out[k, 2], out[k, 3] = _distance_bearing(targets, poses, k)


@borrowing
def write_bearing(targets: Floats, poses: Floats, unit: float, start: int, rows: Numbers) -> None:
    """Write the distance over ``unit`` m, the bearing's cosine and its sine of targets, as in
    ``write_distances_bearings``, to columns from ``start`` on.
    """
    for k in range(len(poses)):
        distance, _, c, s = _distance_bearing(targets, poses, k)
        rows[k, start], rows[k, start + 1], rows[k, start + 2] = distance / unit, c, s


@inner
def _distance_bearing(targets: Floats, poses: Floats, k: int) -> tuple[float, float, float, float]:
    dx, dy = targets[k, 0] - poses[k, 0], targets[k, 1] - poses[k, 1]
    bearing = math.atan2(dy, dx) - poses[k, 2]
    c, s = math.cos(bearing), math.sin(bearing)
    return math.hypot(dx, dy), math.atan2(s, c), c, s


@borrowing
def write_robot_points(
    points: Floats, poses: Floats, units: Floats, resolution: float, start: int, rows: Numbers
) -> None:
    """Write points (N, K, 2) of ``map``, in the frames of poses (N, 3) and each over its unit (K,), to columns from
    ``start`` on.

    A ``resolution``, m, rounds them; 0: none does.
    """
    for k in range(len(poses)):
        c, s = math.cos(poses[k, 2]), math.sin(poses[k, 2])
        for j in range(points.shape[1]):
            dx, dy = points[k, j, 0] - poses[k, 0], points[k, j, 1] - poses[k, 1]
            x, y = c * dx + s * dy, c * dy - s * dx
            if resolution > 0.0:
                x, y = np.rint(x / resolution) * resolution, np.rint(y / resolution) * resolution
            rows[k, start + 2 * j], rows[k, start + 2 * j + 1] = x / units[j], y / units[j]


@borrowing
def write_speeds(speeds: Floats, scales: Floats, start: int, rows: Numbers) -> None:
    """Write velocities (N, 3) over their scales, (vx, vy, wz) or (vx, wz), to columns from ``start`` on."""
    last = len(scales) - 1
    for k in range(len(speeds)):
        for j in range(last + 1):
            rows[k, start + j] = speeds[k, 2 if j == last else j] / scales[j]
