"""From one waypoint to the next: which comes next, and the route there."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from arena_kernels.compiled import compiled
from arena_kernels.crowds import Crowds, bodies_of
from arena_kernels.ground import Ground, GroundStack, wall_clearance, world_ground
from arena_kernels.random import uniform
from arena_kernels.route_grid import CoarseGrid, coarse_grid_of
from arena_kernels.routes import RouteSearch, find_corners, nearest_room
from arena_kernels.slide_along import SIGHT, is_visible
from arena_pedsim.people import NEW_ROUTE, NEXT_WAYPOINT, NO_ERRAND, NOTHING, ON_ERRAND

Floats = NDArray[np.float64]

WAYPOINTS = 1 << 32  # first of the random numbers of a stream that waypoints are drawn by
STAYS, LENGTHS = 2 << 32, 3 << 32  # of those that say whether and how long people stay at them
SPREAD = 0.5  # a stay lasts its mean x U(1 - SPREAD, 1 + SPREAD), as a state does


class Routes(NamedTuple):
    """Where the people of N worlds walk, m: ``waypoints`` (N, P, W, 2), and the ``corners`` (N, P, C, 2) of the present
    routes.

    ``legs`` (N, P, W, C, 2) and their lengths ``leg_corners`` (N, P, W), -1 when not known yet, keep the route to each
    waypoint for the next time round.
    """

    waypoints: Floats
    corners: Floats
    legs: Floats
    leg_corners: NDArray[np.int32]


@compiled
def assign_routes(
    crowds: Crowds,
    people: NDArray[np.void],
    routes: Routes,
    land: GroundStack,
    rooms: Any,
    nodes: NDArray[np.int32],
    parameters: NDArray[np.void],
) -> None:
    """Give everybody who wishes for it the next waypoint and a route there."""
    waypoints, corners, legs, leg_corners = routes
    for world in range(len(crowds.counts)):
        if not has_wishes(people[world], crowds.counts[world]):
            continue
        positions, _, radii, _ = bodies_of(crowds, world)
        ground, world_rooms = world_ground(land, world), coarse_grid_of(rooms, land.grids[world])
        for i in range(len(positions)):
            person = people[world, i]
            if person.wish not in (NEXT_WAYPOINT, NEW_ROUTE):
                continue
            x, y, radius, next_leg = positions[i, 0], positions[i, 1], radii[i], person.wish == NEXT_WAYPOINT
            if next_leg:
                person.waypoint = _next_waypoint(person, i)
                person.stay = _stay_time(person, i)
                person.anchor_x, person.anchor_y, person.stuck_clock = x, y, 0.0
            person.wish, person.look_clock = NOTHING, 0.0
            if person.errand == ON_ERRAND:
                person.goal_x, person.goal_y, person.kept = person.errand_x, person.errand_y, 0
            else:
                person.goal_x, person.goal_y = (
                    waypoints[world, i, person.waypoint, 0],
                    waypoints[world, i, person.waypoint, 1],
                )
                person.errand = NO_ERRAND
            person.corner, person.corners, person.lost, person.waiting = 0, 0, 0, 0
            if parameters[0].wayfinding_routing == 0 or _sees_goal(person, (x, y, radius), ground, world_rooms):
                continue
            leg, known = legs[world, i, person.waypoint], leg_corners[world, i, person.waypoint]
            if next_leg and known > 0 and is_visible(ground, (x, y, leg[0, 0], leg[0, 1]), SIGHT * radius):
                person.corners = known
                _copy_points(leg, corners[world, i], known)
                continue
            _find_route(person, (x, y, radius), corners[world, i], ground, RouteSearch(world_rooms, nodes))
            if next_leg:
                leg_corners[world, i, person.waypoint] = person.corners
                _copy_points(corners[world, i], leg, person.corners)


@compiled
def has_wishes(people: NDArray[np.void], number: int) -> bool:
    """Return whether anybody of a world has a wish."""
    wishes = 0
    for i in range(number):
        wishes += people[i].wish != NOTHING
    return wishes > 0


@compiled
def _next_waypoint(person: Any, i: int) -> int:
    """Return the next in the loop, or one at random that is not the present one."""
    legs = person.legs
    person.legs += 1
    if person.waypoint_mode == 0 or person.waypoints == 1:
        return (person.waypoint + 1) % person.waypoints  # type: ignore[no-any-return]
    others = person.waypoints - (person.waypoint >= 0)
    ahead = 1 + int(uniform(person.key, legs, WAYPOINTS + i) * others)
    return (person.waypoint + ahead) % person.waypoints  # type: ignore[no-any-return]


@compiled
def _stay_time(person: Any, i: int) -> float:
    """Return how long a person will stay at the waypoint just chosen, s."""
    if person.waypoints == 1 or not uniform(person.key, person.legs, STAYS + i) < person.stay_chance:
        return 0.0
    spread: float = SPREAD * (2.0 * uniform(person.key, person.legs, LENGTHS + i) - 1.0)
    return person.stay_time + person.stay_time * spread  # type: ignore[no-any-return]


@compiled
def _copy_points(source: Floats, target: Floats, number: int) -> None:
    for k in range(number):
        target[k, 0], target[k, 1] = source[k, 0], source[k, 1]


@compiled
def _sees_goal(person: Any, disc: tuple[float, float, float], ground: Ground, rooms: CoarseGrid) -> bool:
    """Move a goal without room to the nearest place with room; return whether the person can walk there straight."""
    x, y, radius = disc
    if wall_clearance(ground, person.goal_x, person.goal_y) < SIGHT * radius:
        goal_x, goal_y, _ = nearest_room(ground, rooms, person.goal_x, person.goal_y, radius)
        person.goal_x, person.goal_y = goal_x, goal_y
    return is_visible(ground, (x, y, person.goal_x, person.goal_y), SIGHT * radius)


@compiled
def _find_route(
    person: Any, disc: tuple[float, float, float], corners: Floats, ground: Ground, search: RouteSearch
) -> None:
    """Search the way to the goal and write its corners."""
    x, y, radius = disc
    goal_x, goal_y = person.goal_x, person.goal_y
    _, _, start = nearest_room(ground, search.rooms, x, y, radius)
    _, _, goal = nearest_room(ground, search.rooms, goal_x, goal_y, radius)
    found = -1
    if start >= 0 and goal >= 0:
        found = find_corners(ground, search, (x, y, start), (goal_x, goal_y, goal), radius, corners)
    person.corners = max(found, 0)
    person.lost = 1 if found < 0 else 0
