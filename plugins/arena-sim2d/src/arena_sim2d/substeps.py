"""From one crowd step to the next: the way of a tick of everybody, and who comes and who leaves."""

from __future__ import annotations

import math

from arena_kernels.compiled import borrowing
from arena_kernels.footprint import place_body
from arena_sim2d.bodies import Floats, Worlds
from arena_sim2d.clearances import gap_to_round


@borrowing
def set_substeps(worlds: Worlds, wanted: Floats, velocities: Floats, ticks: int) -> None:
    """Let people go in so many equal strides to where they want to be (N, P, 2); their velocities (N, P, 2) are those
    given.

    Who is not in the world is nowhere (NaN) and has no way to go. Who wants to be nowhere leaves at once; who comes is
    at once where it wants to be, unless the robot is in that place: then it waits for the next time.
    """
    for k in range(len(wanted)):
        robot = worlds.robots[k]
        place_body(worlds.body, robot.x, robot.y, robot.theta)
        for i in range(robot.people):
            person, x, y = worlds.people[k, i], wanted[k, i, 0], wanted[k, i, 1]
            comes, leaves = math.isnan(person.x), math.isnan(x)
            waits = comes and gap_to_round(worlds.body, x, y, person.radius, 0.0)[0] < 0.0
            if leaves or (comes and not waits):
                person.x, person.y = x, y
            if leaves or waits:
                person.dx, person.dy = 0.0, 0.0
            else:
                person.dx, person.dy = (x - person.x) / ticks, (y - person.y) / ticks
            person.vx, person.vy = velocities[k, i, 0], velocities[k, i, 1]
