"""From numbers to a problem: where the robot starts and goes, and who walks across its way, where and when."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from arena_break.bounds import OWN_GENES, PERSON_GENES, PeopleBounds, SearchBounds
from arena_core import ConfigurationError, PedestrianSpec, Pose, Robot, World
from arena_core.scenes import add_furniture
from arena_tasks.random.free_space import FreeSpace
from arena_tasks.random.route import find_route
from arena_tasks.scenario_files.problem import Keys, Problem

Floats = NDArray[np.float64]
STEP = 0.05  # m between two places of a person's way that are looked at
AHEAD = 0.5  # m along the robot's way that say which way it runs
TURNS = tuple(math.radians(15.0 * ((k + 1) // 2) * (-1) ** k) for k in range(24))  # 0, -15, 15, -30 ... 180 degrees
DIGITS = 3  # of a metre: what a file keeps


@dataclass(frozen=True, slots=True, eq=False)
class Draft:
    """A problem and the robot's likely way in it, (M, 2) m."""

    problem: Problem
    route: Floats


class Course:
    """The ground of one world for one robot, on which problems are laid out.

    Raises ConfigurationError where no start and goal are as far apart as the bounds want.
    """

    def __init__(self, world: World, robot: Robot, bounds: SearchBounds) -> None:
        self.world, self.robot, self.bounds = world, robot, bounds
        self._space = add_furniture(world).derive(FreeSpace)
        radius = robot.footprint.radius
        self._passage = radius + bounds.robot.passage
        places = self._space.places(max(radius + bounds.robot.clearance, self._passage))
        regions = self._space.regions(self._passage)[tuple(self._space.grid.cells(places).T)] if len(places) else ()
        self._places = places[regions == np.bincount(regions).argmax()] if len(places) else places
        box = self._places if len(self._places) else np.zeros((1, 2))
        self._low, self._high = np.asarray(box.min(axis=0)), np.asarray(box.max(axis=0))
        if float(np.hypot(*(self._high - self._low))) < bounds.robot.min_distance:
            raise ConfigurationError(
                f"world is {world.name}, in which {robot.name} has no start and goal {bounds.robot.min_distance:g} m "
                "apart; allowed: a larger world, or bounds=FILE with a lower robot.min_distance"
            )

    def draft(self, genes: Floats, name: str) -> Draft | None:
        """Return the problem that some numbers 0 .. 1 describe, None where there is no room for it.

        Five are of the robot: where it starts (2), in which direction and how far away its goal is, how many people
        there are. Six are of each person: where it meets the robot's way, at which angle, how far it walks before and
        behind, how fast, and how much sooner or later than the robot it comes there.
        """
        start = self._nearest(self._places, self._low + genes[:2] * (self._high - self._low))
        goal = self._goal(start, genes[2], genes[3])
        if goal is None:
            return None
        route = find_route(self._space.grid, self._passage, start, goal)
        if len(route) < 2:
            return None
        people = self._people(genes, start, goal, route)
        if not people:
            return None
        heading = math.atan2(*(_along(route, AHEAD) - start)[::-1])
        limits = self.bounds.robot
        time_limit = limits.time_spare + limits.time_share * _length(route) / self._pace
        problem = Problem(
            name=name,
            start=Pose(*_rounded((*start, heading))),
            goal=Pose(*_rounded((*goal, 0.0))),
            pedestrians=tuple(people),
            obstacles=(),
            goal_radius=None,
            time_limit=float(math.ceil(time_limit)),
            keys=Keys("start", "goal", tuple(f"pedestrians[{i}]" for i in range(len(people)))),
            furniture=self.world.furniture,
        )
        return Draft(problem, route)

    @property
    def _pace(self) -> float:
        """Return how fast the robot is expected to come along its way, m/s."""
        return self.bounds.robot.pace * self.robot.limits.vx_max

    def _goal(self, start: Floats, turn: float, far: float) -> Floats | None:
        away = np.hypot(*(self._places - start).T)
        limits = self.bounds.robot
        there = self._places[(away >= limits.min_distance) & (away <= limits.max_distance)]
        if not len(there):
            return None
        angle, reach = 2.0 * math.pi * turn, limits.min_distance + far * (limits.max_distance - limits.min_distance)
        return self._nearest(there, start + reach * np.array((math.cos(angle), math.sin(angle))))

    def _nearest(self, places: Floats, wanted: Floats) -> Floats:
        return np.asarray(places[((places - wanted) ** 2).sum(axis=1).argmin()])

    def _people(self, genes: Floats, start: Floats, goal: Floats, route: Floats) -> list[PedestrianSpec]:
        limits = self.bounds.people
        count = 1 + min(int(genes[4] * limits.most), limits.most - 1)
        found: list[PedestrianSpec] = []
        for own in genes[OWN_GENES : OWN_GENES + PERSON_GENES * count].reshape(count, PERSON_GENES):
            person = self._person(own, (start, goal), route, len(found))
            if person is not None and _is_apart(person, found, limits, start):
                found.append(person)
        return found

    def _person(self, genes: Floats, ends: tuple[Floats, Floats], route: Floats, number: int) -> PedestrianSpec | None:
        """Return a person who walks to and fro on a straight way that crosses the robot's, None where there is none."""
        limits = self.bounds.people
        room = limits.keep_off + STEP  # no one walks nearer to the ends of the robot's way
        along = room + genes[0] * max(_length(route) - 2.0 * room, 0.0)
        place = _along(route, along)
        ahead = _along(route, along + AHEAD) - _along(route, along - AHEAD)
        angle = math.atan2(ahead[1], ahead[0]) + math.pi * (2.0 * genes[1] - 1.0)
        wanted = limits.reach_min + genes[2:4] * (limits.reach_max - limits.reach_min)
        found = self._stretch(place, angle, wanted, ends)
        if found is None:
            return None
        direction, before, behind = found
        speed = limits.slowest + genes[4] * (limits.fastest - limits.slowest)
        moment = max(along / self._pace + limits.moment * (2.0 * genes[5] - 1.0), limits.soonest)
        first, last = place - before * direction, place + behind * direction
        walked, length = (before - speed * moment) % (2.0 * (before + behind)), before + behind
        onwards = walked <= length
        position = first + (walked if onwards else 2.0 * length - walked) * direction
        waypoints = (last, first) if onwards else (first, last)
        return PedestrianSpec(
            id=number,
            position_xy=np.array(_rounded(position)),
            waypoints_xy=np.array([_rounded(point) for point in waypoints]),
            desired_speed=_rounded((speed,))[0],
            radius=limits.radius,
            behaviour={},
        )

    def _stretch(
        self, place: Floats, angle: float, reach: Floats, ends: tuple[Floats, Floats]
    ) -> tuple[Floats, float, float] | None:
        """Return the direction of a straight way through a place, as near to ``angle`` as it has room, and how far it
        goes on before and behind the place, m; None where there is no room.
        """
        for turn in TURNS:
            direction = np.array((math.cos(angle + turn), math.sin(angle + turn)))
            before, behind = (
                self._free_length(place, sign * direction, most, ends)
                for sign, most in zip((-1.0, 1.0), reach, strict=True)
            )
            if min(before, behind) >= self.bounds.people.reach_min:
                return direction, before, behind
        return None

    def _free_length(self, place: Floats, direction: Floats, reach: float, ends: tuple[Floats, Floats]) -> float:
        """Return how far a person can walk from a place in a direction, m, at most ``reach``."""
        limits = self.bounds.people
        lengths = np.arange(0.0, reach + 0.5 * STEP, STEP)
        points = place + lengths[:, None] * direction
        free = self._space.has_room(points, limits.clearance)
        for end in ends:
            free &= np.hypot(*(points - end).T) >= limits.keep_off
        return 0.0 if not free[0] else float(lengths[-1] if free.all() else lengths[int(free.argmin()) - 1])


