"""From key place to key place: as Gazebo plays a pose animation, a Catmull-Rom spline with even
time over each span, or straight.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arena_core import OccupancyGrid, PedestrianSpec
from arena_kernels.compiled import compiled
from arena_kernels.distance import grid_distance
from arena_kernels.ground import Ground, wall_clearance

Floats = NDArray[np.float64]


class Timetables(NamedTuple):
    """Those of P bodies, packed: body k is at ``places[first[k]:first[k + 1]]`` (S, 2) m at ``stamps`` (S,) s of its
    round.

    An episode begins at ``begins`` (P,) s of the round; ``smooth`` (P,) ones go along a spline, the others straight.
    """

    first: NDArray[np.int64]
    stamps: Floats
    places: Floats
    begins: Floats
    smooth: NDArray[np.bool_]


def pack_timetables(specs: Sequence[PedestrianSpec], begin: float) -> Timetables:
    """Pack timetables, entered at ``begin`` s; who has none walks its waypoints in a round, from
    its start, at its greatest speed.
    """
    rounds = [_round_timetable(spec) for spec in specs]
    first = np.cumsum([0, *(len(stamps) for stamps, _ in rounds)])
    smooth = np.array([spec.stamps is not None for spec in specs], np.bool_)
    stamps = np.concatenate([np.zeros(0), *(stamps for stamps, _ in rounds)])
    places = np.vstack([np.zeros((0, 2)), *(places for _, places in rounds)])
    return Timetables(first, stamps, places, np.where(smooth, begin, 0.0), smooth)


def _round_timetable(spec: PedestrianSpec) -> tuple[Floats, Floats]:
    """Return stamps (S,) s and places (S, 2) m of one body's round."""
    if spec.stamps is not None:
        return spec.stamps, spec.waypoints_xy
    if len(spec.waypoints_xy) == 0:
        return np.zeros(1), np.reshape(spec.position_xy, (1, 2))
    places = np.vstack((spec.position_xy, spec.waypoints_xy, spec.position_xy))
    return np.concatenate(((0.0,), np.cumsum(np.hypot(*np.diff(places, axis=0).T) / spec.desired_speed))), places


def sample_timetables(tables: Timetables, elapsed: float, dt: float) -> tuple[Floats, Floats]:
    """Return positions and velocities, each (P, 2), ``elapsed`` s into an episode.

    They are NaN for who has jumped from the end of its round to the begin within the last ``dt`` s.
    """
    people = len(tables.begins)
    positions, velocities = np.empty((people, 2)), np.empty((people, 2))
    _sample_timetables(*tables, elapsed, dt, positions, velocities)
    return positions, velocities


def hide_in_walls(ground: Ground, radii: Floats, positions: Floats, velocities: Floats) -> None:
    """Set positions and velocities (P, 2) to NaN where bodies of ``radii`` (P,) m would reach
    into walls: they come out of them.
    """
    _hide_in_walls(ground, radii, positions, velocities)


def ground_under(grid: OccupancyGrid) -> Ground:
    """Return a map's distance field with its place; meant for ``grid.derive(ground_under)``."""
    origin = grid.origin
    return Ground(
        grid.derive(grid_distance), origin.x, origin.y, math.cos(origin.theta), math.sin(origin.theta), grid.resolution
    )


@compiled
def _hide_in_walls(ground: Ground, radii: Floats, positions: Floats, velocities: Floats) -> None:
    for k in range(len(radii)):
        if wall_clearance(ground, positions[k, 0], positions[k, 1]) < radii[k]:
            positions[k], velocities[k] = np.nan, np.nan


@compiled
def _sample_timetables(
    first: NDArray[np.int64],
    stamps: Floats,
    places: Floats,
    begins: Floats,
    smooth: NDArray[np.bool_],
    elapsed: float,
    dt: float,
    positions: Floats,
    velocities: Floats,
) -> None:
    """Fill positions and velocities."""
    for k in range(len(positions)):
        low, high = first[k], first[k + 1] - 1
        length, time = stamps[high], begins[k] + elapsed
        if length <= 0.0:
            positions[k, 0], positions[k, 1], velocities[k, 0], velocities[k, 1] = (
                places[low, 0],
                places[low, 1],
                0.0,
                0.0,
            )
            continue
        closed = places[low, 0] == places[high, 0] and places[low, 1] == places[high, 1]
        if not closed and np.floor(time / length) != np.floor((time - dt) / length):
            positions[k, 0], positions[k, 1], velocities[k, 0], velocities[k, 1] = np.nan, np.nan, np.nan, np.nan
            continue
        now = time - length * np.floor(time / length)
        before = low
        while before + 1 < high and stamps[before + 1] <= now:
            before += 1
        span = stamps[before + 1] - stamps[before]
        share = (now - stamps[before]) / span if span > 0.0 else 0.0
        for axis in range(2):
            p, q = places[before, axis], places[before + 1, axis]
            leaving, arriving = q - p, q - p
            if smooth[k]:
                leaving, arriving = (
                    _spline_tangent(places, before, low, high, closed, axis),
                    _spline_tangent(places, before + 1, low, high, closed, axis),
                )
            a, b = 2.0 * (p - q) + leaving + arriving, 3.0 * (q - p) - 2.0 * leaving - arriving
            positions[k, axis] = p + share * (leaving + share * (b + share * a))
            velocities[k, axis] = (leaving + share * (2.0 * b + 3.0 * share * a)) / span if span > 0.0 else 0.0


@compiled
def _spline_tangent(places: Floats, k: int, low: int, high: int, closed: bool, axis: int) -> float:
    """Return half the way from the place before to the place after, at an end half the way to its neighbour.

    Of a ``closed`` round, which ends where it began, both ends have the places on either side.
    """
    before, after = max(k - 1, low), min(k + 1, high)
    if closed and after - before < 2:
        before, after = high - 1, low + 1
    return 0.5 * (places[after, axis] - places[before, axis])  # type: ignore[no-any-return]
