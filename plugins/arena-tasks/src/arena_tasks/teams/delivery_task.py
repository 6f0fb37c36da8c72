"""Robots that deliver: a stream of goals, of which each robot takes the next one as soon as it is free."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from arena_core import ImpossibleScenario, Robot, Scenario, TaskMode, WorldSource, random_generator
from arena_core.parameters import Flat, NonNegative, Positive, PositiveInt
from arena_core.tasks import Errands, NextPlace
from arena_tasks.teams.patrol_graph import GraphOfFreeSpace
from arena_tasks.teams.patrol_task import ways_of
from arena_tasks.teams.team_rules import TeamRules, check_room

Points = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Deliveries(Errands):
    """The errands of one episode: goals are drawn one by one among the stations that no robot is at or bound for."""

    places: Points
    starts: tuple[int, ...]
    key: tuple[int, str]
    kind = "delivery"

    @property
    def bound_for(self) -> tuple[int, ...]:  # type: ignore[override]
        """Return the goals that robots have at first."""
        return self._begin()[0]

    def begin(self) -> NextPlace:
        """Begin an episode."""
        return self._begin()[1]

    def _begin(self) -> tuple[tuple[int, ...], NextPlace]:
        random = random_generator(*self.key, "delivery")
        taken = list(self.starts)

        def next_place(robot: int, stamp: float = 0.0) -> int:
            free = np.setdiff1d(np.arange(len(self.places)), taken)
            taken[robot] = int(random.choice(free))
            return taken[robot]

        return tuple(next_place(robot) for robot in range(len(self.starts))), next_place


@dataclass(frozen=True, slots=True)
class StationRules:
    """How many ``stations`` there are: places about ``spacing`` m apart and ``margin`` m more off walls than the
    robot's radius.
    """

    stations: PositiveInt
    spacing: Positive
    margin: NonNegative


class DeliveryTask(TaskMode):
    """Scenario ``index`` has stations, drawn from the free space, and ``team`` robots that start at stations."""

    def __init__(
        self,
        robot: Robot,
        world: WorldSource,
        rules: Annotated[TeamRules, Flat()],
        among: Annotated[StationRules, Flat()],
    ) -> None:
        self._robot, self._world, self._rules, self._stations = robot, world, rules, among.stations
        self._graph = GraphOfFreeSpace(among.spacing, robot.footprint.radius + among.margin)

    def robots(self) -> int:
        """Return the number of robots that deliver."""
        return self._rules.team

    def scenario(self, seed: int, index: int) -> Scenario:
        """Return the stations of an index; raise ImpossibleScenario where there are too few."""
        name, world = f"delivery/{index:04d}", self._world.world(seed, index)
        places = world.grid.derive(self._graph).places
        count = min(len(places), self._stations)
        if count <= self._rules.team:
            raise ImpossibleScenario(
                f"{name}: {self._rules.team} robots have {count} stations in {world.name}; allowed: more stations than "
                "robots, with a larger task.stations, a smaller task.spacing, or fewer robots"
            )
        random = random_generator(seed, name, "team")
        stations = places[random.permutation(len(places))[:count]]
        errands = Deliveries(stations, tuple(range(self._rules.team)), (seed, name))
        ways = ways_of(stations, errands.starts, errands.bound_for)
        check_room(name, world.grid, [(start, start) for start, _ in ways], self._robot)
        return self._rules.scenario(name, seed, world, ways, errands)
