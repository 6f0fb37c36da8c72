"""Ways for all robots of a team: one after the other, each among those that have theirs (prioritised planning).

Erdmann and Lozano-Perez 1987; a robot that finds no way is moved to the front (Bennewitz, Burgard and Thrun 2001).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from arena_core import Footprint
from arena_core.hosting import TeamTruth
from arena_reference.arrays import Floats
from arena_reference.body import Walkers
from arena_reference.doors import cover_outline
from arena_reference.outlook import start_state
from arena_reference.ways import SAME, Attempt, Way, WayFinder, join_walks, rehearse

WAIT = 4.0  # s more for each teammate, for which people's future is looked at
STOP = 2.0  # s within which a robot that has arrived stands
HELD = (0.0, 3.0, 8.0)  # s for which those that have no way yet count as standing where they are, one try after another


@dataclass(frozen=True, slots=True, eq=False)
class TeamWays:
    """Ways that were searched at ``stamp`` s for all robots of a team, in their order; none where not all have one."""

    stamp: float
    ways: tuple[Way, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Team:
    """The truth of each robot of a team, the finder of its ways, and the discs that cover it: their centres (D, 2) in
    ``base_link`` m and radius, m.
    """

    truths: Sequence[TeamTruth]
    finders: Sequence[WayFinder]
    discs: Sequence[tuple[Floats, float]]

    @classmethod
    def of(cls, truths: Sequence[TeamTruth], finders: Sequence[WayFinder]) -> Team:
        """Return a team of robots and their finders."""
        return cls(truths, finders, [discs_of(truth.robot.footprint) for truth in truths])

    def horizon(self) -> float:
        """Return for how many seconds from now people's future is worth to know."""
        longest = max(finder.horizon(truth) for truth, finder in zip(self.truths, self.finders, strict=True))
        left = self.truths[0].scenario.time_limit - self.truths[0].state().stamp
        return min(longest + WAIT * (len(self.truths) - 1), left)

    def order(self) -> list[int]:
        """Return the robots in the order in which they are led first: who has the longest way goes ahead."""
        ways = [truth.state().pose.distance(truth.scenario.goal) for truth in self.truths]
        return sorted(range(len(ways)), key=lambda robot: (-ways[robot], robot))


def discs_of(footprint: Footprint) -> tuple[Floats, float]:
    """Return the centres (D, 2) and the radius, m, of discs that cover a footprint."""
    if len(footprint.vertices_xy) == 0:
        return np.zeros((1, 2)), float(footprint.radius)
    return cover_outline(np.asarray(footprint.vertices_xy, np.float64))


def find_together(team: Team, future: Walkers, tries: int) -> tuple[Way, ...]:
    """Return a way for each robot, driven together in a fork of the world without touching anything; none if not
    all of them have one.

    ``future`` is that of people without the robots. ``tries`` orders of the robots are tried in each attempt; where
    people react to the robots, they are tried among people as they walked beside them.
    """
    for attempt in range(len(team.finders[0].attempts)):
        people, order = future, team.order()
        for number in range(tries):
            ways = find_in_order(team, order, people, attempt, HELD[number % len(HELD)])
            stuck = order[len(ways)] if len(ways) < len(order) else -1
            if stuck < 0:
                found = tuple(ways[robot] for robot in range(len(order)))
                tried = rehearse(team.truths[0], *found)
                if tried.touched == math.inf:
                    return found
                again = join_walks(people, tried.walked)
                if np.nanmax(np.abs(again.positions - people.positions), initial=0.0) >= SAME:
                    people = again
                    continue
                stuck = tried.robot
            order = [stuck, *(robot for robot in order if robot != stuck)]
    return ()


def find_in_order(team: Team, order: Sequence[int], people: Walkers, attempt: int, held: float) -> dict[int, Way]:
    """Return the ways of robots in this order, up to the first that finds none among people, those before it, and those
    after it, which stand where they are for ``held`` s.
    """
    ways = dict[int, Way]()
    for place, robot in enumerate(order):
        truth, finder = team.truths[robot], team.finders[robot]
        among = with_waiting(team, order[place + 1 :], people, held)
        way = stand_at_goal(truth, finder) or find_way(truth, finder, among, finder.attempts[attempt])
        if way is None:
            break
        ways[robot] = way
        people = beside(people, walk_of(truth, finder, way, people, team.discs[robot][0]), team.discs[robot][1])
    return ways


def with_waiting(team: Team, robots: Sequence[int], people: Walkers, held: float) -> Walkers:
    """Return people, and these robots, which stand where they are for ``held`` s and are then gone."""
    if held <= 0.0:
        return people
    gone = people.period * np.arange(len(people.positions)) > held
    for robot in robots:
        truth, finder, (centres, radius) = team.truths[robot], team.finders[robot], team.discs[robot]
        standing = Way(np.zeros((0, 3)), start_state(truth)[None], people.start, finder.control_period, arrives=False)
        walk = walk_of(truth, finder, standing, people, centres)
        walk[gone] = np.nan
        people = beside(people, walk, radius)
    return people


def find_way(truth: TeamTruth, finder: WayFinder, people: Walkers, attempt: Attempt) -> Way | None:
    """Return a robot's way to its goal, or None."""
    way = finder.find(truth, people, attempt)
    return way if way is not None and way.arrives else None


def stand_at_goal(truth: TeamTruth, finder: WayFinder) -> Way | None:
    """Return the way of a robot that has arrived, which stands; None of one that has not."""
    state = truth.state()
    if state.pose.distance(truth.scenario.goal) > truth.scenario.goal_radius:
        return None
    return Way(np.zeros((0, 3)), start_state(truth)[None], state.stamp, finder.control_period, arrives=True)


def walk_of(truth: TeamTruth, finder: WayFinder, way: Way, people: Walkers, centres: Floats) -> Floats:
    """Return where the discs of a robot will be at the instants of ``people``, (K, D, 2): on its way, then standing."""
    stands = np.zeros((math.ceil(STOP / way.period), 3))
    after = finder.unroll(way.states[-1], stands, truth.scenario.speed_share)
    states = np.concatenate((way.states, after[1:]))
    stamps = way.start + way.period * np.arange(len(states))
    instants = people.start + people.period * np.arange(len(people.positions))
    x, y, theta = (np.interp(instants, stamps, values) for values in (*states[:, :2].T, np.unwrap(states[:, 2])))
    c, s = np.cos(theta)[:, None], np.sin(theta)[:, None]
    return np.stack(
        (
            x[:, None] + c * centres[:, 0] - s * centres[:, 1],
            y[:, None] + s * centres[:, 0] + c * centres[:, 1],
        ),
        axis=-1,
    )


def beside(people: Walkers, walk: Floats, radius: float) -> Walkers:
    """Return people, and discs of this radius, m, that ``walk`` (K, D, 2)."""
    positions = np.ascontiguousarray(np.concatenate((people.positions, walk), axis=1))
    return Walkers(positions, np.append(people.radii, np.full(walk.shape[1], radius)), people.start, people.period)
