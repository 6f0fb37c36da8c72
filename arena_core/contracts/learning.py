"""What learning shares with deployment: batched observations and their encoders, transitions and their rewards."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from arena_core.contracts.navigation import PathBatch
from arena_core.values.geometry import FloatArray, Twist
from arena_core.values.predictions import Predictions
from arena_core.values.sensing import Observation, Tracks, straight_predictions
from arena_core.values.world import OccupancyGrid

if TYPE_CHECKING:
    from pathlib import Path

Flags = NDArray[np.bool_]


@dataclass(frozen=True, slots=True, eq=False)
class EarlierScans:
    """L scans of N robots, taken some control steps ago.

    ``ranges`` (N, L, B) float32 m; ``poses`` (N, L, 3) in ``map`` of the robots then.
    """

    ranges: NDArray[np.float32]
    poses: FloatArray


class ScanMemory:
    """Keeps the latest scans of N robots for an encoder that looks back so many control steps as each entry of
    ``lookback`` says.

    What lies before an episode's first scan is that first scan.
    """

    def __init__(self, lookback: Sequence[int], robots: int, beams: int) -> None:
        self._lookback = np.array(lookback, np.int64)
        self._depth = max(lookback, default=0) + 1
        self._now = 0
        self._ranges = np.empty((robots, self._depth if lookback else 0, beams), np.float32)
        self._poses = np.empty((*self._ranges.shape[:2], 3))

    def begin(self, slots: NDArray[np.int64], ranges: NDArray[np.float32], poses: FloatArray) -> None:
        """Begin episodes of K robots with the first scans (K, B), taken at poses (K, 3)."""
        self._ranges[slots], self._poses[slots] = ranges[:, None], poses[:, None]

    def remember(self, ranges: NDArray[np.float32], poses: FloatArray) -> None:
        """Take in the scans (N, B) of one more control step, taken at poses (N, 3)."""
        if len(self._lookback):
            self._now = (self._now + 1) % self._depth
            self._ranges[:, self._now], self._poses[:, self._now] = ranges, poses

    def earlier(self, slots: NDArray[np.int64] | slice = slice(None)) -> EarlierScans:
        """Return new arrays of the scans that the encoder looks back at."""
        chosen = (self._now - self._lookback) % self._depth
        return EarlierScans(self._ranges[slots][:, chosen], self._poses[slots][:, chosen])


@dataclass(frozen=True, slots=True, eq=False)
class ObservationBatch:
    """What N planners see at one control step, as arrays; the single one is a batch of one.

    ``stamps`` (N,) s; ``ranges`` (N, B) float32 m, +inf where nothing was hit; ``poses`` (N, 3) in ``map``; ``twists``
    (N, 3) measured, in ``base_link``; ``goals`` and ``waypoints`` (N, 3) in ``map``; ``last_commands`` (N, 3), the
    velocities commanded a step before, zero at first; ``paths`` in ``map``; ``earlier`` scans as many as the encoder
    looks back at; ``maps`` (N), None where a robot has none; ``recalled`` (N, D), what a recurrent encoder made of the
    step before, zeros at first, (N, 0) for all others; ``depths`` (N, H, W) float32 m, the newest images of depth
    cameras, None where robots have none; ``tracks`` (N) and ``predictions`` (N) of where they will be, none where no
    encoder asks for them.
    """

    stamps: FloatArray
    ranges: NDArray[np.float32]
    poses: FloatArray
    twists: FloatArray
    goals: FloatArray
    waypoints: FloatArray
    last_commands: FloatArray
    paths: PathBatch
    earlier: EarlierScans
    maps: tuple[OccupancyGrid | None, ...]
    recalled: NDArray[np.float32]
    depths: NDArray[np.float32] | None = None
    tracks: tuple[Tracks, ...] = ()
    predictions: tuple[Predictions, ...] = ()

    @property
    def expected(self) -> tuple[Predictions, ...]:
        """Return where the tracks will be; where nobody predicts, they keep their velocity."""
        return self.predictions or tuple(map(straight_predictions, self.tracks))

    @staticmethod
    def of(
        observation: Observation,
        last_command: Twist,
        memory: ScanMemory | None = None,
        recalled: NDArray[np.float32] | None = None,
        *,
        tracked: bool = False,
    ) -> ObservationBatch:
        """Make the batch of one that a planner sees; it keeps ``memory`` and ``recalled`` where its encoder looks back
        or is recurrent.

        The tracks are asked for where its encoder is ``tracked``.
        """
        return ObservationBatch(
            np.array((observation.stamp,)),
            np.ascontiguousarray(observation.scan.ranges, np.float32)[None],
            observation.pose.array()[None],
            observation.twist.array()[None],
            observation.goal.array()[None],
            observation.waypoint.array()[None],
            last_command.array()[None],
            PathBatch.of([observation.path]),
            (memory or ScanMemory((), 1, len(observation.scan.ranges))).earlier(),
            (observation.map,),
            np.zeros((1, 0), np.float32) if recalled is None else recalled,
            None if observation.depth is None else observation.depth.depths[None],
            (observation.tracks,) if tracked else (),
            (observation.predictions,) if tracked else (),
        )


@dataclass(frozen=True, slots=True)
class ObservationField:
    """``size`` neighbouring numbers of an encoded observation, ``low`` ..

    ``high``; ``meaning`` says what they are and how scaled.
    """

    name: str
    size: int
    unit: str
    low: float
    high: float
    meaning: str


class ObservationEncoder(ABC):
    """Turns observations into the numbers that a policy reads, alike in training and on the robot.

    Life cycle: built with ``robot: Robot`` and the keys of its YAML when a training or a planner begins; ``layout`` is
    called once, ``encode`` at each control step. It has no state of its own.

    Attributes:

    - ``lookback``: how many control steps ago the earlier scans were taken that it wants to see.
    - ``recurrent``: whether it sees its own numbers of the step before as ``recalled``: all the state that it may have.
    - ``tracked``: whether it sees what the robot's tracker believes in.

    ```python
    class Ranges(ObservationEncoder):
        def __init__(self, robot: Robot) -> None:
            self.beams, self.range_max = robot.lidar.beams, robot.lidar.range_max

        def layout(self) -> tuple[ObservationField, ...]:
            return (ObservationField("ranges", self.beams, "-", 0.0, 1.0, "ranges by the greatest one"),)

        def encode(self, observations: ObservationBatch) -> NDArray[np.float32]:
            return np.minimum(observations.ranges / np.float32(self.range_max), np.float32(1.0))
    ```
    """

    lookback: tuple[int, ...] = ()
    recurrent: bool = False
    tracked: bool = False

    @abstractmethod
    def layout(self) -> tuple[ObservationField, ...]:
        """Return the fields of an encoded observation, in their order."""

    @abstractmethod
    def encode(self, observations: ObservationBatch) -> NDArray[np.float32]:
        """Return new numbers (N, D); row k depends on observation k alone, bit for bit."""

    def blank(self, robots: int) -> NDArray[np.float32]:
        """Return what N robots recall when an episode begins: zeros (N, D), (N, 0) where nothing is recalled."""
        return np.zeros((robots, sum(field.size for field in self.layout()) if self.recurrent else 0), np.float32)

    def parts(self) -> Mapping[str, str]:
        """Return the trained networks that it runs: the parameters that name them, and their ONNX files, each with a
        card beside it.

        They go wherever a policy goes that reads these numbers.
        """
        return {}


@dataclass(frozen=True, slots=True, eq=False)
class Situation:
    """The truth about N robots at one control step, as rewards see it.

    ``poses`` (N, 3) in ``map``, ``twists`` (N, 3) in ``base_link``, all others (N,) in m: the distance to the goal, the
    way left along the path, the distance beside it, the footprint's clearance of everything and of people (inf
    without), the least range of the scan (inf where nothing was hit); last, in s, for how long the robot has stood.
    """

    poses: FloatArray
    twists: FloatArray
    goal_distances: FloatArray
    path_lengths_left: FloatArray
    path_distances: FloatArray
    clearances: FloatArray
    clearances_people: FloatArray
    nearest_ranges: FloatArray
    standing_times: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class Transition:
    """One control step of N robots: ``commands`` (N, 3) led from ``before`` to ``after``; ``last_commands`` (N, 3) were
    the ones before.

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
    """Judges steps in training: a pure function of a transition.

    Life cycle: built once with ``robot: Robot`` and the keys of its YAML when a training begins; ``reward`` is called
    at each control step, for N robots at once.

    ```python
    class Arrive(Reward):
        def __init__(self, robot: Robot) -> None:
            self.radius = robot.footprint.radius

        def reward(self, transition: Transition) -> FloatArray:
            gained = transition.before.goal_distances - transition.after.goal_distances
            return gained + 10.0 * transition.arrived - 10.0 * transition.collided
    ```
    """

    @abstractmethod
    def reward(self, transition: Transition) -> FloatArray:
        """Return the reward of each robot (N,); entry k depends on robot k alone."""


class Trainer(ABC):
    """A way to train a planner that a recipe chooses as ``trainer``, in place of proximal policy optimisation.

    Life cycle: built by ``arena train`` with the keys of the recipe's ``trainer``; ``train`` is called once for each
    seed.
    """

    @abstractmethod
    def train(self, config: Mapping[str, Any], folder: Path, *, resume: bool) -> None:
        """Train by what ``arena train`` composed; write ``policy.onnx`` and its card to ``folder``.

        With ``resume`` it goes on with what the folder holds. Raises ConfigurationError for a folder that holds a
        training, unless ``resume``, or that of another configuration.
        """
