"""What learning shares with deployment: batched observations and their encoders, transitions and their rewards."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from arena_core.geometry import FloatArray, Twist
from arena_core.interfaces import PathBatch
from arena_core.sensing import Observation

Flags = NDArray[np.bool_]


@dataclass(frozen=True, slots=True, eq=False)
class ObservationBatch:
    """What N planners see at one control step, as arrays; the single one is a batch of one.

    ``stamps`` (N,) s; ``ranges`` (N, B) float32 m, +inf where nothing was hit; ``poses`` (N, 3) in ``map``; ``twists`` (N, 3) measured, in
    ``base_link``; ``goals`` and ``waypoints`` (N, 3) in ``map``; ``last_commands`` (N, 3), the velocities commanded a step before, zero at
    first; ``paths`` in ``map``.
    """

    stamps: FloatArray
    ranges: NDArray[np.float32]
    poses: FloatArray
    twists: FloatArray
    goals: FloatArray
    waypoints: FloatArray
    last_commands: FloatArray
    paths: PathBatch

    @staticmethod
    def of(observation: Observation, last_command: Twist) -> ObservationBatch:
        """Make the batch of one that a planner sees."""
        return ObservationBatch(
            np.array((observation.stamp,)),
            np.ascontiguousarray(observation.scan.ranges, np.float32)[None],
            observation.pose.array()[None],
            observation.twist.array()[None],
            observation.goal.array()[None],
            observation.waypoint.array()[None],
            last_command.array()[None],
            PathBatch.of([observation.path]),
        )


@dataclass(frozen=True, slots=True)
class ObservationField:
    """``size`` neighbouring numbers of an encoded observation, ``low`` .. ``high``; ``meaning`` says what they are and how scaled."""

    name: str
    size: int
    unit: str
    low: float
    high: float
    meaning: str


class ObservationEncoder(ABC):
    """Turns observations into the numbers that a policy reads, alike in training and on the robot. The constructor receives ``robot``."""

    @abstractmethod
    def layout(self) -> tuple[ObservationField, ...]:
        """Return the fields of an encoded observation, in their order."""

    @abstractmethod
    def encode(self, observations: ObservationBatch) -> NDArray[np.float32]:
        """Return new numbers (N, D); row k depends on observation k alone, bit for bit."""


@dataclass(frozen=True, slots=True, eq=False)
class Situation:
    """The truth about N robots at one control step, as rewards see it.

    ``poses`` (N, 3) in ``map``, ``twists`` (N, 3) in ``base_link``, all others (N,) in m: the distance to the goal, the way left along the
    path, the distance beside it, the footprint's clearance of everything and of people (inf without), the least range of the scan (inf
    where nothing was hit).
    """

    poses: FloatArray
    twists: FloatArray
    goal_distances: FloatArray
    path_lengths_left: FloatArray
    path_distances: FloatArray
    clearances: FloatArray
    clearances_people: FloatArray
    nearest_ranges: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class Transition:
    """One control step of N robots: ``commands`` (N, 3) led from ``before`` to ``after``; ``last_commands`` (N, 3) were the ones before.

    ``arrived``, ``collided`` and ``timed_out`` (N,) tell what came of it; ``period`` is the length of the step, s.
    """

    before: Situation
    after: Situation
    commands: FloatArray
    last_commands: FloatArray
    arrived: Flags
    collided: Flags
    timed_out: Flags
    period: float


class Reward(ABC):
    """Judges steps in training: a pure function of a transition. The constructor receives ``robot``."""

    @abstractmethod
    def reward(self, transition: Transition) -> FloatArray:
        """Return the reward of each robot (N,); entry k depends on robot k alone."""
