"""Scans as they will be when tracked bodies have gone on, seen from where the robot is now."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arena_core import Lidar, Predictions, Tracks
from arena_kernels.compiled import borrowing, inner
from arena_policies.scan_history import Beams, beams_of

Floats = NDArray[np.float64]
MARGIN = 0.15  # m: a return so near to a tracked disc is the body's


class Sectors(NamedTuple):
    """A lidar's beams, pooled: the middles of sectors (S,) as cosine and sine in the sensor's frame, and
    half of one's width, rad.
    """

    beams: Beams
    cos: Floats
    sin: Floats
    half: float


class Bodies(NamedTuple):
    """Tracked discs of N robots, those of robot k from ``offsets[k]`` to ``offsets[k + 1]``: where they are, and where
    they will be at T times (B, T, 2), in ``map``, m.
    """

    positions: Floats
    later: Floats
    radii: Floats
    offsets: NDArray[np.int64]


def sectors_of(lidar: Lidar, sectors: int) -> Sectors:
    """Return a lidar's beams, pooled to so many sectors that share them evenly."""
    angles, bounds = lidar.angles(), np.arange(sectors + 1) * lidar.beams // sectors
    middles = np.array([angles[low:high].mean() for low, high in pairwise(bounds)])
    return Sectors(
        beams_of(lidar), np.cos(middles), np.sin(middles), 0.5 * lidar.beams / sectors * lidar.angle_increment
    )


def bodies_of(tracks: Sequence[Tracks], predictions: Sequence[Predictions], times: Floats) -> Bodies:
    """Return the tracks of N robots as arrays, with where they will be at ``times`` (T,), s from now."""
    offsets = np.cumsum([0, *(len(one.ids) for one in tracks)])
    if not offsets[-1]:
        return Bodies(np.empty((0, 2)), np.empty((0, len(times), 2)), np.empty(0), offsets)
    seen = [both for both in zip(tracks, predictions, strict=True) if len(both[0].ids)]
    positions, radii = (np.concatenate([getattr(one, name) for one, _ in seen]) for name in ("positions", "radii"))
    if all(len(ahead.times) == 1 for _, ahead in seen):  # all go straight on: in one go
        velocities = np.concatenate([ahead.velocities for _, ahead in seen])
        means = np.concatenate([ahead.means for _, ahead in seen])
        return Bodies(positions, means + velocities[:, None] * times[:, None], radii, offsets)
    return Bodies(positions, np.concatenate([ahead.at(times) for _, ahead in seen]), radii, offsets)


@borrowing
def predict_sector_ranges(
    ranges: NDArray[np.float32],
    poses: Floats,
    bodies: Bodies,
    sectors: Sectors,
    range_max: float,
    out: Floats,
) -> None:
    """Fill ``out`` (N, T, S) with the least distance in each sector, at most ``range_max`` m, at the T times
    of the bodies.

    What scans (N, B) hit now from ``poses`` (N, 3) stands, but for the bodies that are tracked, which go where they are
    expected; the sensor stays.
    """
    mx, my, mc, ms = sectors.beams.mount
    count, pooled = ranges.shape[1], out.shape[2]
    for k in range(len(poses)):
        c, s = math.cos(poses[k, 2]), math.sin(poses[k, 2])
        x, y = poses[k, 0] + c * mx - s * my, poses[k, 1] + s * mx + c * my  # of the sensor, in map
        c, s = c * mc - s * ms, s * mc + c * ms
        first, last = bodies.offsets[k], bodies.offsets[k + 1]
        for sector in range(pooled):
            nearest = range_max
            for b in range(sector * count // pooled, (sector + 1) * count // pooled):
                r = float(ranges[k, b])
                if r < nearest:
                    px = x + r * (c * sectors.beams.cos[b] - s * sectors.beams.sin[b])
                    py = y + r * (s * sectors.beams.cos[b] + c * sectors.beams.sin[b])
                    if not _is_on_body(px, py, bodies, first, last):
                        nearest = r
            for j in range(out.shape[1]):
                out[k, j, sector] = nearest
        for j in range(out.shape[1]):
            for body in range(first, last):
                dx, dy = bodies.later[body, j, 0] - x, bodies.later[body, j, 1] - y
                _mark_disc(c * dx + s * dy, c * dy - s * dx, bodies.radii[body], sectors, out[k, j])


@inner
def _is_on_body(x: float, y: float, bodies: Bodies, first: int, last: int) -> bool:
    """Return whether a return in ``map`` is that of a tracked body."""
    for body in range(first, last):
        dx, dy, reach = x - bodies.positions[body, 0], y - bodies.positions[body, 1], bodies.radii[body] + MARGIN
        if dx * dx + dy * dy < reach * reach:
            return True
    return False


@inner
def _mark_disc(x: float, y: float, radius: float, sectors: Sectors, nearest: Floats) -> None:
    """Show a disc at x, y in the sensor's frame in the sectors that it reaches into, ``nearest`` (S,)."""
    if x * x + y * y <= radius * radius:
        nearest[:] = 0.0
        return
    for sector in range(len(nearest)):
        along = x * sectors.cos[sector] + y * sectors.sin[sector]
        if along > 0.0:
            beside = abs(y * sectors.cos[sector] - x * sectors.sin[sector])
            beside = max(beside - along * sectors.half, 0.0)
            if beside < radius:
                nearest[sector] = min(nearest[sector], max(along - math.sqrt(radius * radius - beside * beside), 0.0))
