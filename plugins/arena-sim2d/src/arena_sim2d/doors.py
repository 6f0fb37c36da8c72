"""Doors: when they are open, and that they do not close on anyone."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from arena_core import Scenario
from arena_kernels.compiled import inner
from arena_kernels.footprint import disc_like, place_body
from arena_sim2d.bodies import BEAMS, DOOR, PEOPLE, ROBOTS, Floats, Row, Rows, World
from arena_sim2d.clearances import gap_to_obstacle

INSTANT = 1e-9  # s, as in arena_core's ``is_open``
CLOSED, OPEN = BEAMS | ROBOTS | PEOPLE, 0  # who meets a door


def table_doors(scenario: Scenario, first: int) -> tuple[Rows, Floats]:
    """Return a scenario's doors (D,), whose obstacles are those from ``first`` on, and the intervals of all (I, 2)."""
    table = np.zeros(len(scenario.doors), DOOR)
    ends = np.cumsum([0, *(len(door.open) for door in scenario.doors)])
    for row, door in enumerate(scenario.doors):
        period = math.inf if door.period is None else door.period
        table[row] = (first + row, ends[row], ends[row + 1], 1, period)
    return table, np.concatenate([np.empty((0, 2)), *(door.open for door in scenario.doors)])


@inner
def move_doors(world: World, stamp: float) -> None:
    """Open and close the doors of a world as they are to be at ``stamp`` s; one in which someone stands stays open."""
    for d in range(world.robots[world.k].doors):
        door = world.doors[d]
        if _is_scheduled(world, door, stamp):
            door.open = 1
        elif door.open == 1 and not _is_occupied(world, door.obstacle):
            door.open = 0
        world.obstacles[door.obstacle].meets = OPEN if door.open == 1 else CLOSED


@inner
def _is_scheduled(world: World, door: Row, stamp: float) -> bool:
    """Return whether a door is open by its timetable."""
    time = stamp + INSTANT
    if door.period < math.inf:
        time -= math.floor(time / door.period) * door.period
    scheduled = False
    for i in range(door.first, door.last):
        scheduled |= world.openings[i, 0] <= time < world.openings[i, 1]
    return scheduled


@inner
def _is_occupied(world: World, obstacle: int) -> bool:
    """Return whether a robot or a person stands where a door is when it is closed."""
    for row in range(world.first, world.first + world.team):
        robot = world.robots[row]
        place_body(world.body, robot.x, robot.y, robot.theta)
        if not robot.absent and gap_to_obstacle(world, obstacle, world.body, 0.0)[0] < 0.0:
            return True
    for i in range(world.robots[world.k].people):
        person = world.people[i]
        if math.isnan(person.x):
            continue
        body = disc_like(world.person, person.radius)
        place_body(body, person.x, person.y, 0.0)
        if gap_to_obstacle(world, obstacle, body, 0.0)[0] < 0.0:
            return True
    return False


def doors_open(doors: Rows) -> NDArray[np.bool_] | None:
    """Return which of the doors (N, D) are open; None where no world has any."""
    return np.asarray(doors["open"] == 1) if doors.shape[1] else None
