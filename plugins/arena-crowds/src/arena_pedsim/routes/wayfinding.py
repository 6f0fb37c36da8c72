"""Where each person heads now: corners passed, waypoints reached, ways lost from sight, people stuck."""

from __future__ import annotations

from math import sqrt
from typing import Any

import numpy as np
from numpy.typing import NDArray

from arena_kernels.compiled import compiled
from arena_kernels.doorways import door_on_way
from arena_kernels.ground import Ground
from arena_kernels.slide_along import LOSING_SIGHT, SIGHT, is_visible
from arena_pedsim.crowd_scene import KnownWay, Step
from arena_pedsim.people import LEAVE, NEVER, NEW_ROUTE, NEXT_WAYPOINT, NO_ERRAND, NOTHING, ON_ERRAND
from arena_pedsim.state_ids import SHYING_FROM_ROBOT, STANDING, WALKING, desired_speed, goes_somewhere

AT_CORNER = 0.05  # m, a corner this near gives no direction
SLOWING = 2.0  # relaxation times in which who goes to stand somewhere would be there: hardly overshoots
LEAVING = 2.0  # who stands at the only waypoint walks back when this many waypoint radii away


@compiled
def follow_way(
    person: Any, state: int, disc: tuple[float, float, float], way: KnownWay, step: Step
) -> tuple[int, float, float, float]:
    """Return the state, the unit vector to walk along and the distance to the goal (inf when a
    corner comes first); note wishes.
    """
    x, y, _ = disc
    if not goes_somewhere(state, step.parameters):
        return _recalled_state(person, state, (x, y), step.dt, step.parameters), 0.0, 0.0, 0.0
    if person.errand == ON_ERRAND:  # the place may move
        person.goal_x, person.goal_y = person.errand_x, person.errand_y
    to_goal = sqrt((person.goal_x - x) ** 2 + (person.goal_y - y) ** 2)
    if person.errand == NO_ERRAND:
        if person.corner >= person.corners and to_goal < step.parameters.wayfinding_waypoint_radius:
            if person.respawn != NEVER and person.waypoint == person.waypoints - 1:
                person.wish = LEAVE
                return state, 0.0, 0.0, 0.0
            if person.waypoints == 1:
                return (state if state == SHYING_FROM_ROBOT else STANDING), 0.0, 0.0, 0.0
            if person.stay > 0.0:
                person.stay -= step.dt
                return (state if state == SHYING_FROM_ROBOT else STANDING), 0.0, 0.0, 0.0
            person.wish = NEXT_WAYPOINT
        _detect_stuck(person, state, (x, y), step.dt, step.parameters)
    person.look_clock += step.dt
    if person.look_clock >= step.parameters.wayfinding_look_period:
        person.look_clock = 0.0
        if step.parameters.wayfinding_routing == 1 and person.lost == 0:
            _look_ahead(person, disc, way.corners, way.ground)
    if person.corner < person.corners:
        dx, dy = way.corners[person.corner, 0] - x, way.corners[person.corner, 1] - y
        distance = sqrt(dx * dx + dy * dy)
        if not _is_passed(person, distance, disc, way, step.parameters):
            return state, dx / distance, dy / distance, np.inf
        person.corner += 1
    if to_goal == 0.0:
        return state, 0.0, 0.0, 0.0
    return state, (person.goal_x - x) / to_goal, (person.goal_y - y) / to_goal, to_goal


@compiled
def _recalled_state(person: Any, state: int, place: tuple[float, float], dt: float, parameters: Any) -> int:
    """Return WALKING for who has stayed long enough, or was pushed away from the only waypoint, else the state."""
    x, y = place
    if state != STANDING or person.waypoints == 0:
        return state
    if person.waypoints > 1:
        person.stay -= dt
        if person.stay > 0.0:
            return state
        person.wish = NEXT_WAYPOINT
        return WALKING
    away = sqrt((person.goal_x - x) ** 2 + (person.goal_y - y) ** 2)
    if away < LEAVING * parameters.wayfinding_waypoint_radius:
        return state
    person.wish = NEW_ROUTE
    return WALKING


@compiled
def _detect_stuck(person: Any, state: int, place: tuple[float, float], dt: float, parameters: Any) -> None:
    """Wish for the next waypoint after a period with less progress than a share of the speed that the person wants now.

    The period is shorter for who stands face to face with a person: those two wait in vain, a queue does not.
    """
    x, y = place
    person.stuck_clock += dt
    period = parameters.wayfinding_door_wait if person.waiting == 1 else parameters.wayfinding_stuck_period
    if person.stuck_clock < (min(parameters.wayfinding_meeting_period, period) if person.opposed == 1 else period):
        return
    progress = sqrt((person.anchor_x - x) ** 2 + (person.anchor_y - y) ** 2)
    stuck = progress < parameters.wayfinding_stuck_speed * desired_speed(person, state, parameters) * person.stuck_clock
    if stuck and person.wish != LEAVE:
        person.wish = NEXT_WAYPOINT
    if stuck or person.stuck_clock >= period:
        person.anchor_x, person.anchor_y, person.stuck_clock = x, y, 0.0


@compiled
def _look_ahead(person: Any, disc: tuple[float, float, float], corners: NDArray[np.float64], ground: Ground) -> None:
    """Head for what comes after the next corner once that is in sight; wish for a
    new route when not even the corner is.
    """
    x, y, radius = disc
    if person.corner < person.corners:
        if _sees_beyond(person, disc, corners, ground):
            person.corner += 1
            return
        target_x, target_y = corners[person.corner, 0], corners[person.corner, 1]
    else:
        target_x, target_y = person.goal_x, person.goal_y
    if person.waiting == 1 and door_on_way(ground, disc, target_x, target_y):
        return
    if not is_visible(ground, (x, y, target_x, target_y), LOSING_SIGHT * radius) and person.wish == NOTHING:
        person.wish = NEW_ROUTE


@compiled
def _is_passed(person: Any, distance: float, disc: tuple[float, float, float], way: KnownWay, parameters: Any) -> bool:
    """Return whether a corner at this distance lies behind: what follows is in sight,
    or there is nothing left to walk.
    """
    if distance >= parameters.wayfinding_corner_radius:
        return False
    return distance < AT_CORNER or _sees_beyond(person, disc, way.corners, way.ground)


@compiled
def _sees_beyond(person: Any, disc: tuple[float, float, float], corners: NDArray[np.float64], ground: Ground) -> bool:
    """Return whether the place after the next corner is in sight."""
    x, y, radius = disc
    after = person.corner + 1
    after_x, after_y = (
        (corners[after, 0], corners[after, 1]) if after < person.corners else (person.goal_x, person.goal_y)
    )
    return is_visible(ground, (x, y, after_x, after_y), SIGHT * radius)
