"""From waypoint to waypoint: which way each person heads now, and the route to where that leads."""

from __future__ import annotations

from math import inf, sqrt
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from arena_crowds.orca.parameters import RouteRules
from arena_crowds.orca.walkers import NEW_ROUTE, NEXT_WAYPOINT, NOTHING, STANDING, WALKING
from arena_kernels.compiled import borrowing, compiled
from arena_kernels.crowds import Bodies, Crowds, bodies_of
from arena_kernels.doorways import door_on_way
from arena_kernels.ground import Ground, GroundStack, wall_clearance, world_ground
from arena_kernels.line_of_sight import COLUMNS, SEEN, check_sight_lines, put_sight_line
from arena_kernels.random import uniform
from arena_kernels.route_grid import coarse_grid_of
from arena_kernels.routes import RouteSearch, find_corners, nearest_room
from arena_kernels.slide_along import LOSING_SIGHT, SIGHT, is_visible

Floats = NDArray[np.float64]

LEAVING = 2.0  # who stands at the only waypoint walks back when this many waypoint radii away
BACK = 3.0  # m, who lost sight of the way goes back to a corner this near
SPREAD = 0.5  # a stay lasts its mean x U(1 - SPREAD, 1 + SPREAD)
AT_CORNER = 0.05  # m, a corner this near gives no direction


class SightLines(NamedTuple):
    """Who looks along which way: ``askers`` (P,) are people, ``sights`` (P, 8) their rows of
    ``arena_kernels.line_of_sight``.

    ``due`` (P,) tells whose time it is to look whether the way ahead is still free. All is working memory.
    """

    askers: NDArray[np.int32]
    sights: Floats
    open_ones: NDArray[np.int32]
    due: NDArray[np.bool_]


@compiled
def allocate_sight_lines(people: int) -> SightLines:
    """Return working memory for so many people."""
    return SightLines(
        np.empty(people, np.int32), np.empty((people, COLUMNS)), np.empty(people, np.int32), np.empty(people, np.bool_)
    )


@borrowing
def set_out(
    bodies: Bodies,
    memory: NDArray[np.void],
    corners: Floats,
    ground: Ground,
    dt: float,
    rules: RouteRules,
    looks: SightLines,
) -> None:
    """Decide who stands and who walks, and let those who walk look ahead, all at once; note wishes."""
    positions, _, radii, states = bodies
    asked = 0
    for i in range(len(positions)):
        walker, x, y = memory[i], positions[i, 0], positions[i, 1]
        states[i], looks.due[i] = _next_state(walker, states[i], x, y, dt, rules), False
        if states[i] == STANDING:
            continue
        _detect_stuck(walker, x, y, dt, rules)
        looks.due[i] = _is_due(walker, dt, rules)
        away = _corner_away(walker, x, y, corners[i])
        if away == inf or not (looks.due[i] or away < rules.corner_radius):
            continue
        if away < AT_CORNER:
            walker.corner, looks.due[i] = walker.corner + 1, False
            continue
        to_x, to_y, _ = _look_target(walker, 1, corners[i])
        put_sight_line(ground, looks.sights[asked], (x, y, to_x, to_y), SIGHT * radii[i])
        looks.askers[asked] = i
        asked += 1
    _pass_corners(memory, ground, asked, looks)
    _watch_targets(bodies, memory, corners, ground, looks)


@borrowing
def walk_direction(walker: Any, state: int, x: float, y: float, corners: Floats) -> tuple[float, float, float]:
    """Return the unit vector to walk along and how far that way leads (inf before a corner)."""
    if state == STANDING:
        return 0.0, 0.0, 0.0
    target_x, target_y, last = _look_target(walker, 0, corners)
    away = sqrt((target_x - x) ** 2 + (target_y - y) ** 2)
    if away == 0.0:
        return 0.0, 0.0, 0.0
    return (target_x - x) / away, (target_y - y) / away, away if last else inf


