"""How people keep out of robots' way, unless they ignore it."""

from __future__ import annotations

from math import inf, sqrt
from typing import Any

from arena_kernels.compiled import compiled
from arena_kernels.crowds import Robot, Robots, robot_at
from arena_kernels.ground import Ground, wall_clearance
from arena_pedsim.state_ids import BLOCKING_ROBOT


@compiled
def detour_heading(
    ground: Ground,
    disc: tuple[float, float, float],
    heading_x: float,
    heading_y: float,
    goal_distance: float,
    robots: Robots,
    parameters: Any,
) -> tuple[float, float]:
    """Return the heading that passes the nearest robot that stands in the way, the heading itself where none does.

    The heading turns to the tangent of the disc that must stay free, on the nearer side (the right if both are near),
    or on the other if a wall or another robot leaves no room there. Without room on either side the heading stays, and
    ``brake_for_robots`` stops the person.
    """
    x, y, radius = disc
    nearest, least = -1, inf
    for place in range(len(robots.radii)):
        robot = robot_at(robots, place)
        squared = (robot.x - x) ** 2 + (robot.y - y) ** 2
        if squared < least and _is_in_the_way(disc, (heading_x, heading_y), goal_distance, robot, parameters):
            nearest, least = place, squared
    if nearest < 0:
        return heading_x, heading_y
    robot = robot_at(robots, nearest)
    dx, dy = robot.x - x, robot.y - y
    separation = sqrt(dx * dx + dy * dy)
    free = radius + robot.radius + parameters.giving_way_margin
    aside = heading_x * dy - heading_y * dx  # > 0: the robot is to the left
    side = -1.0 if aside >= 0.0 else 1.0  # -1: pass with the robot on the left
    for turn in (side, -side):
        tx, ty = _turn_vector(dx / separation, dy / separation, min(free / separation, 1.0), turn)
        beside_x, beside_y = robot.x - turn * free * ty, robot.y + turn * free * tx
        if wall_clearance(ground, beside_x, beside_y) >= radius and _is_free_of_others(
            (beside_x, beside_y, radius), nearest, robots, parameters
        ):
            return tx, ty
    return heading_x, heading_y


@compiled
def _is_in_the_way(
    disc: tuple[float, float, float], heading: tuple[float, float], way: float, robot: Robot, parameters: Any
) -> bool:
    """Return whether a robot stands on the next ``way`` m of a heading, and near."""
    (x, y, radius), (heading_x, heading_y) = disc, heading
    dx, dy = robot.x - x, robot.y - y
    separation = sqrt(dx * dx + dy * dy)
    free = radius + robot.radius + parameters.giving_way_margin
    ahead = heading_x * dx + heading_y * dy
    aside = heading_x * dy - heading_y * dx
    return bool(
        ahead > 0.0 and abs(aside) < free and ahead < way and separation < free + parameters.giving_way_distance
    )


@compiled
def _is_free_of_others(disc: tuple[float, float, float], nearest: int, robots: Robots, parameters: Any) -> bool:
    """Return whether no other robot takes the room beside the one that is passed."""
    x, y, radius = disc
    for place in range(len(robots.radii)):
        robot = robot_at(robots, place)
        reach = radius + robot.radius + 0.25 * parameters.giving_way_margin
        if place != nearest and (robot.x - x) ** 2 + (robot.y - y) ** 2 < reach * reach:
            return False
    return True


@compiled
def _turn_vector(ux: float, uy: float, sine: float, turn: float) -> tuple[float, float]:
    """Turn a unit vector by the angle with this sine, to the left if ``turn`` is 1, to the right if -1."""
    cosine = sqrt(1.0 - sine * sine)
    return ux * cosine - turn * sine * uy, turn * sine * ux + uy * cosine


@compiled
def brake_for_robots(
    disc: tuple[float, float, float], velocity: tuple[float, float], state: int, robots: Robots, parameters: Any
) -> tuple[float, float]:
    """Return the velocity without what would close the gaps to robots, one after the other, too soon."""
    vx, vy = velocity
    for place in range(len(robots.radii)):
        vx, vy = _brake_for_robot(disc, (vx, vy), state, robot_at(robots, place), parameters)
    return vx, vy


@compiled
def _brake_for_robot(
    disc: tuple[float, float, float], velocity: tuple[float, float], state: int, robot: Robot, parameters: Any
) -> tuple[float, float]:
    """Return the velocity without what would close the gap to the robot sooner than in ``time``.

    Within the margin this is a step back, unless the person blocks the way.
    """
    (x, y, radius), (vx, vy) = disc, velocity
    dx, dy = robot.x - x, robot.y - y
    separation = sqrt(dx * dx + dy * dy)
    if not separation > 0.0:
        return vx, vy
    ux, uy = dx / separation, dy / separation
    gap = separation - radius - robot.radius - 0.5 * parameters.giving_way_margin
    excess = (vx - robot.vx) * ux + (vy - robot.vy) * uy - gap / parameters.giving_way_time
    if state == BLOCKING_ROBOT:
        excess = min(excess, vx * ux + vy * uy)
    if excess <= 0.0:
        return vx, vy
    return vx - excess * ux, vy - excess * uy


@compiled
def keeps_distance(
    disc: tuple[float, float, float], new_x: float, new_y: float, robots: Robots, parameters: Any
) -> bool:
    """Return whether a move leaves gaps to where robots are now, or at least makes them no smaller: walls
    and other people push, too.
    """
    x, y, radius = disc
    for place in range(len(robots.radii)):
        robot = robot_at(robots, place)
        separation = sqrt((robot.x - new_x) ** 2 + (robot.y - new_y) ** 2)
        touch = radius + robot.radius + 0.25 * parameters.giving_way_margin
        if separation < touch and separation < sqrt((robot.x - x) ** 2 + (robot.y - y) ** 2):
            return False
    return True
