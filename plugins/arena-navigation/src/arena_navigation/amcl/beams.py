"""Which beams of a scan the filter looks at: evenly spaced ones, and not people who stand in front of the map."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arena_core import LaserScan, Pose
from arena_kernels.compiled import borrowing
from arena_kernels.grids import GridStack
from arena_kernels.raycast import Beams, cast_grid, make_beams, scan_grids
from arena_kernels.scalars import Integer
from arena_navigation.columns import COSINE, SINE, X, Y

_FIRST = np.zeros(1, np.int64)
_rays = lru_cache(maxsize=8)(make_beams)


class ExpectedWalls(NamedTuple):
    """What beams are expected to hit: the first grid of ``stack``, seen from a ``sensor`` at (x, y, theta) in ``map``.

    Beams that end more than ``short_by`` m in front of it have hit people; 0: the map tells nothing.
    """

    stack: GridStack
    sensor: tuple[float, float, float]
    short_by: float


def _no_stack() -> GridStack:
    bytes_, whole, pairs = np.empty(0, np.uint8), np.empty(0, np.int64), np.empty((0, 2))
    shapes = np.empty((0, 2), np.int64)
    return GridStack(
        bytes_, np.empty(0, np.float32), bytes_, whole, whole, shapes, np.empty(0), np.empty((0, 3)), pairs
    )


NO_WALLS = ExpectedWalls(_no_stack(), (0.0, 0.0, 0.0), 0.0)


class ScanLayout(NamedTuple):
    """How a scan's B beams are looked at: ``directions`` (2, B) in ``base_link`` from ``mount`` (x, y), and ``rays`` to
    cast in a map.

    Then scratch space: the shortest ranges that count, ``least`` (B,), and where the beams end, ``ends`` (2 B,).
    """

    directions: NDArray[np.float64]
    mount: tuple[float, float]
    rays: Beams
    least: NDArray[np.float32]
    ends: NDArray[np.float32]


@lru_cache(maxsize=8)
def _make_layout(angle_min: float, angle_increment: float, count: int, range_max: float, mount: Pose) -> ScanLayout:
    angles = mount.theta + angle_min + angle_increment * np.arange(count)
    rays = _rays(angle_min, angle_increment, count, range_max)
    at = float(mount.x), float(mount.y)
    return ScanLayout(
        np.stack((np.cos(angles), np.sin(angles))),
        at,
        rays,
        np.empty(count, np.float32),
        np.empty(2 * count, np.float32),
    )


def scan_layout(scan: LaserScan) -> ScanLayout:
    """Return how a scan's beams are looked at, made once."""
    return _make_layout(scan.angle_min, scan.angle_increment, len(scan.ranges), scan.range_max, scan.mount)


def thin_scan(scan: LaserScan, max_beams: int) -> LaserScan:
    """Return the scan with every k-th beam only, at most ``max_beams`` of them."""
    step = max(math.ceil(len(scan.ranges) / max_beams), 1)
    return replace(scan, angle_increment=step * scan.angle_increment, ranges=scan.ranges[::step])


def predict_ranges(scan: LaserScan, walls: ExpectedWalls) -> NDArray[np.float32]:
    """Return the ranges (B,) that the same beams would have if they all hit the walls."""
    ranges = np.empty((1, len(scan.ranges)), np.float32)
    scan_grids(walls.stack, _FIRST, np.array((walls.sensor,)), rays_of(scan, scan.range_max), ranges)
    seen: NDArray[np.float32] = ranges[0]
    return seen


@borrowing
def write_least(walls: ExpectedWalls, look: ScanLayout) -> None:
    """Write the range below which each beam ends too far in front of the walls."""
    look.least[:] = 0.0
    if walls.short_by > 0.0:
        x, y, theta = walls.sensor
        cast_grid(walls.stack, 0, (x, y, theta), look.rays, look.least)
        for i in range(len(look.least)):
            look.least[i] -= np.float32(walls.short_by)


@borrowing
def write_ends(
    ranges: NDArray[np.float32], min_range: float, max_range: float, look: ScanLayout
) -> tuple[Integer, float]:
    """Write where the beams of at least ``min_range`` and less than ``max_range`` m end, first all x, then all y, m in
    ``base_link``.

    Those shorter than the least ranges are left out; return how many are left, and what share that is.
    """
    hit, kept = 0, 0
    for i in range(len(ranges)):
        counts = min_range <= ranges[i] < max_range
        hit += counts
        kept += counts and ranges[i] >= look.least[i]
    at = 0
    for i in range(len(ranges)):
        away = float(ranges[i])
        if min_range <= away < max_range and away >= look.least[i]:
            look.ends[at] = look.mount[X] + away * look.directions[COSINE, i]
            look.ends[kept + at] = look.mount[Y] + away * look.directions[SINE, i]
            at += 1
    return kept, kept / max(hit, 1)


def measured_ranges(
    scan: LaserScan, min_range: float, max_range: float, least: NDArray[np.float32] | float
) -> tuple[NDArray[np.float32], float]:
    """Return the ranges (B,), m, ``max_range`` where nothing nearer was hit, for the beam model; with the share that is
    left.

    Those shorter than ``min_range`` or than ``least`` m are not a number: they are left out.
    """
    ranges = np.minimum(scan.ranges.astype(np.float32), np.float32(max_range))
    seen = ranges >= min_range
    kept = seen & (ranges >= np.minimum(least, max_range))
    return np.where(kept, ranges, np.float32(np.nan)), int(np.count_nonzero(kept)) / max(int(np.count_nonzero(seen)), 1)


def rays_of(scan: LaserScan, range_max: float) -> Beams:
    """Return the scan's beams, made once, that see up to ``range_max`` m."""
    return _rays(scan.angle_min, scan.angle_increment, len(scan.ranges), range_max)
