"""From one crowd step to the next: the way of a tick of everybody, and who comes and who leaves."""

from __future__ import annotations

import math

from arena_kernels.compiled import borrowing, inner
from arena_kernels.footprint import place_body
from arena_sim2d.bodies import Floats, Worlds, team_of
from arena_sim2d.clearances import gap_to_round


@borrowing
def set_substeps(worlds: Worlds, wanted: Floats, velocities: Floats, ticks: int) -> None:
    """Let people go in so many equal strides to where they want to be (N, P, 2); their velocities (N, P, 2) are those
    given.

    Who is not in the world is nowhere (NaN) and has no way to go. Who wants to be nowhere leaves at once; who comes is
    at once where it wants to be, unless a robot is in that place: then it waits for the next time.
    """
    for k in range(len(wanted)):
        first = k * team_of(worlds)
        for i in range(worlds.robots[first].people):
            person, x, y = worlds.people[k, i], wanted[k, i, 0], wanted[k, i, 1]
            comes, leaves = math.isnan(person.x), math.isnan(x)
            waits = comes and _is_taken(worlds, first, x, y, person.radius)
            if leaves or (comes and not waits):
                person.x, person.y = x, y
            if leaves or waits:
                person.dx, person.dy = 0.0, 0.0
            else:
                person.dx, person.dy = (x - person.x) / ticks, (y - person.y) / ticks
            person.vx, person.vy = velocities[k, i, 0], velocities[k, i, 1]


@inner
def _is_taken(worlds: Worlds, first: int, x: float, y: float, radius: float) -> bool:
    """Return whether a robot of the team from row ``first`` on is where a person would be."""
    taken = False
    for row in range(first, first + team_of(worlds)):
        robot = worlds.robots[row]
        body = worlds.bodies[robot.kind]
        place_body(body, robot.x, robot.y, robot.theta)
        taken |= gap_to_round(body, x, y, radius, 0.0)[0] < 0.0
    return taken
