"""Robots on a circle, each bound for the place opposite: all ways meet in the middle."""

from __future__ import annotations

import math
from typing import Annotated

import numpy as np

from arena_core import Pose, Robot, Scenario, TaskMode, WorldSource, random_generator
from arena_core.parameters import Flat, Fraction, Positive
from arena_tasks.teams.team_rules import TeamRules, check_room


class AntipodalTask(TaskMode):
    """Scenario ``index`` has ``team`` robots evenly on a circle of ``radius`` m about the middle of the world's map.

    The circle is turned by an angle that is drawn, and each robot stands off its place on it by up to ``jitter`` of
    half the way to its neighbour.
    """

    def __init__(
        self,
        robot: Robot,
        world: WorldSource,
        rules: Annotated[TeamRules, Flat()],
        radius: Positive,
        jitter: Fraction,
    ) -> None:
        self._robot, self._world = robot, world
        self._rules, self._team = rules, rules.team
        self._radius, self._jitter = radius, jitter

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
        return self._rules.scenario(name, seed, world, ways)

    def _place(self, x: float, y: float, angle: float) -> Pose:
        """Return the place at an angle on the circle about (x, y), heading for its middle."""
        heading = math.remainder(angle + math.pi, 2.0 * math.pi)
        return Pose(x + self._radius * math.cos(angle), y + self._radius * math.sin(angle), heading)
