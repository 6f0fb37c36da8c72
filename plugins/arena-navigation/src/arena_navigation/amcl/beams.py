"""Which beams of a scan the filter looks at: evenly spaced ones, and not people who stand in front of the map."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from arena_core import LaserScan, Pose
from arena_kernels.grids import GridStack
from arena_kernels.raycast import Beams, make_beams, scan_grids

_FIRST = np.zeros(1, np.int64)
_rays = lru_cache(maxsize=8)(make_beams)


def thinned(scan: LaserScan, max_beams: int) -> LaserScan:
    """Return the scan with every k-th beam only, at most ``max_beams`` of them."""
    step = max(math.ceil(len(scan.ranges) / max_beams), 1)
    return replace(scan, angle_increment=step * scan.angle_increment, ranges=scan.ranges[::step])


def predicted(scan: LaserScan, stack: GridStack, pose: Pose) -> NDArray[np.float32]:
    """Return the ranges (B,) that the same beams would have in the first grid of ``stack``, ``base_link`` at ``pose`` in ``map``."""
    rays = rays_of(scan, scan.range_max)
    ranges = np.empty((1, len(scan.ranges)), np.float32)
    scan_grids(stack, _FIRST, pose.compose(scan.mount).array()[None], rays, ranges)
    seen: NDArray[np.float32] = ranges[0]
    return seen


def beam_ends(scan: LaserScan, min_range: float, max_range: float, least: NDArray[np.float32] | float) -> tuple[NDArray[np.float32], float]:
    """Return where the beams of at least ``min_range`` and less than ``max_range`` m end, (2, K) in ``base_link``, m.

    Those shorter than ``least`` m are left out; the share that is left comes with the ends.
    """
    ranges = scan.ranges.astype(np.float64)
    hit = (ranges >= min_range) & (ranges < max_range)
    kept = np.flatnonzero(hit & (ranges >= least))
    angles = scan.mount.theta + scan.angle_min + scan.angle_increment * kept
    x = scan.mount.x + ranges[kept] * np.cos(angles)
    y = scan.mount.y + ranges[kept] * np.sin(angles)
    return np.stack((x, y)).astype(np.float32), len(kept) / max(int(np.count_nonzero(hit)), 1)


def measured_ranges(
    scan: LaserScan, min_range: float, max_range: float, least: NDArray[np.float32] | float
) -> tuple[NDArray[np.float32], float]:
    """Return the ranges (B,), m, ``max_range`` where nothing nearer was hit, for the beam model; with the share that is left.

    Those shorter than ``min_range`` or than ``least`` m are not a number: they are left out.
    """
    ranges = np.minimum(scan.ranges.astype(np.float32), np.float32(max_range))
    seen = ranges >= min_range
    kept = seen & (ranges >= np.minimum(least, max_range))
    return np.where(kept, ranges, np.float32(np.nan)), int(np.count_nonzero(kept)) / max(int(np.count_nonzero(seen)), 1)


def rays_of(scan: LaserScan, range_max: float) -> Beams:
    """Return the scan's beams, made once, that see up to ``range_max`` m."""
    return _rays(scan.angle_min, scan.angle_increment, len(scan.ranges), range_max)
