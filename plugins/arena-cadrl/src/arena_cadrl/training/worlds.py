"""Worlds in step, in which robots see what a benchmark would show them, and are driven by velocities."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from arena_cadrl.perception import ActionLookahead, Perception
from arena_core import EpisodeStart, Observation, Planner, Robot, Twist
from arena_core.hosting import Registry
from arena_gym.batch import NavigationBatch, Step
from arena_gym.driver import Driver
from arena_gym.privileged import allowed_privileged
from arena_policies.members import Members

Floats = NDArray[np.float64]


class ExpertRecorder(Planner):
    """Notes what a robot sees; ``teacher`` drives while it is ``teaching``, else no one does."""

    def __init__(self, eyes: Perception, teacher: Planner) -> None:
        self._perception, self._teacher = eyes, teacher
        self.teaching = False
        self.sight: ActionLookahead | None = None

    def reset(self, episode: EpisodeStart) -> None:
        """Begin an episode."""
        self.sight = None
        self._teacher.reset(episode)

    def compute_velocity(self, observation: Observation) -> Twist:
        """Return the teacher's velocity; raise NoValidCommand where it has none."""
        self.sight = self._perception.observe(observation)
        return self._teacher.compute_velocity(observation) if self.teaching else Twist(0.0)


class RecorderMembers(Members):
    """One who looks on, as a switch's only member; between decisions the tracker
    alone sees on, as it does on the robot.
    """

    def __init__(self, onlooker: ExpertRecorder) -> None:
        super().__init__({"onlooker": onlooker})
        self.deciding = True

    def drive(self, chosen: int, observation: Observation) -> Twist:
        """Return the teacher's velocity, none between decisions."""
        if self.deciding:
            return super().drive(chosen, observation)
        _ = observation.tracks
        return Twist(0.0)


@dataclass(frozen=True, slots=True, eq=False)
class WorldsObservation:
    """What all N robots see: ``rows`` (N, 1 + A, D), and each one's sight; ``taught`` (N, 3) is
    what the teacher would drive.
    """

    rows: NDArray[np.float32]
    sights: Sequence[ActionLookahead]
    taught: Floats


class VectorWorlds:
    """N worlds, each with a local map and a tracker of its own; an episode that ends is followed by the next."""

    def __init__(
        self,
        batch: NavigationBatch,
        eyes: Perception,
        teacher: Callable[[], Planner],
        nodes: Mapping[str, Mapping[str, Any]],
        registry: Registry,
    ) -> None:
        self.batch = batch
        robot: Robot = batch.parts.robot
        self._onlookers: list[ExpertRecorder] = []
        self._members: list[RecorderMembers] = []
        self._drivers: list[Driver] = []
        for _ in range(batch.worlds):
            with allowed_privileged(batch.parts.config) as seeing:
                self._onlookers.append(ExpertRecorder(eyes, teacher()))
                self._members.append(RecorderMembers(self._onlookers[-1]))
                local_map = registry.build("local_map", nodes["local_map"], robot=robot)
                tracker = registry.build("tracker", nodes["tracker"], robot=robot)
            self._drivers.append(Driver(robot, self._members[-1], local_map, tracker))
            self._drivers[-1].privileged = [one.part for one in seeing]
        self._rows = np.empty((batch.worlds, 1 + eyes.actions, eyes.size), np.float32)

    def begin(self, seeds: Sequence[int]) -> None:
        """Begin the first episodes of these seeds."""
        self.batch.reset(seeds)
        self._places = [(self.batch.seen, slot) for slot in range(self.batch.worlds)]
        self._begin_drivers(range(self.batch.worlds))

    def observe(self, *, teaching: bool) -> WorldsObservation:
        """Let all robots look, with the teacher's velocities where it is ``teaching``."""
        taught = np.zeros((self.batch.worlds, 3))
        sights = []
        for slot, (driver, onlooker) in enumerate(zip(self._drivers, self._onlookers, strict=True)):
            onlooker.teaching = teaching
            taught[slot] = driver.drive(0, *self._places[slot])
            assert onlooker.sight is not None
            sights.append(onlooker.sight)
            self._rows[slot, 0], self._rows[slot, 1:] = onlooker.sight.now, onlooker.sight.ahead
        return WorldsObservation(self._rows, sights, taught)

    def track(self) -> None:
        """Let all trackers see a scan between two decisions."""
        for slot, (driver, members) in enumerate(zip(self._drivers, self._members, strict=True)):
            members.deciding = False
            driver.drive(0, *self._places[slot])
            members.deciding = True

    def drive(self, commands: Floats) -> Step:
        """Drive for one control period by velocities (N, 3); ended episodes are followed by the next ones at once."""
        step = self.batch.drive(commands)
        self._places = [(self.batch.seen, slot) for slot in range(self.batch.worlds)]
        ended = np.flatnonzero(step.terminated | step.truncated)
        if len(ended):
            self.batch.restart(ended)
            for row, slot in enumerate(ended.tolist()):
                self._places[slot] = (self.batch.seen, row)
            self._begin_drivers(ended.tolist())
        return step

    def _begin_drivers(self, slots: Sequence[int] | range) -> None:
        for slot in slots:
            self._drivers[slot].begin(self.batch.episodes[slot].problem, self.batch.truth(slot))