@borrowing
def _next_state(walker: Any, state: int, x: float, y: float, dt: float, rules: RouteRules) -> int:
    """Return whether a person stands or walks now; note wishes."""
    to_goal = sqrt((walker.goal_x - x) ** 2 + (walker.goal_y - y) ** 2)
    if state == STANDING and walker.waypoints > 1:
        walker.stay -= dt
        if walker.stay > 0.0:
            return STANDING
        walker.wish = NEXT_WAYPOINT
    elif state == STANDING:
        if walker.waypoints == 0 or to_goal < LEAVING * rules.waypoint_radius:
            return STANDING
        walker.wish, walker.corner, walker.corners = NEW_ROUTE, 0, 0
    if walker.corner >= walker.corners and to_goal < rules.waypoint_radius:
        if walker.waypoints == 1 or walker.stay > 0.0:
            return STANDING
        walker.wish = NEXT_WAYPOINT
    return WALKING


@borrowing
def _look_target(walker: Any, further: int, corners: Floats) -> tuple[float, float, bool]:
    """Return the corner so many places further on, or the goal behind the last corner, and whether it is the goal."""
    k = walker.corner + further
    if k < walker.corners:
        return corners[k, 0], corners[k, 1], False
    return walker.goal_x, walker.goal_y, True


@borrowing
def _corner_away(walker: Any, x: float, y: float, corners: Floats) -> float:
    """Return the distance to the next corner, inf behind the last."""
    if walker.corner >= walker.corners:
        return inf
    return sqrt((corners[walker.corner, 0] - x) ** 2 + (corners[walker.corner, 1] - y) ** 2)


@borrowing
def _detect_stuck(walker: Any, x: float, y: float, dt: float, rules: RouteRules) -> None:
    """Wish for the next waypoint after a period with less progress than a share of the person's own greatest speed."""
    walker.stuck_clock += dt
    if walker.stuck_clock < (rules.door_wait if walker.waiting == 1 else rules.stuck_period):
        return
    if (
        sqrt((walker.anchor_x - x) ** 2 + (walker.anchor_y - y) ** 2)
        < rules.stuck_speed * walker.desired_speed * walker.stuck_clock
    ):
        walker.wish = NEXT_WAYPOINT
    walker.anchor_x, walker.anchor_y, walker.stuck_clock = x, y, 0.0


@borrowing
def _is_due(walker: Any, dt: float, rules: RouteRules) -> bool:
    """Return whether it is time to look ahead; the clock then begins again."""
    walker.look_clock += dt
    if walker.look_clock < rules.look_period:
        return False
    walker.look_clock = 0.0
    return True


@borrowing
def _pass_corners(memory: NDArray[np.void], ground: Ground, asked: int, looks: SightLines) -> None:
    """Let those who see what comes after their next corner go there; they need not look for the corner any more."""
    check_sight_lines(ground, looks.sights, asked, looks.open_ones)
    for k in range(asked):
        if looks.sights[k, SEEN] > 0.0:
            memory[looks.askers[k]].corner += 1
            looks.due[looks.askers[k]] = False


@borrowing
def _watch_targets(
    bodies: Bodies, memory: NDArray[np.void], corners: Floats, ground: Ground, looks: SightLines
) -> None:
    """Let those whose time it is look for their targets, and wish for a new route where that is out of sight."""
    positions, _, radii, _ = bodies
    asked = 0
    for i in range(len(positions)):
        if looks.due[i] and memory[i].wish == NOTHING:
            to_x, to_y, _ = _look_target(memory[i], 0, corners[i])
            if memory[i].waiting == 1 and door_on_way(ground, (positions[i, 0], positions[i, 1], radii[i]), to_x, to_y):
                continue
            put_sight_line(
                ground, looks.sights[asked], (positions[i, 0], positions[i, 1], to_x, to_y), LOSING_SIGHT * radii[i]
            )
            looks.askers[asked] = i
            asked += 1
    check_sight_lines(ground, looks.sights, asked, looks.open_ones)
    for k in range(asked):
        if looks.sights[k, SEEN] == 0.0:
            memory[looks.askers[k]].wish = NEW_ROUTE


