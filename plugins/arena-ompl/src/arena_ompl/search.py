"""One query put to OMPL: its space, checks and costs, and an end by count."""

from __future__ import annotations

import heapq
import math
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from ompl import base, util

from arena_ompl.algorithms import BATCHES, ROADMAPS, Algorithm, make_planner
from arena_ompl.curves import DUBINS, STRAIGHT
from arena_ompl.motions import Motions, Poses

_AS_SHORT = 1.0 + 1e-6  # of the shortest way: some planners never return when they look for what would be shorter still

XYTheta = tuple[float, float, float]
Read = Callable[[Any], XYTheta]

_PER_SAMPLE = {True: 100, False: 4}  # evaluations of FMT, at least, when motions are priced and when they are not
_BACKSTOP = 20  # times the evaluations: where FMT ends if it does not by itself


@dataclass(frozen=True, slots=True)
class Query:
    """What to search for: a way from a start to any of some goals, in a box."""

    start: XYTheta
    goals: tuple[XYTheta, ...]
    low: tuple[float, float]
    high: tuple[float, float]


@dataclass(frozen=True, slots=True)
class Effort:
    """How to search: see ``OmplPlanner``."""

    algorithm: Algorithm
    evaluations: int
    motion_range: float | None
    priced: bool


def find_path(motions: Motions, query: Query, effort: Effort, seed: int) -> Poses | None:
    """Return the states (K, 3) of a path from the start to a goal, None if the search ended without."""
    for goal in query.goals:
        if _needs_no_search(motions, query.start, goal, effort.algorithm):
            return np.array((query.start, goal))
    with _silence_ompl():
        util.RNG.setSeed(seed)  # before any OMPL object is made: each draws its own seed from this one when it is made
        space, read = _state_space(motions, query)
        information = _space_information(space, read, motions)
        problem = _problem_definition(space, information, read, motions, query, priced=effort.priced)
        planner = make_planner(
            effort.algorithm, information, effort.evaluations // _PER_SAMPLE[effort.priced], effort.motion_range
        )
        planner.setProblemDefinition(problem)
        planner.setup()
        last = effort.evaluations * (_BACKSTOP if effort.algorithm in BATCHES else 1)
        end = base.PlannerTerminationCondition(lambda: motions.evaluations >= last)
        if effort.algorithm in ROADMAPS:
            return _roadmap_path(planner, information, end, read, motions)
        planner.solve(end)
        if not problem.hasExactSolution():
            return None
        path = np.array([read(state) for state in problem.getSolutionPath().getStates()])
        return path if _is_path_free(motions, path) else None


def _is_path_free(motions: Motions, path: Poses) -> bool:
    """Return whether every motion of a path is free: a tree that grew from the goal may have been
    checked the wrong way round.
    """
    states = path.tolist()
    return all(motions.can_move(first, second) for first, second in pairwise(states))


def _needs_no_search(motions: Motions, start: XYTheta, goal: XYTheta, algorithm: Algorithm) -> bool:
    """Return whether the shortest curve to a goal is the best path: free, and nowhere near an obstacle.

    AORRTC looks for the shortest path alone, and loses its start when that is a single motion.
    """
    length = math.dist(start[:2], goal[:2])
    return motions.can_move(start, goal) and (algorithm == "aorrtc" or motions.cost(start, goal) <= _AS_SHORT * length)


@contextmanager
def _silence_ompl() -> Iterator[None]:
    """Keep OMPL from writing to the terminal."""
    level = util.getLogLevel()
    util.setLogLevel(util.LOG_NONE)
    try:
        yield
    finally:
        util.setLogLevel(level)


def _state_space(motions: Motions, query: Query) -> tuple[Any, Read]:
    """Return the state space of the robot's curves, and how to read a state of it."""
    kind, radius = motions.rules.kind, motions.rules.radius
    bounds = base.RealVectorBounds(2)
    for axis in range(2):
        bounds.setLow(axis, query.low[axis])
        bounds.setHigh(axis, query.high[axis])
    if kind == STRAIGHT:
        space = base.RealVectorStateSpace(2)
    else:
        space = base.DubinsStateSpace(radius) if kind == DUBINS else base.ReedsSheppStateSpace(radius)
    space.setBounds(bounds)
    return space, _read_point if kind == STRAIGHT else _read_pose


