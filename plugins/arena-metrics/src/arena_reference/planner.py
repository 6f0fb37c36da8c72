"""Planners that see the truth: one that knows the future and certifies what could have been done, one that has no x-ray
eyes.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Annotated, ClassVar

import numpy as np

from arena_core import ConfigurationError, EpisodeStart, NoValidCommand, Observation, Planner, Pose, Robot, Twist
from arena_core.hosting import Truth
from arena_core.parameters import Flat, Positive, PositiveInt
from arena_reference.body import Walkers
from arena_reference.bounds import Bound
from arena_reference.outlook import foresee, part_of
from arena_reference.sight import seen_people, slow_where_blind
from arena_reference.together import Team, TeamWays, find_together
from arena_reference.ways import SearchSettings, Way, WayFinder, find_certified

TEAM, WAYS, FUTURE = "clairvoyant team", "clairvoyant ways", "clairvoyant future"  # what clairvoyants tell each other
OFF, TURNED = 0.02, 0.05  # m and rad that the robot may be away from its way before another one is searched


class WayFollower(Planner):
    """Drives ways that are searched with the truth."""

    privileged: ClassVar[bool] = True
    compiles: ClassVar[bool] = True

    def __init__(self, robot: Robot, search: SearchSettings) -> None:
        self._robot, self._settings = robot, search

    def see(self, truth: Truth) -> None:
        """Take the truth of the episode that begins."""
        self._truth = truth

    def reset(self, episode: EpisodeStart) -> None:
        """Forget the way of the episode before."""
        self._finder = WayFinder(self._robot, self._settings, episode.control_period)
        self._period = episode.control_period
        self._way: Way | None = None
        self._due = -math.inf  # s, when a way is searched again

    def _command(self, stamp: float) -> Twist | None:
        """Return the command that the way has at a time, None where it has none, or the robot is not on it."""
        return follow(self._way, stamp, self._truth.state().pose)


class Clairvoyant(WayFollower):
    """Drives a way that was searched with the people's true future, and tried in a fork of the world.

    In a team the first one that is asked searches ways for all robots, which are tried together. Its notes tell the
    lower bound of time, and whether a way was found at the start.
    """

    drives_team: ClassVar[bool] = True

    def __init__(
        self,
        robot: Robot,
        search: Annotated[SearchSettings, Flat()],
        rehearsals: PositiveInt,
        bound_cell: Positive,
        patience: Positive,
    ) -> None:
        super().__init__(robot, search)
        self._rehearsals, self._bound_cell, self._patience = rehearsals, bound_cell, patience

    def see(self, truth: Truth) -> None:
        """Take the truth; raise ConfigurationError where goals follow on one another, which no way leads to."""
        if truth.scenario.errands is not None:
            raise ConfigurationError(
                "planner clairvoyant searches a way to one goal, and this task sends robots on until the time limit; "
                "allowed: tasks with a goal for each robot"
            )
        super().see(truth)

    def reset(self, episode: EpisodeStart) -> None:
        """Forget the way and the notes of the episode before."""
        super().reset(episode)
        self._searches = 0
        self._notes: dict[str, float] = {}

    def notes(self) -> Mapping[str, float]:
        """Return the lower bounds of time, s: among what stands, and among people; and when a way was to arrive."""
        return self._notes

    def compute_velocity(self, observation: Observation) -> Twist:
        """Return the command that the way has for now; raise NoValidCommand where no way is known."""
        stamp = observation.stamp
        self._adopt_newer_way()
        command = self._command(stamp)
        if command is None:
            if stamp < self._due:
                raise NoValidCommand("no way to the goal is known")
            self._way, self._searches = self._search(), self._searches + 1
            self._due = stamp + self._patience * (2.0**self._searches if self._truth.team else 1.0)
            command = self._command(stamp)
        if command is None:
            raise NoValidCommand("no way to the goal was found")
        return command

    def _search(self) -> Way | None:
        period = part_of(self._period)
        if self._truth.team:
            future, way = self._search_together(period)
        else:
            future = foresee(self._truth, self._finder.horizon(self._truth), period)
            way = find_certified(self._truth, self._finder, future, self._rehearsals)
        if not self._notes:
            self._notes = self._bounds(future, period)
        self._notes.setdefault("time_planned", way.arrival if way is not None else math.inf)
        return way

    def _adopt_newer_way(self) -> None:
        """Go on by the way that a teammate has searched for all since this robot got its own."""
        newest = self._truth.team[0].shared.get(WAYS) if self._truth.team else None
        if newest is not None and newest.ways and self._way is not None and newest.stamp > self._way.start:
            self._way = newest.ways[self._member()]

    def _member(self) -> int:
        return next(member for member, truth in enumerate(self._truth.team) if truth is self._truth)

    def _search_together(self, period: float) -> tuple[Walkers, Way | None]:
        """Return people's future, and this robot's way of those that were searched for all robots at this instant."""
        truths = self._truth.team
        shared, stamp = truths[0].shared, self._truth.state().stamp
        if TEAM not in shared:
            finders = [WayFinder(truth.robot, self._settings, self._period) for truth in truths]
            shared[TEAM] = Team.of(truths, finders)
        if WAYS not in shared or shared[WAYS].stamp < stamp:
            shared[FUTURE] = foresee(self._truth, shared[TEAM].horizon(), period)
            shared[WAYS] = TeamWays(stamp, find_together(shared[TEAM], shared[FUTURE], self._rehearsals))
        ways = shared[WAYS].ways
        return shared[FUTURE], ways[self._member()] if ways else None

    def _bounds(self, future: Walkers, period: float) -> dict[str, float]:
        """Return the lower bounds; the whole time limit is looked at where the horizon of a way is not enough."""
        scenario = self._truth.scenario
        bound = Bound(self._robot, scenario, self._finder.site.terrain(scenario, self._bound_cell, keep=False))
        reacts = any(person.behaviour.get("reaction", "ignore") != "ignore" for person in scenario.pedestrians)
        if reacts or scenario.doors:  # a robot may make people step aside, or hold a door open for them
            return dict.fromkeys(("time_lower_static", "time_lower"), bound.time())
        known = future.start + future.period * (len(future.positions) - 1)
        among = bound.time(future, min(known, scenario.time_limit))
        if among == math.inf and known < scenario.time_limit:
            among = bound.time(foresee(self._truth, scenario.time_limit, period))
        return {"time_lower_static": bound.time(), "time_lower": among}


class Sighted(WayFollower):
    """Plans again and again with the true future of the people whom its lidar sees now, and of nobody else.

    A reference between planners and clairvoyant; no bound: others may be better.
    """

    def __init__(
        self,
        robot: Robot,
        search: Annotated[SearchSettings, Flat()],
        horizon: Positive,
        replan_period: Positive,
        blind_speed: Positive,
    ) -> None:
        super().__init__(slow_where_blind(robot, blind_speed), search)
        self._horizon, self._replan = horizon, replan_period

    def see(self, truth: Truth) -> None:
        """Take the truth; raise ConfigurationError in a team: where its other robots will be, nobody knows."""
        if truth.team:
            raise ConfigurationError("planner sighted knows what people will do; allowed: a robot without teammates")
        super().see(truth)

    def compute_velocity(self, observation: Observation) -> Twist:
        """Return the command of a way that is no older than the replanning period; raise NoValidCommand without one."""
        stamp = observation.stamp
        command = self._command(stamp)
        if stamp >= self._due or command is None:
            self._way, self._due = self._search(observation), stamp + self._replan - 1e-9
            command = self._command(stamp)
        if command is None:
            raise NoValidCommand("no way leads on among the people in sight")
        return command

    def _search(self, observation: Observation) -> Way | None:
        future = foresee(self._truth, self._horizon, part_of(self._period))
        seen = seen_people(self._truth.state(), observation.scan, self._robot)
        people = Walkers(
            np.ascontiguousarray(future.positions[:, seen]), future.radii[seen], future.start, future.period
        )
        for attempt in self._settings.attempts:
            way = self._finder.find(self._truth, people, attempt, open_end=True)
            if way is not None:
                return way
        return None


def follow(way: Way | None, stamp: float, pose: Pose) -> Twist | None:
    """Return the command that a way has at a time, None where it has none, or the robot is not on it."""
    if way is None:
        return None
    step = round((stamp - way.start) / way.period)
    if not 0 <= step < len(way.commands):
        return None
    x, y, theta = way.states[step, :3]
    turned = abs((pose.theta - theta + math.pi) % (2.0 * math.pi) - math.pi)
    if math.hypot(pose.x - x, pose.y - y) > OFF or turned > TURNED:
        return None
    return Twist(*(float(value) for value in way.commands[step]))
