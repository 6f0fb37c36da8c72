"""Skip collision checks for bodies that cannot reach anything within the next ticks."""

from __future__ import annotations

import math

from arena_kernels.compiled import inner
from arena_kernels.motion import Chassis
from arena_sim2d.bodies import Row, World
from arena_sim2d.clearances import is_clear
from arena_sim2d.kinds import Kind

ROUNDING = 1e-6  # m, more than the rounding of all strides together


@inner
def mark_isolated(world: World, chassis: Chassis, ticks: int, dt: float) -> bool:
    """Return whether the robot surely meets nothing within ``ticks`` of ``dt`` s, and note in
    ``alone`` which of the people do.
    """
    robot = world.robots[world.k]
    way = _top_speed(robot, chassis) * ticks * dt + ROUNDING
    free = not robot.absent and is_clear(world, robot.x, robot.y, world.body.radius + way)
    for i in range(robot.people):
        person = world.people[i]
        stride = ticks * math.sqrt(person.dx * person.dx + person.dy * person.dy) + ROUNDING
        near = world.body.radius + person.radius + way + stride
        squared = (person.x - robot.x) ** 2 + (person.y - robot.y) ** 2
        free &= not squared <= near * near  # who is nowhere (NaN) is near no one
        person.alone = squared > near * near and is_clear(world, person.x, person.y, person.radius + stride)
    return bool(free)


@inner
def mark_isolated_team(world: World, kinds: tuple[Kind, ...], ticks: int, dt: float) -> None:
    """Note in ``alone`` which robots and people of a world with a team meet nothing within ``ticks`` of ``dt`` s."""
    first, end = world.first, world.first + world.team
    for i in range(world.robots[first].people):
        person = world.people[i]
        person.alone = is_clear(world, person.x, person.y, person.radius + _stride(person, ticks))
    for row in range(first, end):
        robot = world.robots[row]
        radius = world.bodies[robot.kind].radius
        way = _top_speed(robot, kinds[robot.kind].chassis) * ticks * dt + ROUNDING
        alone = not robot.absent and is_clear(world, robot.x, robot.y, radius + way)
        for i in range(robot.people):
            person = world.people[i]
            near = radius + person.radius + way + _stride(person, ticks)
            squared = (person.x - robot.x) ** 2 + (person.y - robot.y) ** 2
            alone &= not squared <= near * near  # who is nowhere (NaN) is near no one
            person.alone &= squared > near * near
        for other in range(first, end):
            mate = world.robots[other]
            near = radius + world.bodies[mate.kind].radius + way
            near += _top_speed(mate, kinds[mate.kind].chassis) * ticks * dt + ROUNDING
            if other != row and not mate.absent:
                alone &= (mate.x - robot.x) ** 2 + (mate.y - robot.y) ** 2 > near * near
        robot.alone = alone


@inner
def _stride(person: Row, ticks: int) -> float:
    """Return how far a person goes at most within ``ticks``, m."""
    return ticks * math.sqrt(person.dx * person.dx + person.dy * person.dy) + ROUNDING


@inner
def _top_speed(robot: Row, chassis: Chassis) -> float:
    """Return the greatest speed that the robot may have from now on, m/s."""
    vx = max(abs(robot.vx), chassis.vx_max, abs(chassis.vx_min))
    vy = max(abs(robot.vy), chassis.vy_max)
    return math.sqrt(vx * vx + vy * vy)
