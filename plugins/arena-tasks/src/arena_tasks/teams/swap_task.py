"""Two groups at the ends of a world that change places: through a corridor, or a door."""

from __future__ import annotations

import math
from typing import Annotated

import numpy as np

from arena_core import ImpossibleScenario, Pose, Robot, Scenario, TaskMode, WorldSource, random_generator
from arena_core.parameters import Flat, NonNegative, Positive
from arena_tasks.teams.team_rules import TeamRules, check_room


class SwapTask(TaskMode):
    """Scenario ``index`` has ``team`` robots, every other one at the low end of x and the rest at the high end, in
    columns across the world ``spacing`` m apart, ``margin`` m and more off the ends; each is bound for the place of one
    of the other group, which is drawn.
    """

    def __init__(
        self,
        robot: Robot,
        world: WorldSource,
        rules: Annotated[TeamRules, Flat()],
        spacing: Positive,
        margin: NonNegative,
    ) -> None:
        self._robot, self._world = robot, world
        self._rules, self._team = rules, rules.team
        self._spacing, self._margin = spacing, margin

    def robots(self) -> int:
        """Return the number of robots of both groups together."""
        return self._team

    def scenario(self, seed: int, index: int) -> Scenario:
        """Return the swap of an index; raise ImpossibleScenario where the world has no room for it."""
        name, world = f"swap/{index:04d}", self._world.world(seed, index)
        grid, half = world.grid, (self._team + 1) // 2
        low, high = grid.positions([(0, 0), (grid.data.shape[0] - 1, grid.data.shape[1] - 1)]).tolist()
        across = max(int((high[1] - low[1] - 2.0 * self._margin) / self._spacing) + 1, 1)
        middle = (low[1] + high[1]) / 2
        columns = math.ceil(half / across)
        if low[0] + self._margin + columns * self._spacing > high[0] - self._margin - columns * self._spacing:
            raise ImpossibleScenario(
                f"{name}: {self._team} robots find no room at the ends of {world.name}; allowed: fewer, or a larger "
                "world"
            )
        random = random_generator(seed, name, "team")
        places = np.array([_offset(k, half, across) for k in range(half)]) * self._spacing
        west = places * (1.0, 1.0) + (low[0] + self._margin, middle)
        east = places * (-1.0, 1.0) + (high[0] - self._margin, middle)
        ways = []
        for own, others, heading in ((west, east, 0.0), (east, west, math.pi)):
            order = random.permutation(half)
            ends = zip(own.tolist(), others[order].tolist(), strict=True)
            ways.append([(Pose(a, b, heading), Pose(c, d, heading)) for (a, b), (c, d) in ends])
        mixed = [way for pair in zip(*ways, strict=True) for way in pair][: self._team]
        check_room(name, grid, mixed, self._robot)
        return self._rules.scenario(name, seed, world, mixed)


def _offset(number: int, count: int, across: int) -> tuple[float, float]:
    """Return in which column a robot of a group stands, and how far off the middle, in spacings."""
    column, place = divmod(number, across)
    width = min(across, count - column * across)
    return float(column), place - (width - 1) / 2
