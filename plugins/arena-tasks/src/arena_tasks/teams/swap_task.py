"""Two groups at the ends of a world that change places: through a corridor, or a door."""

from __future__ import annotations

import math

import numpy as np

from arena_core import ImpossibleScenario, Pose, Robot, Scenario, TaskMode, WorldSource, random_generator
from arena_core.parameters import NonNegative, Positive
from arena_tasks.teams.antipodal_task import TeamSize
from arena_tasks.teams.room_check import check_room, make_team


class SwapTask(TaskMode):
    """Scenario ``index`` has ``team`` robots, every other one at the low end of x and the rest at the high end, in
    columns across the world ``spacing`` m apart, ``margin`` m and more off the ends; each is bound for the place of one
    of the other group, which is drawn.
    """

    def __init__(
        self,
        robot: Robot,
        world: WorldSource,
        team: TeamSize,
        teammates: str | None,
        spacing: Positive,
        margin: NonNegative,
        goal_radius: Positive,
        time_limit: Positive,
    ) -> None:
        self._robot, self._world = robot, world
        self._team, self._teammates = team, teammates
        self._spacing, self._margin = spacing, margin
        self._goal_radius, self._time_limit = goal_radius, time_limit

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
            ways.append([(Pose(*start, theta=heading), Pose(*goal, theta=heading)) for start, goal in ends])
        mixed = [way for pair in zip(*ways, strict=True) for way in pair][: self._team]
        check_room(name, grid, mixed, self._robot)
        start, goal = mixed[0]
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
            team=make_team(mixed, self._teammates),
        )


def _offset(number: int, count: int, across: int) -> tuple[float, float]:
    """Return in which column a robot of a group stands, and how far off the middle, in spacings."""
    column, place = divmod(number, across)
    width = min(across, count - column * across)
    return float(column), place - (width - 1) / 2
