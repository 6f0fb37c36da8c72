"""The interfaces of what is simulated: worlds, tasks, people, and the simulator that steps N of them at once."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from arena_core.base.errors import ConfigurationError
from arena_core.values.episode import Contact, Scenario, WorldState
from arena_core.values.errands import PatrolGraph
from arena_core.values.geometry import FloatArray, Pose, Twist
from arena_core.values.sensing import DepthImage, LaserScan, Odometry, Sensors
from arena_core.values.staging import Staging
from arena_core.values.world import Crowd, Gait, World


class WorldSource(ABC):
    """A source of worlds: a file gives always the same, a generator a new one for each (seed, index).

    Life cycle: built once in each process of a run; ``world`` is called for every scenario, and may be called for the
    same one again: it is a pure function.

    ```python
    class Walled(WorldSource):
        def world(self, seed: int, index: int) -> World:
            cells = np.full((160, 160), FREE, np.int8)
            cells[[0, -1], :] = cells[:, [0, -1]] = OCCUPIED
            return World("walled", OccupancyGrid(cells, 0.05, Pose(-4.0, -4.0)))
    ```
    """

    @abstractmethod
    def world(self, seed: int, index: int) -> World:
        """Return the world of scenario ``index`` of ``seed``."""

    def at(self, difficulty: float) -> WorldSource:
        """Return this source with worlds of another difficulty, 0 .. 1; raise
        ConfigurationError where worlds have none.
        """
        raise ConfigurationError(f"difficulty is {difficulty:g}, but this world has none; allowed: a generated world")


class TaskMode(ABC):
    """A seeded source of scenarios; a pure function of (seed, index).

    Life cycle: built once in each process of a run with ``robot: Robot``, ``world: WorldSource`` and the keys of its
    YAML; ``count`` and ``staging`` are asked before a run, ``scenario`` once an episode.

    ```python
    class Across(TaskMode):
        def __init__(self, robot: Robot, world: WorldSource) -> None:
            self.world = world

        def scenario(self, seed: int, index: int) -> Scenario:
            world, start, goal = self.world.world(seed, index), Pose(-2.0, 0.0), Pose(2.0, 0.0)
            return Scenario(f"across/{index:04d}", seed, world, start, goal, (), (), goal_radius=0.3, time_limit=60.0)
    ```
    """

    @abstractmethod
    def scenario(self, seed: int, index: int) -> Scenario:
        """Return problem ``index`` of ``seed``; raise ImpossibleScenario when there is none (a row with its reason)."""

    def count(self) -> int | None:
        """Return how many scenarios there are, None for no end."""
        return None

    def robots(self) -> int:
        """Return how many robots each scenario has; asked before a run."""
        return 1

    def staging(self) -> Staging | None:
        """Return by which rule this task moves between its levels, None where it has none."""
        return None

    def at_stage(self, stage: int) -> TaskMode:
        """Return the task of one level, whose scenarios have this ``stage``; asked for only where there is a rule."""
        return self


class PatrolStrategy(ABC):
    """Who of a team patrols what next (``task=patrol``).

    Life cycle: built once in each process of a run with the keys of its YAML; ``begin`` is called for every episode:
    what it returns keeps what there is to keep of that episode, not the strategy.

    ```python
    class Onwards(PatrolStrategy):
        def begin(self, graph: PatrolGraph, starts: Sequence[int], random: np.random.Generator):
            def next_place(robot: int, at: int, idleness: FloatArray) -> int:
                return (at + 1) % len(graph)

            return next_place
    ```
    """

    @abstractmethod
    def begin(
        self, graph: PatrolGraph, starts: Sequence[int], random: np.random.Generator
    ) -> Callable[[int, int, FloatArray], int]:
        """Begin an episode of robots that stand at the places ``starts``.

        Returns a function that says which place robot ``m`` goes to from place ``at``, given the ``idleness`` of all
        places, (V,) s since anybody was there.
        """


@dataclass(frozen=True, slots=True, eq=False)
class Branches:
    """Which worlds a fork holds, and how they go on.

    ``slots`` (K,): the world that each goes on from; the same may stand there many times. ``streams`` (K,): 0 where a
    branch draws the numbers that the original will draw, any other number where it draws numbers of its own, a stream
    for each. ``robots`` (K, R): whether each robot is in the world; one that is not touches nobody and is seen by
    nobody. R is the number of robots of a world, or 1: then all of them are treated alike.
    """

    slots: NDArray[np.int64]
    streams: NDArray[np.uint64]
    robots: NDArray[np.bool_]

    def __len__(self) -> int:
        return len(self.slots)

    @classmethod
    def of(
        cls, slots: Sequence[int] | NDArray[np.int64], streams: Sequence[int] | None = None, *, robots: bool = True
    ) -> Branches:
        """Return branches of these slots, with the originals' numbers and robots unless said otherwise."""
        indices = np.asarray(slots, np.int64)
        own = np.zeros(len(indices), np.uint64) if streams is None else np.asarray(streams, np.uint64)
        return cls(indices, own, np.full((len(indices), 1), robots))


