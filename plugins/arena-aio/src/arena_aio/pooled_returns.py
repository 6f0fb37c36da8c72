"""Scans pooled into sectors: what stands on the map, and what does not."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arena_core import OccupancyGrid
from arena_kernels.compiled import borrowing, inner
from arena_kernels.distance import grid_distance
from arena_policies.scan_history import Beams

Floats = NDArray[np.float64]


class MappedWalls(NamedTuple):
    """``distance`` (H, W) to the nearest occupied cell's centre, m, and its place in ``map``;
    without a map it is empty.
    """

    distance: NDArray[np.float32]
    resolution: float
    origin: tuple[float, float]
    rotation: tuple[float, float]

    @staticmethod
    def of(grid: OccupancyGrid | None) -> MappedWalls:
        """Read a map."""
        if grid is None:
            return MappedWalls(np.empty((0, 0), np.float32), 1.0, (0.0, 0.0), (1.0, 0.0))
        turn = float(grid.origin.theta)
        place = (float(grid.origin.x), float(grid.origin.y))
        return MappedWalls(grid.derive(grid_distance), float(grid.resolution), place, (math.cos(turn), math.sin(turn)))


@borrowing
def pool_returns(
    ranges: NDArray[np.float32],
    pose: Floats,
    beams: Beams,
    walls: MappedWalls,
    tolerance: float,
    range_max: float,
    out: Floats,
) -> None:
    """Fill ``out`` (2, S) with the least range of each sector, at most ``range_max`` m, of a scan (B,) taken at
    ``pose`` (3,).

    The first row has the returns within ``tolerance`` m of a mapped wall, the second one all others; a range that is
    not a number makes its sector's first none. Without a map all returns are in the first row.
    """
    mx, my, mc, ms = beams.mount
    c, s = math.cos(pose[2]), math.sin(pose[2])
    sx, sy = pose[0] + c * mx - s * my, pose[1] + s * mx + c * my
    hc, hs = c * mc - s * ms, s * mc + c * ms
    out[:, :] = range_max
    count, sectors = len(ranges), out.shape[1]
    for b in range(count):
        sector = ((b + 1) * sectors - 1) // count
        r = float(ranges[b])
        if math.isnan(r):
            out[0, sector] = r
        elif r < range_max:
            x, y = sx + r * (hc * beams.cos[b] - hs * beams.sin[b]), sy + r * (hs * beams.cos[b] + hc * beams.sin[b])
            kind = 0 if _on_wall(walls, x, y, tolerance) else 1
            if r < out[kind, sector]:  # never where it is no number
                out[kind, sector] = r


@inner
def _on_wall(walls: MappedWalls, x: float, y: float, tolerance: float) -> bool:
    """Return whether a point in ``map`` lies on a mapped wall, or off the map."""
    dx, dy = x - walls.origin[0], y - walls.origin[1]
    column = math.floor((walls.rotation[0] * dx + walls.rotation[1] * dy) / walls.resolution)
    row = math.floor((walls.rotation[0] * dy - walls.rotation[1] * dx) / walls.resolution)
    if row < 0 or column < 0 or row >= walls.distance.shape[0] or column >= walls.distance.shape[1]:
        return True
    return bool(walls.distance[row, column] <= tolerance)
