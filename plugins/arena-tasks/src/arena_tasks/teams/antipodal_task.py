"""Robots on a circle, each bound for the place opposite: all ways meet in the middle."""

from __future__ import annotations

import math
from typing import Annotated

import numpy as np

from arena_core import Pose, Robot, Scenario, TaskMode, WorldSource, random_generator
from arena_core.files import LIMITS
from arena_core.parameters import Bounds, Fraction, Positive
from arena_tasks.teams.room_check import check_room, make_team

TeamSize = Annotated[int, Bounds(low=2, high=LIMITS.robots)]


class AntipodalTask(TaskMode):
    """Scenario ``index`` has ``team`` robots evenly on a circle of ``radius`` m about the middle of the world's map.

    The circle is turned by an angle that is drawn, and each robot stands off its place on it by up to ``jitter`` of
    half the way to its neighbour. ``teammates`` is the planner of all but the first robot; None: the run's.
    """

    def __init__(
        self,
        robot: Robot,
        world: WorldSource,
        team: TeamSize,
        teammates: str | None,
        radius: Positive,
        jitter: Fraction,
        goal_radius: Positive,
        time_limit: Positive,
    ) -> None:
        self._robot, self._world = robot, world
        self._team, self._teammates = team, teammates
        self._radius, self._jitter = radius, jitter
        self._goal_radius, self._time_limit = goal_radius, time_limit

    def robots(self) -> int:
        """Return the number of robots on the circle."""
        return self._team

    def scenario(self, seed: int, index: int) -> Scenario:
        """Return the circle of an index; raise ImpossibleScenario where the world or the circle has no room for it."""
        name, world = f"antipodal/{index:04d}", self._world.world(seed, index)
        drawn = random_generator(seed, name, "team").uniform(-1.0, 1.0, self._team + 1)
        step = 2.0 * math.pi / self._team
        angles = step * (drawn[0] + np.arange(self._team) + 0.5 * self._jitter * drawn[1:])
        x, y = world.grid.positions([(side - 1) / 2 for side in world.grid.data.shape]).tolist()
        ways = [(self._place(x, y, angle), self._place(x, y, angle + math.pi)) for angle in angles.tolist()]
        ways = [(start, Pose(goal.x, goal.y, start.theta)) for start, goal in ways]
        check_room(name, world.grid, ways, self._robot)
        start, goal = ways[0]
        return Scenario(
            name,
            seed,
            world,
            start,
            goal,
            (),
            (),
            self._goal_radius,
            self._time_limit,
            team=make_team(ways, self._teammates),
        )

    def _place(self, x: float, y: float, angle: float) -> Pose:
        """Return the place at an angle on the circle about (x, y), heading for its middle."""
        heading = math.remainder(angle + math.pi, 2.0 * math.pi)
        return Pose(x + self._radius * math.cos(angle), y + self._radius * math.sin(angle), heading)
