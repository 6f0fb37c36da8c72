"""Which returns of a scan show something that the robot does not know of: not on the map, and where it
could see through before.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arena_core import OccupancyGrid
from arena_kernels.compiled import borrowing, inner
from arena_kernels.distance import grid_distance
from arena_kernels.scalars import Integer
from arena_navigation.columns import COSINE, REACH, SINE, THETA, X, Y
from arena_navigation.local_map.marks import PlacedScan

UNTOLD, OLD, NEW = 0, 1, 2
_TURN = 2.0 * math.pi


class KnownPlane(NamedTuple):
    """What the map tells: ``distance`` (H, W) to the nearest occupied cell's centre, m, ``free`` (H, W), and its place
    in ``map``.

    Without a map both are empty and nothing is known.
    """

    distance: NDArray[np.float32]
    free: NDArray[np.uint8]
    resolution: float
    origin: tuple[float, float]
    rotation: tuple[float, float]

    @staticmethod
    def of(grid: OccupancyGrid | None) -> KnownPlane:
        """Read a map."""
        if grid is None:
            return KnownPlane(np.empty((0, 0), np.float32), np.empty((0, 0), np.uint8), 1.0, (0.0, 0.0), (1.0, 0.0))
        turn = float(grid.origin.theta)
        place = (float(grid.origin.x), float(grid.origin.y))
        return KnownPlane(
            grid.derive(grid_distance),
            grid.derive(_free_cells),
            float(grid.resolution),
            place,
            (math.cos(turn), math.sin(turn)),
        )


def _free_cells(grid: OccupancyGrid) -> NDArray[np.uint8]:
    return ((grid.data >= 0) & ~grid.occupied).astype(np.uint8)


class PastScans(NamedTuple):
    """Some scans of the last seconds: ``ranges`` (K, B), ``sensors`` (K, 3) in ``map``, ``stamps`` (K,);
    one not yet taken has only NaN.
    """

    ranges: NDArray[np.float32]
    sensors: NDArray[np.float64]
    stamps: NDArray[np.float64]

    @staticmethod
    def none(scans: int, beams: int) -> PastScans:
        """Return room for so many scans."""
        return PastScans(np.full((scans, beams), np.nan, np.float32), np.zeros((scans, 3)), np.zeros(scans))


class ReturnTolerance(NamedTuple):
    """How far off returns may be: ``map`` m from the map's walls, ``past`` m from what past scans saw; by ``heading``
    rad more each.

    Within ``same`` m of what a past scan saw ``standing`` s ago something stands.
    """

    map: float
    past: float
    heading: float
    same: float
    standing: float


class Returns(NamedTuple):
    """Scratch space and result: where each beam ends, ``x`` and ``y`` (B,) from the sensor along the axes of ``map``;
    which ``counts``.

    ``wall`` (B,) m and ``free`` (B,) are what the map tells of its end; ``past`` (B,) is NEW, OLD or UNTOLD.
    """

    x: NDArray[np.float64]
    y: NDArray[np.float64]
    wall: NDArray[np.float64]
    free: NDArray[np.uint8]
    counts: NDArray[np.uint8]
    past: NDArray[np.int8]

    @staticmethod
    def room(beams: int) -> Returns:
        """Return room for so many beams."""
        x, y, wall = np.zeros((3, beams))
        free, counts = np.zeros((2, beams), np.uint8)
        return Returns(x, y, wall, free, counts, np.zeros(beams, np.int8))


@borrowing
def place_returns(beams: PlacedScan, plane: KnownPlane, farthest: float, every: Integer, returns: Returns) -> None:
    """Write where beams end, and what the map tells of it: those up to ``farthest`` m, and one of ``every`` so many."""
    reach = min(farthest, beams.range_max)
    for beam in range(len(beams.ranges)):
        away = float(beams.ranges[beam])
        if not beams.range_min <= away <= beams.range_max or (away > reach and beam % every):
            continue
        angle = beams.sensor[THETA] + beams.angle_min + beam * beams.angle_increment
        returns.x[beam], returns.y[beam] = away * math.cos(angle), away * math.sin(angle)
        x, y = beams.sensor[X] + returns.x[beam], beams.sensor[Y] + returns.y[beam]
        returns.wall[beam], returns.free[beam] = wall_and_freedom(plane, x, y)


@inner
def note_unknown(
    beams: PlacedScan,
    past: PastScans,
    tracks: NDArray[np.float64],
    doubt: ReturnTolerance,
    farthest: float,
    body: float,
    returns: Returns,
) -> None:
    """Write which placed returns up to ``farthest`` m count; ``tracks`` (K, 3) are x, y and reach of what is already
    followed.

    A return beside an occupied cell is the map's. In a cell that the map says is free every other return counts; where
    nothing is known, one counts that a past scan has seen through, or that lies on a track. Returns within ``body`` m
    are the robot's own.
    """
    reach = min(farthest, beams.range_max)
    for beam in range(len(beams.ranges)):
        away = float(beams.ranges[beam])
        returns.counts[beam] = 0
        if not beams.range_min <= away <= reach:
            continue
        if returns.wall[beam] < doubt.map + doubt.heading * away:
            continue
        x, y = beams.sensor[X] + returns.x[beam], beams.sensor[Y] + returns.y[beam]
        if math.hypot(x - beams.robot[X], y - beams.robot[Y]) < body:
            continue
        returns.past[beam] = _past_state(past, beams, x, y, doubt)
        returns.counts[beam] = returns.free[beam] or returns.past[beam] == NEW or is_followed(tracks, x, y)


@inner
def wall_and_freedom(plane: KnownPlane, x: float, y: float) -> tuple[float, bool]:
    """Return the distance to the nearest wall's surface, m, inf outside the map, and whether the
    map says that this is free.
    """
    dx, dy = (x - plane.origin[X]) / plane.resolution, (y - plane.origin[Y]) / plane.resolution
    u = plane.rotation[COSINE] * dx + plane.rotation[SINE] * dy
    v = plane.rotation[COSINE] * dy - plane.rotation[SINE] * dx
    rows, columns = plane.distance.shape
    if not (0.0 <= u < columns and 0.0 <= v < rows):
        return np.inf, False
    row, column = int(v), int(u)
    free = plane.free[row, column] > 0
    if plane.distance[row, column] == np.inf:
        return np.inf, free
    u, v = min(max(u - 0.5, 0.0), columns - 1.0), min(max(v - 0.5, 0.0), rows - 1.0)
    low_row, low_column = int(v), int(u)
    high_row, high_column = min(low_row + 1, rows - 1), min(low_column + 1, columns - 1)
    a, b = u - low_column, v - low_row
    below = (1.0 - a) * plane.distance[low_row, low_column] + a * plane.distance[low_row, high_column]
    above = (1.0 - a) * plane.distance[high_row, low_column] + a * plane.distance[high_row, high_column]
    return (1.0 - b) * below + b * above - 0.5 * plane.resolution, free


@inner
def within_a_turn(angle: float) -> float:
    """Return ``angle % (2 pi)``, which most angles are already or are but for one turn."""
    if 0.0 <= angle < _TURN:
        return angle
    return angle + _TURN if -_TURN < angle < 0.0 else angle % _TURN


@inner
def is_followed(tracks: NDArray[np.float64], x: float, y: float) -> bool:
    """Return whether a point lies within reach of a track."""
    for k in range(len(tracks)):  # noqa: SIM110 - numba compiles no generator expressions
        if (x - tracks[k, X]) ** 2 + (y - tracks[k, Y]) ** 2 < tracks[k, REACH] ** 2:
            return True
    return False


@inner
def _past_state(past: PastScans, beams: PlacedScan, x: float, y: float, doubt: ReturnTolerance) -> int:
    """Tell what past scans showed at a point.

    NEW: one of them saw beyond it, with all beams that pass nearer than half the doubt. OLD: none did, and one saw a
    return there long enough ago. UNTOLD: it was hidden or out of sight, as are places behind a body that walks away.
    """
    count = past.ranges.shape[1]
    told = UNTOLD
    for k in range(len(past.ranges)):
        dx, dy = x - past.sensors[k, X], y - past.sensors[k, Y]
        away = math.sqrt(dx * dx + dy * dy)
        margin = doubt.past + doubt.heading * away
        bearing = within_a_turn(math.atan2(dy, dx) - past.sensors[k, THETA] - beams.angle_min) / beams.angle_increment
        beside = max(0.5 * margin / max(away, margin) / beams.angle_increment, 1.0)
        if not beside <= bearing < count - 1 - beside:
            continue
        nearest = past.ranges[k, round(bearing)]
        if abs(nearest - away) <= doubt.same and beams.stamp - past.stamps[k] >= doubt.standing:
            told = OLD
        elif nearest > away and away + margin <= beams.range_max:
            seen_through = True
            for step in range(-2, 3):
                seen_through &= past.ranges[k, round(bearing + 0.5 * step * beside)] >= away + margin
            if seen_through:
                return NEW
    return told
