"""From waypoint to waypoint: which way each person heads now, and the route to where that leads."""

from __future__ import annotations

from math import inf, sqrt
from typing import Any

import numpy as np
from numpy.typing import NDArray

from arena_crowds.orca.parameters import WayRules
from arena_crowds.orca.walkers import NEW_ROUTE, NEXT_WAYPOINT, NOTHING, STANDING, WALKING
from arena_kernels.compiled import compiled
from arena_kernels.crowds import Crowds, bodies_of
from arena_kernels.ground import Ground, Land, clearance, ground_below
from arena_kernels.random import uniform
from arena_kernels.route_grid import Rooms, rooms_of
from arena_kernels.routes import find_corners, nearest_room
from arena_kernels.sliding import LOSING_SIGHT, SIGHT, is_visible

Floats = NDArray[np.float64]

LEAVING = 2.0  # who stands at the only waypoint walks back when this many waypoint radii away
BACK = 3.0  # m, who lost sight of the way goes back to a corner this near
SPREAD = 0.5  # a stay lasts its mean x U(1 - SPREAD, 1 + SPREAD)
AT_CORNER = 0.05  # m, a corner this near gives no direction


@compiled
def follow(
    walker: Any, state: int, x: float, y: float, radius: float, corners: Floats, ground: Ground, dt: float, rules: WayRules
) -> tuple[int, float, float, float]:
    """Return the state, the unit vector to walk along and how far that way leads (inf before a corner); note wishes."""
    to_goal = sqrt((walker.goal_x - x) ** 2 + (walker.goal_y - y) ** 2)
    if state == STANDING and walker.waypoints > 1:
        walker.stay -= dt
        if walker.stay > 0.0:
            return STANDING, 0.0, 0.0, 0.0
        walker.wish = NEXT_WAYPOINT
    elif state == STANDING:
        if walker.waypoints == 0 or to_goal < LEAVING * rules.waypoint_radius:
            return STANDING, 0.0, 0.0, 0.0
        walker.wish, walker.corner, walker.corners = NEW_ROUTE, 0, 0
    if walker.corner >= walker.corners and to_goal < rules.waypoint_radius:
        if walker.waypoints == 1:
            return STANDING, 0.0, 0.0, 0.0
        if walker.stay > 0.0:
            return STANDING, 0.0, 0.0, 0.0
        walker.wish = NEXT_WAYPOINT
    _notice_stuck(walker, x, y, dt, rules)
    _look_ahead(walker, x, y, radius, corners, ground, dt, rules)
    target_x, target_y, last = _target(walker, 0, corners)
    away = sqrt((target_x - x) ** 2 + (target_y - y) ** 2)
    if away == 0.0:
        return WALKING, 0.0, 0.0, 0.0
    return WALKING, (target_x - x) / away, (target_y - y) / away, away if last else inf


@compiled
def _target(walker: Any, further: int, corners: Floats) -> tuple[float, float, bool]:
    """Return the corner so many places further on, or the goal behind the last corner, and whether it is the goal."""
    k = walker.corner + further
    if k < walker.corners:
        return corners[k, 0], corners[k, 1], False
    return walker.goal_x, walker.goal_y, True


@compiled
def _notice_stuck(walker: Any, x: float, y: float, dt: float, rules: WayRules) -> None:
    """Wish for the next waypoint after a period with less progress than a share of the own greatest speed."""
    walker.stuck_clock += dt
    if walker.stuck_clock < rules.stuck_period:
        return
    if sqrt((walker.anchor_x - x) ** 2 + (walker.anchor_y - y) ** 2) < rules.stuck_speed * walker.desired_speed * walker.stuck_clock:
        walker.wish = NEXT_WAYPOINT
    walker.anchor_x, walker.anchor_y, walker.stuck_clock = x, y, 0.0