@compiled
def assign_routes(
    crowds: Crowds,
    memory: NDArray[np.void],
    waypoints: Floats,
    corners: Floats,
    land: GroundStack,
    rooms: Any,
    nodes: NDArray[np.int32],
) -> None:
    """Give everybody who wishes for it the next of the ``waypoints``, and a route there in ``corners``."""
    for world in range(len(crowds.counts)):
        positions, _, radii, _ = bodies_of(crowds, world)
        ground, world_rooms = world_ground(land, world), coarse_grid_of(rooms, land.grids[world])
        for i in range(len(positions)):
            walker = memory[world, i]
            if walker.wish == NOTHING:
                continue
            x, y = positions[i, 0], positions[i, 1]
            if walker.wish == NEW_ROUTE and _finds_back(walker, (x, y, radii[i]), corners[world, i], ground):
                walker.wish = NOTHING
                continue
            if walker.wish == NEXT_WAYPOINT:
                walker.waypoint = (walker.waypoint + 1) % walker.waypoints
                walker.legs += 1
                walker.stay = _stay_time(walker, i)
                walker.anchor_x, walker.anchor_y, walker.stuck_clock = x, y, 0.0
            walker.goal_x, walker.goal_y = (
                waypoints[world, i, walker.waypoint, 0],
                waypoints[world, i, walker.waypoint, 1],
            )
            walker.wish, walker.look_clock, walker.corner, walker.waiting = NOTHING, 0.0, 0, 0
            walker.corners = _find_route(
                walker, (x, y, radii[i]), corners[world, i], ground, RouteSearch(world_rooms, nodes)
            )


@borrowing
def _stay_time(walker: Any, i: int) -> float:
    """Return how long a person will stay at the waypoint just chosen, s."""
    if walker.waypoints == 1 or not uniform(walker.key, walker.legs, 2 * i) < walker.stay_chance:
        return 0.0
    spread: float = SPREAD * (2.0 * uniform(walker.key, walker.legs, 2 * i + 1) - 1.0)
    return walker.stay_time + walker.stay_time * spread  # type: ignore[no-any-return]


@borrowing
def _finds_back(walker: Any, disc: tuple[float, float, float], corners: Floats, ground: Ground) -> bool:
    """Turn to the corner just passed if that is near and in sight: who was pushed aside needs no search."""
    x, y, radius = disc
    if walker.corner == 0:
        return False
    corner_x, corner_y = corners[walker.corner - 1, 0], corners[walker.corner - 1, 1]
    if sqrt((corner_x - x) ** 2 + (corner_y - y) ** 2) > BACK or not is_visible(
        ground, (x, y, corner_x, corner_y), SIGHT * radius
    ):
        return False
    walker.corner -= 1
    return True


@compiled
def _find_route(
    walker: Any, disc: tuple[float, float, float], corners: Floats, ground: Ground, search: RouteSearch
) -> int:
    """Write the corners of the way to the goal and return their number, 0 for a straight way or
    none; move a goal that has no room.
    """
    x, y, radius = disc
    if wall_clearance(ground, walker.goal_x, walker.goal_y) < SIGHT * radius:
        goal_x, goal_y, _ = nearest_room(ground, search.rooms, walker.goal_x, walker.goal_y, radius)
        walker.goal_x, walker.goal_y = goal_x, goal_y
    if is_visible(ground, (x, y, walker.goal_x, walker.goal_y), SIGHT * radius):
        return 0
    _, _, start = nearest_room(ground, search.rooms, x, y, radius)
    _, _, goal = nearest_room(ground, search.rooms, walker.goal_x, walker.goal_y, radius)
    if start < 0 or goal < 0:
        return 0
    return max(
        find_corners(
            ground,
            RouteSearch(search.rooms, search.nodes),
            (x, y, start),
            (walker.goal_x, walker.goal_y, goal),
            radius,
            corners,
        ),
        0,
    )
