"""The lower bound of time: no robot of this size, speed and acceleration that touches nobody is sooner at the goal."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from arena_core import Robot, Scenario
from arena_core.records import ARRIVAL_SLACK
from arena_reference.arrays import Floats
from arena_reference.body import Moving, Walkers
from arena_reference.outlook import fastest, strongest, walkers_in_cells
from arena_reference.reach import Bits, earliest_step, pack
from arena_reference.terrain import Terrain
from arena_reference.values import STRIDE

ROUNDING = 1.0  # cells by which a place on the grid may be off: half a diagonal, and what the steps leave over
NOBODY = Walkers(np.empty((1, 0, 2)), np.empty(0), 0.0, 1.0)


class Bound:
    """Reachable sets of one problem: a disc of the inscribed radius goes at the robot's greatest speed, which it comes
    to from rest, in any direction.

    Free ground and the goal are rounded outwards, people inwards. Doors count as open: someone may hold one open.
    """

    def __init__(self, robot: Robot, scenario: Scenario, terrain: Terrain) -> None:
        self._terrain, self._scenario = terrain, scenario
        self._off = ROUNDING * terrain.cell
        self._radius, self._speed = robot.footprint.inscribed_radius, fastest(robot, scenario.speed_share)
        self._clock = Clock(STRIDE * terrain.cell, self._speed, strongest(robot))
        self._free = pack(terrain.distance > self._radius - terrain.error - self._off)
        self._goal = self._goal_cells()

    def _goal_cells(self) -> Bits:
        rows, columns = self._terrain.distance.shape
        x, y = self._terrain.cells_of(self._scenario.goal.x, self._scenario.goal.y)
        within = self._scenario.goal_radius + ARRIVAL_SLACK + self._off
        goal, reach = np.zeros((rows, columns), np.bool_), math.ceil(within / self._terrain.cell) + 1
        near = [
            np.arange(max(0, math.floor(at) - reach), min(count, math.floor(at) + reach + 1))
            for at, count in ((y, rows), (x, columns))
        ]
        away = np.hypot(near[1] + 0.5 - x, (near[0] + 0.5 - y)[:, None]) * self._terrain.cell
        goal[np.ix_(*near)] = away <= within
        return pack(goal)

    def time(self, people: Walkers = NOBODY, until: float | None = None) -> float:
        """Return the least time to the goal, s, among what stands and these people; inf where the time ``until`` (the
        time limit) is not enough.
        """
        limit = self._scenario.time_limit if until is None else until
        instants = self._clock.instants(self._clock.steps_in(limit))
        column, row = self._terrain.cells_of(self._scenario.start.x, self._scenario.start.y)
        rows, columns = self._terrain.distance.shape
        if not (0 <= row < rows and 0 <= column < columns):
            return 0.0  # begins off the map: nothing is known of it
        walkers = walkers_in_cells(self._terrain, people)
        radii = walkers.radii + (self._radius - self._off) / self._terrain.cell
        moving = Moving(walkers, radii, self._speed / self._terrain.cell)
        step = earliest_step(self._free, self._goal, (int(row), int(column)), instants, moving)
        return math.inf if step < 0 else float(instants[max(step - 1, 0)])


@dataclass(frozen=True, slots=True)
class Clock:
    """When a robot that begins at rest has gone so many steps of ``stride`` m at the earliest, with its ``speed`` (m/s)
    and ``acceleration`` (m/s^2).
    """

    stride: float
    speed: float
    acceleration: float

    def instants(self, steps: int) -> Floats:
        """Return the times (steps + 1,), s."""
        away = self.stride * np.arange(steps + 1)
        gentle = np.sqrt(2.0 * away / self.acceleration)
        swift = away / self.speed + 0.5 * self.speed / self.acceleration
        return np.where(away < 0.5 * self.speed**2 / self.acceleration, gentle, swift)

    def steps_in(self, time: float) -> int:
        """Return how many steps a time has, rounded down."""
        lost = 0.5 * self.speed / self.acceleration
        if time <= 2.0 * lost:
            return math.floor(0.5 * self.acceleration * time**2 / self.stride)
        return math.floor((time - lost) * self.speed / self.stride)