@compiled
def _look_ahead(walker: Any, x: float, y: float, radius: float, corners: Floats, ground: Ground, dt: float, rules: WayRules) -> None:
    """Go on to what comes after a corner that is near or needed no more; wish for a new route when the target is out of sight."""
    walker.look_clock += dt
    looks = walker.look_clock >= rules.look_period
    if looks:
        walker.look_clock = 0.0
    target_x, target_y, last = _target(walker, 0, corners)
    if not last:
        away = sqrt((target_x - x) ** 2 + (target_y - y) ** 2)
        if looks or away < rules.corner_radius:
            next_x, next_y, _ = _target(walker, 1, corners)
            if away < AT_CORNER or is_visible(ground, x, y, next_x, next_y, SIGHT * radius):
                walker.corner += 1
                return
    if looks and walker.wish == NOTHING and not is_visible(ground, x, y, target_x, target_y, LOSING_SIGHT * radius):
        walker.wish = NEW_ROUTE


@compiled
def grant_wishes(
    crowds: Crowds, memory: NDArray[np.void], waypoints: Floats, corners: Floats, land: Land, rooms: Any, nodes: NDArray[np.int32]
) -> None:
    """Give everybody who wishes for it the next of the ``waypoints``, and a route there in ``corners``."""
    for world in range(len(crowds.counts)):
        positions, _, radii, _ = bodies_of(crowds, world)
        ground, world_rooms = ground_below(land, world), rooms_of(rooms, land.grids[world])
        for i in range(len(positions)):
            walker = memory[world, i]
            if walker.wish == NOTHING:
                continue
            x, y = positions[i, 0], positions[i, 1]
            if walker.wish == NEW_ROUTE and _finds_back(walker, x, y, radii[i], corners[world, i], ground):
                walker.wish = NOTHING
                continue
            if walker.wish == NEXT_WAYPOINT:
                walker.waypoint = (walker.waypoint + 1) % walker.waypoints
                walker.legs += 1
                walker.stay = _stay(walker, i)
                walker.anchor_x, walker.anchor_y, walker.stuck_clock = x, y, 0.0
            walker.goal_x, walker.goal_y = waypoints[world, i, walker.waypoint, 0], waypoints[world, i, walker.waypoint, 1]
            walker.wish, walker.look_clock, walker.corner = NOTHING, 0.0, 0
            walker.corners = _route(walker, x, y, radii[i], corners[world, i], ground, world_rooms, nodes)


@compiled
def _stay(walker: Any, i: int) -> float:
    """Return how long somebody will stay at the waypoint just chosen, s."""
    if walker.waypoints == 1 or not uniform(walker.key, walker.legs, 2 * i) < walker.stay_chance:
        return 0.0
    spread: float = SPREAD * (2.0 * uniform(walker.key, walker.legs, 2 * i + 1) - 1.0)
    return walker.stay_time + walker.stay_time * spread  # type: ignore[no-any-return]


@compiled
def _finds_back(walker: Any, x: float, y: float, radius: float, corners: Floats, ground: Ground) -> bool:
    """Turn to the corner just passed if that is near and in sight: who was pushed aside needs no search."""
    if walker.corner == 0:
        return False
    corner_x, corner_y = corners[walker.corner - 1, 0], corners[walker.corner - 1, 1]
    if sqrt((corner_x - x) ** 2 + (corner_y - y) ** 2) > BACK or not is_visible(ground, x, y, corner_x, corner_y, SIGHT * radius):
        return False
    walker.corner -= 1
    return True


@compiled
def _route(walker: Any, x: float, y: float, radius: float, corners: Floats, ground: Ground, rooms: Rooms, nodes: NDArray[np.int32]) -> int:
    """Write the corners of the way to the goal and return their number, 0 for a straight way or none; move a goal that has no room."""
    if clearance(ground, walker.goal_x, walker.goal_y) < SIGHT * radius:
        goal_x, goal_y, _ = nearest_room(ground, rooms, walker.goal_x, walker.goal_y, radius)
        walker.goal_x, walker.goal_y = goal_x, goal_y
    if is_visible(ground, x, y, walker.goal_x, walker.goal_y, SIGHT * radius):
        return 0
    _, _, start = nearest_room(ground, rooms, x, y, radius)
    _, _, goal = nearest_room(ground, rooms, walker.goal_x, walker.goal_y, radius)
    if start < 0 or goal < 0:
        return 0
    return max(find_corners(ground, rooms, (x, y, start), (walker.goal_x, walker.goal_y, goal), radius, nodes, corners), 0)