@dataclass(frozen=True, slots=True, eq=False)
class RobotBatch:
    """N robots as the crowd meets them: ``poses`` (N, 3) in ``map``, ``velocities_xy`` (N, 2) in
    ``map`` m/s, ``radius`` m. A robot that is not in its world stands at (FAR, FAR), where nobody sees it.

    Worlds with teams of M robots have a robot axis, ``poses`` (N, M, 3) and ``velocities_xy`` (N, M, 2), and where
    robots differ ``radius`` is one of each, (N, M); only models with ``meets_teams`` are given them.
    """

    FAR: ClassVar[float] = 1e6  # m

    poses: FloatArray
    velocities_xy: FloatArray
    radius: float | FloatArray


class PedestrianModel(ABC):
    """How people walk, in N worlds at once; its simulator calls it and keeps bodies apart.

    Life cycle: built once in each process of a run; ``reset`` for slots whose episode is new, ``walks`` after it, then
    ``step`` at each inner step of the simulator. Slot k of N must equal a batch of one, bit for bit.

    People may leave and come: who is not in the world is at NaN, ABSENT. Who comes back elsewhere is absent for a step
    at least. The simulator lets no one appear in the robot's place: who is still absent in the crowd that ``step`` is
    given has to be put again.

    Where its configuration has a key ``reaction`` (to the robot: ignore, yield ...), tables tell cells apart by it.

    Attributes:

    - ``gait``: how lidars see who ``walks``, as two legs; None: all are discs. Contacts and clearances are always those
      of discs.
    - ``through_walls``: whether nothing that stands stops people, because they walk as recorded.
    - ``meets_teams``: whether ``step`` takes a RobotBatch with several robots a world.

    ```python
    class Standing(PedestrianModel):
        def reset(self, slots, scenarios: Sequence[Scenario], total: int) -> Crowd:
            none = np.zeros((total, 0))
            counts, places = np.zeros(total, np.int32), np.zeros((total, 0, 2))
            return Crowd(counts, none.astype(np.int32), places, places, none, none.astype(np.int8))

        def step(self, crowd: Crowd, robots: RobotBatch, ticks, dt: float) -> Crowd:
            return crowd
    ```
    """

    gait: Gait | None = None
    through_walls: bool = False
    meets_teams: bool = False

    @abstractmethod
    def reset(self, slots: NDArray[np.int64], scenarios: Sequence[Scenario], total: int) -> Crowd:
        """Begin ``scenarios`` in these slots, indices (K,) into ``total`` worlds, and return the crowd of all worlds.

        Raises ImpossibleScenario for a person who cannot stand where the scenario says.
        """

    @abstractmethod
    def step(self, crowd: Crowd, robots: RobotBatch, ticks: NDArray[np.int64], dt: float) -> Crowd:
        """Return the crowd ``dt`` seconds later, where it wants to be; ``ticks`` (N,) count the inner steps
        since each episode began.
        """

    def watch_doors(self, doors_open: NDArray[np.bool_]) -> None:  # noqa: B027 - people may know no doors
        """See which doors (N, D) are open, False beyond those of a world; called before each ``step`` where there are
        any. At ``reset`` they are as their timetables say.
        """

    def fork(self, branches: Branches) -> PedestrianModel:
        """Return a model of its own, whose worlds go on from those of this one; neither knows of the other.

        Raises ConfigurationError where the model cannot: an author's first version need not.
        """
        raise ConfigurationError(f"{type(self).__name__} cannot be forked; allowed: people whose model has fork()")

    def walks(self, crowd: Crowd) -> NDArray[np.bool_]:
        """Tell who in the crowd (N, P) walks on two legs, unlike a forklift; asked after each ``reset``."""
        return np.ones(crowd.ids.shape, np.bool_)


