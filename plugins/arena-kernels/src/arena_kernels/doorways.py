"""People before doors: closed doors are walls, and who has no other way that is worth it waits for them to open."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from copy import copy
from math import inf, sqrt
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from arena_kernels.compiled import compiled
from arena_kernels.crowds import Crowds, bodies_of
from arena_kernels.grids import PlacedGrid
from arena_kernels.ground import Ground, GroundStack, world_ground
from arena_kernels.route_grid import CoarseGrid, coarse_grid_of
from arena_kernels.routes import RouteSearch, find_corners, nearest_room
from arena_kernels.slide_along import LOSING_SIGHT, SIGHT, is_visible
from arena_kernels.world_grids import WorldGrids

Floats = NDArray[np.float64]
Slots = NDArray[np.int64]
DoorStates = tuple[bool, ...]  # which doors of a world are open

NOTHING, NEXT_WAYPOINT, NEW_ROUTE = 0, 1, 2  # what people of both models wish of the route search
STANDOFF = 0.5  # m, how far from a closed door people stand (own choice: who comes out has room to begin)


class Site(NamedTuple):
    """A world with doors: which are open at first, a function that closes others, and the grids it has made so far."""

    opened: DoorStates
    close: Callable[[DoorStates], PlacedGrid]
    known: dict[DoorStates, PlacedGrid]

    def with_closed(self, doors_open: DoorStates) -> PlacedGrid:
        """Return the grid in which closed doors are walls."""
        if doors_open not in self.known:
            self.known[doors_open] = self.close(doors_open)
        return self.known[doors_open]


class Doorways:
    """Which of N worlds have doors, and which of those are open."""

    def __init__(self, cell: float) -> None:
        self._sites: dict[int, Site] = {}
        self._open: dict[int, DoorStates] = {}
        self._open_ground, self._has_ground = WorldGrids(cell), False

    def begin(self, slots: Slots, grids: Sequence[PlacedGrid], sites: Sequence[Site], total: int) -> list[PlacedGrid]:
        """Begin worlds, with ``grids`` of open doors, in these slots of ``total``; return the grids as they are at
        first.
        """
        for slot, site in zip(slots.tolist(), sites, strict=True):
            self._sites.pop(slot, None)
            self._open.pop(slot, None)
            if site.opened:
                self._sites[slot], self._open[slot] = site, site.opened
        self._has_ground |= bool(self._sites)
        if self._has_ground:
            self._open_ground.replace(slots, grids, total)
        return [
            self._sites[slot].with_closed(self._open[slot]) if slot in self._sites else grid
            for slot, grid in zip(slots.tolist(), grids, strict=True)
        ]

    def changed(self, doors_open: NDArray[np.bool_]) -> dict[int, PlacedGrid]:
        """Take over which doors (N, D) are open; return the new grids of worlds in which that has changed."""
        grids = {}
        for slot, site in self._sites.items():
            now = tuple(doors_open[slot, : len(site.opened)].tolist())
            if now != self._open[slot]:
                self._open[slot], grids[slot] = now, site.with_closed(now)
        return grids

    def seekers(self, wishes: NDArray[np.int32], corners: Floats, worth: Floats) -> Seekers | None:
        """Return who of those with ``wishes`` (N, P) for a route is in a world with a closed door; None for no one."""
        closed = [slot for slot, opened in self._open.items() if not all(opened)]
        if not closed:
            return None
        wished = np.zeros(wishes.shape, np.bool_)
        wished[closed] = (wishes[closed] == NEXT_WAYPOINT) | (wishes[closed] == NEW_ROUTE)
        return Seekers(wished, corners, worth) if wished.any() else None

    def maps(self, now: WorldGrids) -> RouteMaps:
        """Return the worlds as they are now, and as they are with all doors open."""
        return RouteMaps(_route_map(now), _route_map(self._open_ground))

    def fork(self, slots: Slots) -> Doorways:
        """Return the doors of these worlds (K,), as they are now."""
        forked = copy(self)
        places = [(place, slot) for place, slot in enumerate(slots.tolist()) if slot in self._sites]
        vars(forked).update(
            _sites={place: self._sites[slot] for place, slot in places},
            _open={place: self._open[slot] for place, slot in places},
            _open_ground=self._open_ground.fork(slots) if self._has_ground else self._open_ground,
        )
        return forked


class RouteMap(NamedTuple):
    """What the ways of N worlds are searched on: their grounds, coarse grids, and room for the nodes of a search."""

    land: GroundStack
    rooms: Any
    nodes: NDArray[np.int32]


class RouteMaps(NamedTuple):
    """The worlds as they are ``now``, and as they are with ``free`` doors."""

    now: RouteMap
    free: RouteMap


class Seekers(NamedTuple):
    """Who has just got a route: ``wished`` (N, P), their ``corners`` (N, P, C, 2) m, and ``worth`` (N, P), m: by how
    much longer a way round may be than one through a closed door.
    """

    wished: NDArray[np.bool_]
    corners: Floats
    worth: Floats


def look_again(people: NDArray[np.void]) -> None:
    """Let those of a world who wait before a door look for a way again, since doors have moved."""
    waiting = people["waiting"] == 1
    people["stuck_clock"][waiting] = 0.0
    people["wish"][waiting & (people["wish"] == NOTHING)] = NEW_ROUTE


def _route_map(grids: WorldGrids) -> RouteMap:
    return RouteMap(grids.land, grids.rooms, grids.nodes)


@compiled
def await_doors(crowds: Crowds, people: NDArray[np.void], seekers: Seekers, maps: RouteMaps) -> None:
    """Send those who have no way, or none that is worth it, on that through closed doors, and let them wait there.

    ``people`` (N, P) have the goal, ``corner`` and ``corners`` of a way, its anchor, and whether they are ``waiting``.
    """
    scratch = np.empty(seekers.corners.shape[2:])
    for world in range(len(crowds.counts)):
        positions, _, radii, _ = bodies_of(crowds, world)
        for i in range(len(positions)):
            if not seekers.wished[world, i]:
                continue
            person, disc = people[world, i], (positions[i, 0], positions[i, 1], radii[i])
            goal = (person.goal_x, person.goal_y)
            _, round_them = _way_to(maps.now, world, disc, goal, scratch)
            if round_them <= sqrt((goal[0] - disc[0]) ** 2 + (goal[1] - disc[1]) ** 2) + seekers.worth[world, i]:
                continue  # no way is shorter than the straight one
            found, through = _way_to(maps.free, world, disc, goal, scratch)
            if through < inf and round_them > through + seekers.worth[world, i]:
                person.waiting, person.corner, person.corners = 1, 0, found
                for k in range(found):
                    seekers.corners[world, i, k, 0], seekers.corners[world, i, k, 1] = scratch[k, 0], scratch[k, 1]


@compiled
def _way_to(
    where: RouteMap, world: int, disc: tuple[float, float, float], goal: tuple[float, float], corners: Floats
) -> tuple[int, float]:
    """Write the corners of the shortest way; return how many they are and its length, m, inf where there is none."""
    ground, rooms = world_ground(where.land, world), coarse_grid_of(where.rooms, where.land.grids[world])
    x, y, radius = disc
    if is_visible(ground, (x, y, goal[0], goal[1]), SIGHT * radius):
        return 0, sqrt((goal[0] - x) ** 2 + (goal[1] - y) ** 2)
    found = _search_way(ground, RouteSearch(rooms, where.nodes), disc, goal, corners)
    if found < 0:
        return 0, inf
    length = 0.0
    for k in range(found):
        length += sqrt((corners[k, 0] - x) ** 2 + (corners[k, 1] - y) ** 2)
        x, y = corners[k, 0], corners[k, 1]
    return found, length + sqrt((goal[0] - x) ** 2 + (goal[1] - y) ** 2)


@compiled
def _search_way(
    ground: Ground, search: RouteSearch, disc: tuple[float, float, float], goal: tuple[float, float], corners: Floats
) -> int:
    """Write the corners of a way round walls; return how many they are, -1 where there is none."""
    x, y, radius = disc
    start, end = room_near(ground, search.rooms, disc), room_near(ground, search.rooms, (goal[0], goal[1], radius))
    if start < 0 or end < 0:
        return -1
    found: int = find_corners(ground, search, (x, y, start), (goal[0], goal[1], end), radius, corners)
    return found


@compiled
def room_near(ground: Ground, rooms: CoarseGrid, disc: tuple[float, float, float]) -> int:
    """Return the coarse cell with room for a body nearest to it, -1 where there is none near."""
    return nearest_room(ground, rooms, disc[0], disc[1], disc[2])[2]


@compiled
def door_ahead(ground: Ground, disc: tuple[float, float, float], hx: float, hy: float) -> bool:
    """Return whether who heads along (hx, hy) has come up to what is in the way."""
    x, y, radius = disc
    reach = radius + STANDOFF
    return not is_visible(ground, (x, y, x + reach * hx, y + reach * hy), LOSING_SIGHT * radius)


@compiled
def door_on_way(ground: Ground, disc: tuple[float, float, float], to_x: float, to_y: float) -> bool:
    """Return whether who is on the way there has come up to what is in the way."""
    away = sqrt((to_x - disc[0]) ** 2 + (to_y - disc[1]) ** 2)
    if away == 0.0:
        return False
    ahead: bool = door_ahead(ground, disc, (to_x - disc[0]) / away, (to_y - disc[1]) / away)
    return ahead