def without_person(problem: Problem, index: int, name: str) -> Problem:
    """Return a problem without one of its people, under another name."""
    from dataclasses import replace

    left = [person for i, person in enumerate(problem.pedestrians) if i != index]
    people = tuple(replace(person, id=i) for i, person in enumerate(left))
    return replace(problem, name=name, pedestrians=people, keys=replace(problem.keys, people=problem.keys.people[:-1]))


def place_along(route: Floats, position: Sequence[float]) -> float:
    """Return how far along a way (M, 2) a position is, 0 .. 1."""
    nearest = int(((route - np.asarray(position)) ** 2).sum(axis=1).argmin())
    return nearest / max(len(route) - 1, 1)


def _is_apart(person: PedestrianSpec, others: Sequence[PedestrianSpec], limits: PeopleBounds, start: Floats) -> bool:
    """Return whether a person begins far enough from the robot and from others."""
    if float(np.hypot(*(person.position_xy - start))) < limits.spawn_distance:
        return False
    return all(float(np.hypot(*(person.position_xy - one.position_xy))) >= limits.apart for one in others)


def _lengths(route: Floats) -> Floats:
    return np.concatenate(((0.0,), np.hypot(*np.diff(route, axis=0).T).cumsum()))


def _length(route: Floats) -> float:
    return float(_lengths(route)[-1])


def _along(route: Floats, length: float) -> Floats:
    """Return the place (2,) so far along a way."""
    lengths = _lengths(route)
    return np.array([np.interp(length, lengths, route[:, k]) for k in (0, 1)])


def _rounded(values: Sequence[float] | Floats) -> list[float]:
    return [round(float(value), DIGITS) for value in values]
