"""Ways to the goal that the robot can drive among people whose future is known: searched, unrolled, tried in forks."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from arena_core import Robot
from arena_core.hosting import Truth
from arena_core.parameters import NonNegative, Positive, PositiveInt
from arena_kernels.compiled import compiled
from arena_kernels.motion import Chassis, chassis_of, drive_arc, next_velocity
from arena_reference.arrays import Floats
from arena_reference.body import Moving, Walkers, body_of
from arena_reference.doors import longest_wait, with_doors
from arena_reference.outlook import (
    Grounds,
    Site,
    fastest,
    part_of,
    start_state,
    stride_time,
    walkers_in_cells,
)
from arena_reference.search import Grain, Problem, look_ahead, search
from arena_reference.times import times_left
from arena_reference.values import Course

TICK = 0.01  # s, in which ways are driven when they are searched
LONGEST_SPAN, SHORTEST_SPAN, SPAN_WAY = 0.5, 0.2, 0.5  # s for which a command is held; m that are driven meanwhile
SLACK, SPARE = 1.4, 10.0  # of the time among what stands, and s more: for so long people's future is looked at
INSIDE = 1e-3  # m that a way ends within the goal's rim
SAME = 1e-6  # m by which people may walk elsewhere and yet do the same


@dataclass(frozen=True, slots=True)
class Attempt:
    """How a way is searched: on cells of this size (m), with so many states side by side, that far (m) from what stands
    and from people.
    """

    cell: Positive
    width: PositiveInt
    walls: NonNegative
    people: NonNegative


@dataclass(frozen=True, slots=True)
class SearchSettings:
    """How ways are searched: the ``attempts``, one after the other, and how high the robot is, m: furniture above it
    is no obstacle.
    """

    attempts: list[Attempt]
    robot_height: NonNegative


@dataclass(frozen=True, slots=True, eq=False)
class Way:
    """Commands (N, 3) for N control periods in a row from ``start`` s on, and the states (N + 1, 6) about them;
    ``arrives`` where it ends at the goal.
    """

    commands: Floats
    states: Floats
    start: float
    period: float
    arrives: bool

    @property
    def arrival(self) -> float:
        """Return when the way ends, s."""
        return self.start + self.period * len(self.commands)


class WayFinder:
    """Searches ways for one robot; it keeps the grounds of the newest problem."""

    def __init__(self, robot: Robot, settings: SearchSettings, control_period: float) -> None:
        self.robot, self.attempts, self.control_period = robot, settings.attempts, control_period
        self._body, self._chassis = body_of(robot.footprint), chassis_of(robot)
        self.site = Site(settings.robot_height)

    def horizon(self, truth: Truth) -> float:
        """Return for how many seconds from now people's future is worth to know."""
        attempt, limit = self.attempts[0], truth.scenario.time_limit - truth.state().stamp
        _, step, steps = self._look_around(truth, attempt)
        wait = longest_wait(truth.scenario.doors, truth.state().stamp)
        return min(SLACK * steps * step + SPARE + wait, limit) if math.isfinite(steps) else 0.0

    def _look_around(self, truth: Truth, attempt: Attempt) -> tuple[Grounds, float, float]:
        """Return the ground as a disc sees it, how long a step over it takes, s, and how many are left to the goal."""
        scenario, pose = truth.scenario, truth.state().pose
        room = self.robot.footprint.half_width + attempt.walls
        grounds = self.site.grounds(scenario, attempt.cell, room, scenario.goal_radius - INSIDE)
        step = stride_time(grounds.terrain, fastest(self.robot, scenario.speed_share))
        return grounds, step, grounds.steps_from(pose)

    def find(self, truth: Truth, people: Walkers, attempt: Attempt, *, open_end: bool = False) -> Way | None:
        """Return a way from where the robot is now to the goal among people who walk like that, or None.

        With an ``open_end`` it need not lead farther than people are known. A door stands in the way while its
        timetable has it closed.
        """
        scenario, now = truth.scenario, people.start
        grounds, step, left = self._look_around(truth, attempt)
        if left == math.inf:
            return None
        if scenario.doors:
            people = with_doors(people, scenario.doors, truth.state().doors_open[: len(scenario.doors)].tolist())
        terrain, speed = grounds.terrain, fastest(self.robot, scenario.speed_share)
        until = people.period * (len(people.positions) - 1)
        steps = max(1, math.ceil(until / step))
        walkers = walkers_in_cells(terrain, people)
        radii = walkers.radii + (self.robot.footprint.half_width + attempt.people) / terrain.cell
        instants = now + step * np.arange(steps + 1, dtype=np.float64)
        course = Course(grounds.free, grounds.goal, instants, Moving(walkers, radii, speed / terrain.cell))
        reach = math.ceil((self._span(scenario.speed_share) * self.control_period + look_ahead(step)) / step) + 2
        problem = Problem(
            terrain,
            people,
            self._body,
            self._chassis,
            scenario.speed_share,
            times_left(course, grounds.left, reach),
            now,
            step,
            scenario.goal.x,
            scenario.goal.y,
            scenario.goal_radius - INSIDE,
            attempt.walls,
            attempt.people,
        )
        return self._search(problem, attempt.width, start_state(truth), until, open_end=open_end)

    def _span(self, share: float) -> int:
        """Return for how many control periods a command is held."""
        speed = fastest(self.robot, share)
        return max(1, round(min(LONGEST_SPAN, max(SHORTEST_SPAN, SPAN_WAY / speed)) / self.control_period))

    def _search(self, problem: Problem, width: int, state: Floats, until: float, *, open_end: bool) -> Way | None:
        speed = fastest(self.robot, problem.share)
        periods = self._span(problem.share)
        ticks = round(self.control_period / TICK)
        look = ticks if speed < 0.5 else max(1, ticks // 2)
        levels = max(1, math.ceil(until / (periods * self.control_period)))
        grain = Grain(width, periods, ticks, TICK, look, 2, levels, open_end)
        commands, _, arrival = search(problem, grain, state, problem.start)
        if not len(commands):
            return None
        count = len(commands) * periods
        if math.isfinite(arrival):
            count = round((arrival - problem.start) / self.control_period)
        held = np.repeat(commands, periods, axis=0)[:count]
        states = self.unroll(state, held, problem.share)
        return Way(held, states, problem.start, self.control_period, math.isfinite(arrival))

    def unroll(self, state: Floats, commands: Floats, share: float) -> Floats:
        """Return the states (N + 1, 6) at the ends of N control periods with these commands, from ``state`` (6,) on,
        with a ``share`` of the robot's speed limits.
        """
        return unroll(self._chassis, share, state, commands, round(self.control_period / TICK))


@compiled
def unroll(chassis: Chassis, share: float, state: Floats, commands: Floats, ticks: int) -> Floats:
    """Return the states (N + 1, 6) at the ends of N control periods of ``ticks`` ticks, from ``state`` (6,) on."""
    states = np.empty((len(commands) + 1, 6))
    states[0] = state
    pose, velocity = (state[0], state[1], state[2]), (state[3], state[4], state[5])
    for i in range(len(commands)):
        for _ in range(ticks):
            velocity = next_velocity(chassis, share, velocity, commands[i], TICK)
            pose = drive_arc(pose, velocity, TICK)
        states[i + 1, 0], states[i + 1, 1], states[i + 1, 2] = pose
        states[i + 1, 3], states[i + 1, 4], states[i + 1, 5] = velocity
    return states


@dataclass(frozen=True, slots=True, eq=False)
class Rehearsal:
    """What comes of ways in a fork of their world: when something was touched first (s, inf: never), by which robot,
    and where people then walked, (K, P, 2) as ``Walkers`` have it.
    """

    touched: float
    robot: int
    walked: Floats


def rehearse(truth: Truth, *ways: Way) -> Rehearsal:
    """Drive ways in a fork of the world, one for each robot in it, until something is touched, or the last one ends;
    who is at the end of its own stands.
    """
    fork, whole = truth.fork(), ways[0].period
    period = part_of(whole)
    ticks = round(period / fork.inner_step)
    commands = np.zeros((max(len(way.commands) for way in ways), len(ways), 3))
    for robot, way in enumerate(ways):
        commands[: len(way.commands), robot] = way.commands
    snapshot = fork.advance(np.zeros((len(ways), 3)), 0)
    count = int(snapshot.crowd.counts[0])
    walked = [snapshot.crowd.positions[0, :count]]
    for command in np.repeat(commands, round(whole / period), axis=0):
        snapshot = fork.advance(command, ticks)
        walked.append(snapshot.crowd.positions[0, :count])
        touched = [(contacts[0].stamp, robot) for robot, contacts in enumerate(snapshot.contacts) if contacts]
        if touched:
            return Rehearsal(*min(touched), np.array(walked, np.float64))
    return Rehearsal(math.inf, -1, np.array(walked, np.float64))


def find_certified(truth: Truth, finder: WayFinder, future: Walkers, rehearsals: int) -> Way | None:
    """Return a way that was driven in a fork of the world without touching anything, or None.

    ``future`` is that of people without the robot. Where they react to it, the way is searched again among people as
    they walked beside it.
    """
    for attempt in finder.attempts:
        people = future
        for _ in range(rehearsals):
            way = finder.find(truth, people, attempt)
            if way is None:
                break
            tried = rehearse(truth, way)
            if tried.touched == math.inf:
                return way
            again = join_walks(people, tried.walked)
            if np.nanmax(np.abs(again.positions - people.positions), initial=0.0) < SAME:
                break
            people = again
    return None


def join_walks(people: Walkers, walked: Floats) -> Walkers:
    """Return people who walk as they ``walked`` (K, P, 2), and from then on as far as they would have."""
    positions, last = people.positions.copy(), min(len(walked), len(people.positions)) - 1
    positions[: last + 1] = walked[: last + 1]
    positions[last + 1 :] += np.nan_to_num(walked[last] - people.positions[last])
    return Walkers(positions, people.radii, people.start, people.period)
