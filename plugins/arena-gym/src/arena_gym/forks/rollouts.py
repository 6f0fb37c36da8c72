"""What every member makes of the same state: the world and the robot's brain are forked once for each."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from arena_core import Branches, OccupancyGrid, Sensors, Simulator, Snapshot
from arena_core.hosting import EpisodeLoop, Navigator
from arena_gym.forks.costs import Outcomes, intrusions, outcome_terms
from arena_gym.forks.driver import ToldSwitch
from arena_gym.forks.settings import CostSettings
from arena_kernels.shortest_path import ShortestPaths, path_length

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Label:
    """A state: what a switch sees of it, ``numbers`` (D,), and the ``terms`` (K, 3) of each member's cost."""

    numbers: NDArray[np.float32]
    terms: Floats


@dataclass(frozen=True, slots=True, eq=False)
class Fork:
    """World 0 of ``loop`` and the robot's brain as they are now, on the map ``grid``."""

    loop: EpisodeLoop
    navigator: Navigator
    grid: OccupancyGrid

    def label(self, members: int, settings: CostSettings) -> Label | None:
        """Return what each of the members would make of now; None where none would be asked now, or no way is known.

        Each drives a copy of the navigator in a copy of the world, whose people and sensors draw the same numbers.
        """
        branches = [_Branch.of(self.navigator, member) for member in range(members)]
        worlds = self.loop.fork(Branches.of([0] * members))
        seen = self.loop.snapshot.sensors(0)
        rolled = _RollOut(branches, worlds, self, settings)
        outcomes = rolled.drive([seen] * members)
        numbers = branches[0].numbers
        way = self.way_left(self.loop.snapshot.poses[0])
        if numbers is None or not np.isfinite((way, *outcomes.left)).all():
            return None
        return Label(numbers, outcome_terms(outcomes, way, self.navigator.robot.limits.vx_max))

    def way_left(self, pose: Floats) -> float:
        """Return how long the shortest way to the goal is for the robot's body from a pose (3,), m; NaN without one."""
        body = self.navigator.robot.footprint.inscribed_radius
        way = self.grid.derive(ShortestPaths).path_between(pose[:2], self.loop.goals[0, :2], body)
        return path_length(way) if len(way) else float("nan")


@dataclass(slots=True, eq=False)
class _Branch:
    """One member's copy of the brain; ``numbers`` is what a switch sees first, None where no member was asked."""

    navigator: Navigator
    switch: ToldSwitch
    numbers: NDArray[np.float32] | None = None
    begun: bool = False

    @staticmethod
    def of(navigator: Navigator, member: int) -> _Branch:
        copy = navigator.fork()
        switch = copy.planner
        assert isinstance(switch, ToldSwitch)
        switch.member, switch.numbers = member, None
        return _Branch(copy, switch)

    def decide(self, sensors: Sensors) -> tuple[Floats, bool]:
        """Return the command (3,), and whether the robot believes that it has arrived."""
        decision = self.navigator.decide(sensors)
        if not self.begun:
            self.begun, self.numbers = True, self.switch.numbers
        return decision.command.array(), decision.arrived


class _RollOut:
    """K members side by side for the horizon; who has arrived stands, and costs no more."""

    def __init__(self, branches: list[_Branch], worlds: Simulator, fork: Fork, settings: CostSettings) -> None:
        self._branches, self._worlds, self._fork, self._settings = branches, worlds, fork, settings
        count = len(branches)
        self._driving = np.ones(count, np.bool_)
        self._times, self._collisions, self._discomforts = np.zeros(count), np.zeros(count), np.zeros(count)
        self._left = np.zeros(count)

    def drive(self, sensors: list[Sensors]) -> Outcomes:
        """Drive all from what the robot measures now, (K)."""
        loop, period = self._fork.loop, self._fork.navigator.control_period
        snapshot: Snapshot | None = None
        for _ in range(round(self._settings.horizon / period)):
            commands = self._decide_all(sensors)
            if not self._driving.any():
                break
            snapshot = self._worlds.advance(commands, loop.ticks)
            self._count(snapshot, period)
            sensors = [snapshot.sensors(k) for k in range(len(self._branches))]
        if snapshot is not None:
            for k in np.flatnonzero(self._driving):
                self._left[k] = self._fork.way_left(snapshot.poses[k])
        return Outcomes(self._times, self._left, self._collisions, self._discomforts)

    def _decide_all(self, sensors: list[Sensors]) -> Floats:
        commands = np.zeros((len(self._branches), 3))
        for k in np.flatnonzero(self._driving):
            commands[k], arrived = self._branches[k].decide(sensors[k])
            if arrived:
                commands[k], self._driving[k] = 0.0, False
        return commands

    def _count(self, snapshot: Snapshot, period: float) -> None:
        driving = self._driving
        self._times[driving] += period
        self._collisions[driving] += np.array([len(met) for met in snapshot.contacts])[driving]
        self._discomforts[driving] += intrusions(snapshot.clearances_people, self._settings.near, period)[driving]
