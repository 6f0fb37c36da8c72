"""The interfaces of what is simulated: worlds, tasks, people, and the simulator that steps N of them at once."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from arena_core.base.errors import ConfigurationError
from arena_core.values.episode import Contact, Scenario, WorldState
from arena_core.values.geometry import FloatArray, Pose, Twist
from arena_core.values.sensing import DepthImage, LaserScan, Odometry, Sensors
from arena_core.values.staging import Staging
from arena_core.values.world import Crowd, Gait, World


class WorldSource(ABC):
    """A source of worlds: a file gives always the same, a generator a new one for each (seed, index)."""

    @abstractmethod
    def world(self, seed: int, index: int) -> World:
        """Return the world of scenario ``index``."""

    def at(self, difficulty: float) -> WorldSource:
        """Return this source with worlds of another difficulty, 0 .. 1; raise
        ConfigurationError where worlds have none.
        """
        raise ConfigurationError(f"difficulty is {difficulty:g}, but this world has none; allowed: a generated world")


class TaskMode(ABC):
    """A seeded source of scenarios; a pure function of (seed, index).

    The constructor receives ``robot`` and ``world: WorldSource``.
    """

    @abstractmethod
    def scenario(self, seed: int, index: int) -> Scenario:
        """Return problem ``index``; raise ImpossibleScenario when there is none."""

    def count(self) -> int | None:
        """Return how many scenarios there are, None for no end."""
        return None

    def staging(self) -> Staging | None:
        """Return by which rule this task moves between its levels, None where it has none."""
        return None

    def at_stage(self, stage: int) -> TaskMode:
        """Return the task of one level, whose scenarios have this ``stage``; asked for only where there is a rule."""
        return self


@dataclass(frozen=True, slots=True, eq=False)
class RobotBatch:
    """N robots as the crowd meets them: ``poses`` (N, 3) in ``map``, ``velocities_xy`` (N, 2) in
    ``map`` m/s, ``radius`` m.
    """

    poses: FloatArray
    velocities_xy: FloatArray
    radius: float


class PedestrianModel(ABC):
    """How people walk, in N worlds at once; its simulator calls it and keeps bodies apart.

    People may leave and come: who is not in the world is at NaN, ABSENT. Who comes back elsewhere is absent for a step
    at least. The simulator lets no one appear in the robot's place: who is still absent in the crowd that ``step`` is
    given has to be put again.

    Where its configuration has a key ``reaction`` (to the robot: ignore, yield ...), tables tell cells apart by it.

    ``gait`` is how lidars see who ``walks``: as two legs; None: everybody is a disc. Contacts and clearances are those
    of discs always. ``through_walls``: nothing that stands stops them, for they walk as someone else has seen them
    walk.
    """

    gait: Gait | None = None
    through_walls: bool = False

    @abstractmethod
    def reset(self, slots: NDArray[np.int64], scenarios: Sequence[Scenario], total: int) -> Crowd:
        """Begin ``scenarios`` in these slots of ``total`` worlds and return the crowd of all worlds."""

    @abstractmethod
    def step(self, crowd: Crowd, robots: RobotBatch, ticks: NDArray[np.int64], dt: float) -> Crowd:
        """Return the crowd ``dt`` seconds later, where it wants to be; ``ticks`` (N,) count the inner steps
        since each episode began.
        """

    def walks(self, crowd: Crowd) -> NDArray[np.bool_]:
        """Tell who in the crowd (N, P) walks on two legs, unlike a forklift; asked after each ``reset``."""
        return np.ones(crowd.ids.shape, np.bool_)


@dataclass(frozen=True, slots=True, eq=False)
class Snapshot:
    """N worlds at one instant, as a simulator returns them; ``state`` and ``sensors`` give single ones.

    Arrays with leading axis N: ``stamps`` s, ``poses`` (N, 3), ``twists`` (N, 3) in ``base_link``, ``clearances``,
    ``clearances_people`` m, ``in_contact``, ``contact_times`` s, ``ranges`` (N, B) float32 m, ``scan_stamps`` s,
    ``odometry_stamps`` s, ``odometry_poses`` (N, 3), ``odometry_twists`` (N, 3). Where robots have depth cameras,
    ``depths`` (N, H, W) float32 m and ``depth_stamps`` (N,) s are their newest images, and ``depth_header`` what they
    have in common. ``failures`` say of each world in which the simulation cannot go on why: its robot stands from then
    on.
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

    def state(self, slot: int) -> WorldState:
        """Return the truth of world ``slot``."""
        return WorldState(
            float(self.stamps[slot]),
            Pose.of(self.poses[slot]),
            Twist.of(self.twists[slot]),
            self.crowd.world(slot),
            float(self.clearances[slot]),
            float(self.clearances_people[slot]),
            bool(self.in_contact[slot]),
            float(self.contact_times[slot]),
            self.contacts[slot],
        )

    def sensors(self, slot: int) -> Sensors:
        """Return what the robot of world ``slot`` measures."""
        head = self.scan_header
        beams = head.angle_min, head.angle_increment, head.range_min, head.range_max
        scan = LaserScan(float(self.scan_stamps[slot]), *beams, self.ranges[slot].copy(), head.mount)
        odometry = Odometry(
            float(self.odometry_stamps[slot]), Pose.of(self.odometry_poses[slot]), Twist.of(self.odometry_twists[slot])
        )
        return Sensors(float(self.stamps[slot]), scan, odometry, Pose.of(self.poses[slot]), self._depth(slot))

    def _depth(self, slot: int) -> DepthImage | None:
        if self.depths is None or self.depth_stamps is None or self.depth_header is None:
            return None
        return replace(self.depth_header, stamp=float(self.depth_stamps[slot]), depths=self.depths[slot].copy())


class Simulator(ABC):
    """Moves N robots and their people, and senses. The constructor receives ``robot`` and ``pedestrians:
    PedestrianModel``.

    ``inner_step`` is the length of a tick, s; control, lidar and odometry periods are multiples of it.
    """

    inner_step: float

    @abstractmethod
    def reset(self, scenarios: Sequence[Scenario], slots: NDArray[np.int64] | None = None) -> Snapshot:
        """Begin ``scenarios``: all worlds again, or only in these ``slots``."""

    @abstractmethod
    def advance(self, commands: FloatArray, ticks: int) -> Snapshot:
        """Hold ``commands`` (N, 3) for ``ticks`` inner steps and return what then is."""
