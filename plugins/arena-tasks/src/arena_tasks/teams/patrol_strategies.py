"""Strategies of patrols, as Portugal and Rocha compare them: Conscientious Reactive, and all along one cycle."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from arena_core.tasks import PatrolGraph, PatrolStrategy
from arena_tasks.teams.patrol_graph import ways_between

Points = NDArray[np.float64]

Patroller = Callable[[int, int, Points], int]


class ConscientiousReactive(PatrolStrategy):
    """Each robot goes to the neighbour of its place that has been idle longest; of equal ones to any.

    The idleness is known to all, as in patrolling_sim, where robots tell each other of their visits (D. Portugal and R.
    P. Rocha, Distributed multi-robot patrol: A scalable and fault-tolerant framework, Robotics and Autonomous Systems
    61, 2013; the strategy is that of A. Machado et al., Multi-agent patrolling, MABS 2002).
    """

    def begin(self, graph: PatrolGraph, starts: Sequence[int], random: np.random.Generator) -> Patroller:
        """Begin an episode."""

        def next_place(robot: int, at: int, idleness: Points) -> int:
            neighbours = np.flatnonzero(np.isfinite(graph.lengths[at]))
            waits = idleness[neighbours]
            return int(random.choice(neighbours[waits >= waits.max() - 1e-9]))

        return next_place


class Cyclic(PatrolStrategy):
    """All robots go round one cycle through all places, in the same sense, each from where it stands.

    The cycle is short: the nearest place not yet on it comes next, then parts are turned round as long as that shortens
    it (2-opt), by the lengths of ways along the graph (Y. Chevaleyre, Theoretical analysis of
    the multi-agent patrolling problem, IAT 2004). Where places that follow each other are no neighbours, what lies
    between is visited on the way.
    """

    def begin(self, graph: PatrolGraph, starts: Sequence[int], random: np.random.Generator) -> Patroller:
        """Begin an episode."""
        lengths, ahead = ways_between(graph)
        walk = _along_graph(_shorten(_nearest_first(lengths), lengths), ahead)
        after = {robot: walk.index(start) for robot, start in enumerate(starts)}

        def next_place(robot: int, at: int, idleness: Points) -> int:
            after[robot] = (after[robot] + 1) % len(walk)
            return walk[after[robot]]

        return next_place


def _nearest_first(lengths: Points) -> list[int]:
    """Return a cycle on which the nearest place that is not yet on it comes next."""
    cycle, left = [0], set(range(1, len(lengths)))
    while left:
        cycle.append(min(left, key=lambda place: (lengths[cycle[-1], place], place)))
        left.remove(cycle[-1])
    return cycle


def _shorten(cycle: list[int], lengths: Points) -> list[int]:
    """Return a cycle that no part turned round makes shorter."""
    shortens, count = True, len(cycle)
    while shortens:
        shortens = False
        for i in range(count - 1):
            for j in range(i + 2, count - (i == 0)):
                a, b, c, d = cycle[i], cycle[i + 1], cycle[j], cycle[(j + 1) % count]
                if lengths[a, c] + lengths[b, d] < lengths[a, b] + lengths[c, d] - 1e-9:
                    cycle[i + 1 : j + 1] = cycle[i + 1 : j + 1][::-1]
                    shortens = True
    return cycle


def _along_graph(cycle: list[int], ahead: Points) -> list[int]:
    """Return a cycle with the places between those that are no neighbours."""
    walk: list[int] = []
    for one, two in zip(cycle, [*cycle[1:], cycle[0]], strict=True):
        way = [two]
        while way[0] != one:
            way.insert(0, int(ahead[one, way[0]]))
        walk += way[:-1]
    return walk
