"""Robots that patrol: they visit the places of a graph over the map again and again."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray

from arena_core import ImpossibleScenario, OccupancyGrid, Pose, Robot, Scenario, TaskMode, WorldSource, random_generator
from arena_core.parameters import Flat, NonNegative, Positive
from arena_core.tasks import Errands, NextPlace, PatrolGraph, PatrolStrategy
from arena_tasks.teams.patrol_graph import GraphOfFreeSpace, check_places, read_graph
from arena_tasks.teams.team_rules import TeamRules, check_room

Points = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Rounds(Errands):
    """The errands of one patrol: a strategy sends robots over the graph, from the places ``starts``."""

    graph: PatrolGraph
    strategy: PatrolStrategy
    starts: tuple[int, ...]
    key: tuple[int, str]
    kind = "patrol"

    @property
    def places(self) -> Points:  # type: ignore[override]
        """Return the places of the graph, (V, 2) m."""
        return self.graph.places

    @property
    def bound_for(self) -> tuple[int, ...]:  # type: ignore[override]
        """Return where robots go from their starts."""
        return self._begin()[0]

    def begin(self) -> NextPlace:
        """Begin an episode."""
        return self._begin()[1]

    def _begin(self) -> tuple[tuple[int, ...], NextPlace]:
        choose = self.strategy.begin(self.graph, self.starts, random_generator(*self.key, "patrol"))
        seen = np.zeros(len(self.graph))  # s, when a robot was there last; the episode begins as if all had been seen
        at: dict[int, int] = {robot: choose(robot, start, seen.copy()) for robot, start in enumerate(self.starts)}

        def next_place(robot: int, stamp: float) -> int:
            seen[at[robot]] = stamp
            at[robot] = choose(robot, at[robot], stamp - seen)
            return at[robot]

        return tuple(at.values()), next_place


@dataclass(frozen=True, slots=True)
class GraphRules:
    """``graph`` is a mapping with ``places`` and ``edges``; None: one over the free space, with places about
    ``spacing`` m apart and ``margin`` m more off walls than the robot's radius.
    """

    graph: dict[str, Any] | None
    spacing: Positive
    margin: NonNegative


class PatrolTask(TaskMode):
    """Scenario ``index`` has ``team`` robots at places of the graph that are drawn; a strategy sends them on."""

    def __init__(
        self,
        robot: Robot,
        world: WorldSource,
        rules: Annotated[TeamRules, Flat()],
        strategy: PatrolStrategy,
        over: Annotated[GraphRules, Flat()],
    ) -> None:
        self._robot, self._world, self._rules, self._strategy = robot, world, rules, strategy
        self._graph = None if over.graph is None else read_graph(over.graph, "task.graph")
        self._spacing, self._clearance = over.spacing, robot.footprint.radius + over.margin

    def robots(self) -> int:
        """Return the number of robots that patrol."""
        return self._rules.team

    def scenario(self, seed: int, index: int) -> Scenario:
        """Return the patrol of an index; raise ImpossibleScenario where the graph has too few places, or no room."""
        name, world = f"patrol/{index:04d}", self._world.world(seed, index)
        graph = self._graph_of(name, world.grid)
        if len(graph) < max(self._rules.team, 2):
            raise ImpossibleScenario(
                f"{name}: {self._rules.team} robots patrol {len(graph)} places of {world.name}; allowed: as many "
                "places and more, with a smaller task.spacing, or fewer robots"
            )
        drawn = random_generator(seed, name, "team").permutation(len(graph))[: self._rules.team]
        rounds = Rounds(graph, self._strategy, tuple(drawn.tolist()), (seed, name))
        ways = ways_of(graph.places, rounds.starts, rounds.bound_for)
        check_room(name, world.grid, [(start, start) for start, _ in ways], self._robot)
        return self._rules.scenario(name, seed, world, ways, rounds)

    def _graph_of(self, name: str, grid: OccupancyGrid) -> PatrolGraph:
        if self._graph is None:
            return grid.derive(GraphOfFreeSpace(self._spacing, self._clearance))
        check_places(name, self._graph.places, grid, self._robot.footprint.radius)
        return self._graph


def ways_of(places: Points, starts: Sequence[int], goals: Sequence[int]) -> list[tuple[Pose, Pose]]:
    """Return start and first goal of each robot, which heads for it."""
    ways = []
    for start, goal in zip(starts, goals, strict=True):
        (x, y), (goal_x, goal_y) = places[start].tolist(), places[goal].tolist()
        heading = math.atan2(goal_y - y, goal_x - x)
        ways.append((Pose(x, y, heading), Pose(goal_x, goal_y, heading)))
    return ways