def _read_point(state: Any) -> XYTheta:
    return state[0], state[1], 0.0


def _read_pose(state: Any) -> XYTheta:
    return state.getX(), state.getY(), state.getYaw()


def _space_information(space: Any, read: Read, motions: Motions) -> Any:
    information = base.SpaceInformation(space)
    information.setStateValidityChecker(lambda state: motions.is_free(*read(state)))
    information.setMotionValidator(_MotionCheck(information, read, motions))
    information.setup()
    return information


def _problem_definition(
    space: Any, information: Any, read: Read, motions: Motions, query: Query, *, priced: bool
) -> Any:
    problem = base.ProblemDefinition(information)
    start, ends = _make_state(space, query.start), [_make_state(space, goal) for goal in query.goals]
    problem.addStartState(start)
    goals = base.GoalStates(information)
    for end in ends:
        goals.addState(end)
    problem.setGoal(goals)
    objective = (
        _CostObjective(information, read, motions) if priced else base.PathLengthOptimizationObjective(information)
    )
    objective.setCostThreshold(base.Cost(_AS_SHORT * min(space.distance(start, end) for end in ends)))
    problem.setOptimizationObjective(objective)
    return problem


def _make_state(space: Any, pose: XYTheta) -> Any:
    state = space.allocState()
    if isinstance(space, base.RealVectorStateSpace):
        state[0], state[1] = pose[:2]
    else:
        state.setXY(*pose[:2])
        state.setYaw(math.remainder(pose[2], 2.0 * math.pi))
    return state


class _MotionCheck(base.MotionValidator):  # type: ignore[misc]
    """Asks one kernel about a whole motion."""

    def __init__(self, information: Any, read: Read, motions: Motions) -> None:
        super().__init__(information)
        self._read, self._motions = read, motions

    def checkMotion(self, first: Any, second: Any) -> bool:
        """Return whether the motion between two states is free."""
        return self._motions.can_move(self._read(first), self._read(second))


class _CostObjective(base.PathLengthOptimizationObjective):  # type: ignore[misc]
    """Prices motions by length and nearness to obstacles; a length alone never costs more."""

    def __init__(self, information: Any, read: Read, motions: Motions) -> None:
        super().__init__(information)
        self._read, self._motions, self._distance = read, motions, information.distance

    def motionCost(self, first: Any, second: Any) -> Any:
        """Return what a motion costs."""
        return base.Cost(self._motions.cost(self._read(first), self._read(second)))

    def motionCostHeuristic(self, first: Any, second: Any) -> Any:
        """Return what a motion costs at least."""
        self._motions.evaluations += 1
        return base.Cost(self._distance(first, second))


def _roadmap_path(planner: Any, information: Any, end: Any, read: Read, motions: Motions) -> Poses | None:
    """Grow a roadmap, join start and goals to it, and return the cheapest way on it.

    OMPL's own query looks for the way in a second thread, and grows and expands in turns by the clock: no two runs
    would agree.
    """
    planner.growRoadmapPtc(end)
    planner.solve(base.plannerAlwaysTerminatingCondition())
    roadmap = base.PlannerData(information)
    planner.getPlannerData(roadmap)
    states = [read(roadmap.getVertex(i).getState()) for i in range(roadmap.numVertices())]
    goals = {roadmap.getGoalIndex(i) for i in range(roadmap.numGoalVertices())}
    start = roadmap.getStartIndex(0)
    chain = _cheapest_chain(
        start, goals, lambda i: [(j, motions.cost(states[i], states[j])) for j in roadmap.getEdges(i)]
    )
    path = None if chain is None else np.array([states[i] for i in chain])
    return path if path is not None and _is_path_free(motions, path) else None


def _cheapest_chain(start: int, goals: set[int], edges: Callable[[int], list[tuple[int, float]]]) -> list[int] | None:
    """Return the vertices of the cheapest way (Dijkstra), None if there is none."""
    queue = [(0.0, start, start)]
    before: dict[int, int] = {}
    while queue:
        cost, vertex, previous = heapq.heappop(queue)
        if vertex in before:
            continue
        before[vertex] = previous
        if vertex in goals:
            chain = [vertex]
            while chain[-1] != start:
                chain.append(before[chain[-1]])
            return chain[::-1]
        for other, price in edges(vertex):
            if other not in before:
                heapq.heappush(queue, (cost + price, other, vertex))
    return None