@dataclass(frozen=True, slots=True, eq=False)
class Snapshot:
    """N worlds at one instant, as a simulator returns them; ``state`` and ``sensors`` give single ones.

    Of worlds with ``team`` robots each, arrays of robots have a row for each robot: row k * team + m is robot m of
    world k, and ``state`` and ``sensors`` take rows. With one robot a world a row is a world.

    Arrays with leading axis N: ``stamps`` s, ``poses`` (N, 3), ``twists`` (N, 3) in ``base_link``, ``clearances``,
    ``clearances_people`` m, ``in_contact``, ``contact_times`` s, ``ranges`` (N, B) float32 m, ``scan_stamps`` s,
    ``odometry_stamps`` s, ``odometry_poses`` (N, 3), ``odometry_twists`` (N, 3). Where robots have depth cameras,
    ``depths`` (N, H, W) float32 m and ``depth_stamps`` (N,) s are their newest images, and ``depth_header`` what they
    have in common. ``failures`` say of each world in which the simulation cannot go on why: its robot stands from then
    on. Where scenarios have doors, ``doors_open`` (N, D) says which are open, False beyond those of a world. Where
    robots are of several types, ``scan_headers`` has each row's own, with as many ranges as its lidar has beams.
    """

    stamps: FloatArray
    poses: FloatArray
    twists: FloatArray
    crowd: Crowd
    clearances: FloatArray
    clearances_people: FloatArray
    in_contact: NDArray[np.bool_]
    contact_times: FloatArray
    contacts: tuple[tuple[Contact, ...], ...]
    ranges: NDArray[np.float32]
    scan_stamps: FloatArray
    odometry_stamps: FloatArray
    odometry_poses: FloatArray
    odometry_twists: FloatArray
    scan_header: LaserScan
    failures: Mapping[int, str] = field(default_factory=dict)
    depths: NDArray[np.float32] | None = None
    depth_stamps: FloatArray | None = None
    depth_header: DepthImage | None = None
    doors_open: NDArray[np.bool_] | None = None
    team: int = 1
    scan_headers: tuple[LaserScan, ...] = ()

    def state(self, slot: int) -> WorldState:
        """Return the truth of world ``slot``, or of its robot where worlds have teams."""
        return WorldState(
            float(self.stamps[slot]),
            Pose.of(self.poses[slot]),
            Twist.of(self.twists[slot]),
            self.crowd.world(slot // self.team),
            float(self.clearances[slot]),
            float(self.clearances_people[slot]),
            bool(self.in_contact[slot]),
            float(self.contact_times[slot]),
            self.contacts[slot],
            np.zeros(0, np.bool_) if self.doors_open is None else self.doors_open[slot],
        )

    def sensors(self, slot: int) -> Sensors:
        """Return what the robot of world ``slot`` measures."""
        head, ranges = self.scan_header, self.ranges[slot]
        if self.scan_headers:
            head = self.scan_headers[slot]
            ranges = ranges[: len(head.ranges)]
        beams = head.angle_min, head.angle_increment, head.range_min, head.range_max
        scan = LaserScan(float(self.scan_stamps[slot]), *beams, ranges.copy(), head.mount)
        odometry = Odometry(
            float(self.odometry_stamps[slot]), Pose.of(self.odometry_poses[slot]), Twist.of(self.odometry_twists[slot])
        )
        return Sensors(float(self.stamps[slot]), scan, odometry, Pose.of(self.poses[slot]), self._depth(slot))

    def _depth(self, slot: int) -> DepthImage | None:
        if self.depths is None or self.depth_stamps is None or self.depth_header is None:
            return None
        return replace(self.depth_header, stamp=float(self.depth_stamps[slot]), depths=self.depths[slot].copy())


class Simulator(ABC):
    """Moves N robots and their people, and senses: what an environment of Gymnasium is without reward and goal.

    Life cycle: built once in each process of a run with ``robot: Robot``, ``pedestrians: PedestrianModel`` and the keys
    of its YAML; ``reset`` when episodes begin, then ``advance`` at each control step.

    Attributes:

    - ``inner_step``: the length of a tick, s; control, lidar and odometry periods are multiples of it.
    - ``moves_teams``: whether scenarios may have a team. Then M is the largest team's number of robots, and commands
      and snapshots have N M rows, row k * M + m for robot m of world k; the robots that a smaller team lacks are not in
      the world.

    ```python
    def drive_forward(simulator: Simulator, scenario: Scenario, seconds: float) -> WorldState:
        simulator.reset([scenario])
        return simulator.advance(np.array([[0.5, 0.0, 0.0]]), round(seconds / simulator.inner_step)).state(0)
    ```
    """

    inner_step: float
    moves_teams: bool = False

    @abstractmethod
    def reset(self, scenarios: Sequence[Scenario], slots: NDArray[np.int64] | None = None) -> Snapshot:
        """Begin ``scenarios`` and return what then is: in all worlds, or only in these ``slots``, indices (K,)."""

    def check_scenario(self, scenario: Scenario) -> None:  # noqa: B027 - most take every one
        """Raise ConfigurationError for a scenario that this simulator cannot move; the first one of a run of teams is
        asked about before anything runs.
        """

    @abstractmethod
    def advance(self, commands: FloatArray, ticks: int) -> Snapshot:
        """Hold ``commands`` (N, 3), vx, vy in m/s and wz in rad/s in ``base_link``, for ``ticks`` inner steps.

        Returns what then is. Robots keep their limits whatever is commanded, and bodies never interpenetrate. A world
        that cannot go on is one of the snapshot's ``failures``; the others are not touched by it.
        """

    def fork(self, branches: Branches) -> Simulator:
        """Return a simulator of its own, whose world k goes on from world ``branches.slots[k]`` of this one, now.

        With the same commands it does what the original does, bit for bit; neither knows of the other. Where a robot is
        left out, its pose is NaN, and people walk as if it had never been there. Raises ConfigurationError where the
        simulator, or its people, cannot be forked.
        """
        raise ConfigurationError(f"{type(self).__name__} cannot be forked; allowed: a simulator that has fork()")
