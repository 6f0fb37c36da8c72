"""Ways on foot over a grid, for callers that ask where people will walk before anybody does."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from arena_kernels.compiled import compiled
from arena_kernels.grids import PlacedGrid
from arena_kernels.ground import Ground, GroundStack, wall_clearance, world_ground
from arena_kernels.route_grid import CoarseGrid, coarse_grid_of
from arena_kernels.routes import RouteSearch, find_corners, nearest_room
from arena_kernels.slide_along import SIGHT, is_visible
from arena_kernels.world_grids import WorldGrids

Floats = NDArray[np.float64]

CELL = 0.2  # m, of the grid that ways are searched on: that of the crowds' presets
MOST_CORNERS = 24  # of one way, as crowds keep


class ShortestPaths:
    """The ways round the walls of a grid; meant for ``grid.derive(Ways)``."""

    def __init__(self, grid: PlacedGrid) -> None:
        self._terrain = WorldGrids(CELL)
        self._terrain.replace(np.zeros(1, np.int64), [grid], 1)

    def path_between(self, start_xy: Floats, end_xy: Floats, radius: float) -> Floats:
        """Return start, corners and end of the shortest way with room for a body, (M,
        2) m; empty when there is none.
        """
        terrain = self._terrain
        way = np.empty((MOST_CORNERS + 2, 2))
        ends = (float(start_xy[0]), float(start_xy[1])), (float(end_xy[0]), float(end_xy[1]))
        found = _write_path(terrain.land, terrain.rooms, terrain.nodes, *ends, float(radius), way)
        return way[:found]

    def patrol_paths(self, waypoints_xy: Floats, radius: float) -> list[Floats]:
        """Return the ways to each of the waypoints (K, 2) from the one before, to the first from
        the last; empty when one has none.
        """
        legs = [self.path_between(waypoints_xy[k - 1], waypoints_xy[k], radius) for k in range(len(waypoints_xy))]
        return legs if all(len(leg) for leg in legs) else []


def path_length(way: Floats) -> float:
    """Return how long a way (M, 2) is, m."""
    return float(np.hypot(*np.diff(way, axis=0).T).sum())


def place_on_patrol(legs: list[Floats], share: float) -> tuple[Floats, int]:
    """Return the place (2,) so far round ``legs``, ``share`` 0 .. 1 of their whole length, and the number
    of the leg that it is on.
    """
    ends = np.cumsum([path_length(leg) for leg in legs])
    number = min(int(np.searchsorted(ends, share * ends[-1], side="right")), len(legs) - 1)
    leg = legs[number]
    lengths = np.concatenate(((0.0,), np.hypot(*np.diff(leg, axis=0).T).cumsum()))
    done = share * ends[-1] - (ends[number] - lengths[-1])
    return np.array([np.interp(done, lengths, leg[:, k]) for k in (0, 1)]), number


@compiled
def _write_path(
    land: GroundStack,
    stack: Any,
    nodes: NDArray[np.int32],
    start: tuple[float, float],
    end: tuple[float, float],
    radius: float,
    way: Floats,
) -> int:
    """Write the way and return how many points it has, 0 for none."""
    ground, rooms = world_ground(land, 0), coarse_grid_of(stack, 0)
    way[0, 0], way[0, 1] = start
    corners = 0
    if not is_visible(ground, (start[0], start[1], end[0], end[1]), SIGHT * radius):
        corners = _write_corners(ground, rooms, start, end, radius, nodes, way[1:-1])
    if corners < 0 or wall_clearance(ground, end[0], end[1]) <= 0.0:
        return 0
    way[corners + 1, 0], way[corners + 1, 1] = end
    return corners + 2


@compiled
def _write_corners(
    ground: Ground,
    rooms: CoarseGrid,
    start: tuple[float, float],
    end: tuple[float, float],
    radius: float,
    nodes: NDArray[np.int32],
    corners: Floats,
) -> int:
    """Write the corners of a way that is not straight and return their number, -1 when there is no way."""
    _, _, first = nearest_room(ground, rooms, start[0], start[1], radius)
    _, _, last = nearest_room(ground, rooms, end[0], end[1], radius)
    if first < 0 or last < 0:
        return -1
    return find_corners(
        ground, RouteSearch(rooms, nodes), (start[0], start[1], first), (end[0], end[1], last), radius, corners
    )
