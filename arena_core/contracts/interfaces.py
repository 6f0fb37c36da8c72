"""The interfaces that plugins implement. One robot's brain works on single values; what training shares works on N worlds at once."""

from __future__ import annotations

import pathlib
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, ClassVar, Literal, TypeVar

import numpy as np
from numpy.typing import NDArray

from arena_core.base.errors import ArenaError, ConfigurationError
from arena_core.base.once import Once
from arena_core.values.candidate import Candidate
from arena_core.values.episode import Contact, EpisodeRecord, EpisodeStart, Scenario, WorldState
from arena_core.values.geometry import FloatArray, Pose, Twist
from arena_core.values.sensing import DepthImage, LaserScan, Observation, Odometry, PoseEstimate, Sensors, Tracks
from arena_core.values.staging import Staging
from arena_core.values.world import INSCRIBED, Costmap, Crowd, Gait, OccupancyGrid, Path, World

T = TypeVar("T")
_ALONE = np.zeros(1, np.int64)  # the slot of a robot that is alone
Better = Literal["higher", "lower", "neither"]  # what a reader wishes of a metric


class Planner(ABC):
    """A local planner: turns an observation into a velocity command.

    The constructor receives ``robot: Robot`` and, by keyword, exactly the keys of its YAML. A planner whose first command waits for
    a compiler says so by ``compiles``: it then decides once for nothing before its first episode, and is reset. ``untuned`` are lines,
    told and kept with the run, on what of it was made for another robot.
    """

    compiles: ClassVar[bool] = False
    untuned: tuple[str, ...] = ()

    def reset(self, episode: EpisodeStart) -> None:  # noqa: B027 - a planner without memory has nothing to reset
        """Forget the episode before; nothing but compiled solvers may survive."""

    @abstractmethod
    def compute_velocity(self, observation: Observation) -> Twist:
        """Return the command for the coming control period; raise NoValidCommand when there is none (the robot brakes)."""

    def considered(self) -> Sequence[Candidate] | None:
        """Return what the last ``compute_velocity`` weighed, None where that is not told; asked only where a run records it.

        It is asked after the command, outside of its time, and changes no later one.
        """
        return None


class Localizer(ABC):
    """Estimates the robot's pose in ``map`` from its sensors; one that ``needs_map`` is refused where the robot has none."""

    needs_map: ClassVar[bool] = False

    @abstractmethod
    def reset(self, grid: OccupancyGrid | None, start: Pose, random: np.random.Generator) -> None:
        """Begin an episode at the believed pose ``start``; ``grid`` is None in an unknown world."""

    @abstractmethod
    def update(self, sensors: Sensors) -> PoseEstimate:
        """Return the estimate at ``sensors.stamp``; the scan is matched at its own stamp."""


class ReferenceLocalizer(Localizer):
    """Estimates from the pose of an external positioning system alone (in simulation: exact), and so for N robots at once.

    ``begin`` and ``estimates`` are for robots that share one localiser, each in a slot of its own; alone, a robot has slot 0 of one.
    """

    @abstractmethod
    def begin(self, keys: NDArray[np.uint64], slots: NDArray[np.int64], total: int) -> None:
        """Begin episodes in K ``slots`` of ``total``, each with the key (K,) of its random stream."""

    @abstractmethod
    def estimates(self, poses: FloatArray, slots: NDArray[np.int64]) -> FloatArray:
        """Return new estimates (K, 3) in ``map`` for robots in K ``slots`` that are at ``poses`` (K, 3) now; asked once a control step."""

    def covariance(self, pose: FloatArray) -> FloatArray:
        """Return the covariance (3, 3) of an estimate (3,)."""
        return np.zeros((3, 3))

    def reset(self, grid: OccupancyGrid | None, start: Pose, random: np.random.Generator) -> None:
        """Begin an episode; neither map nor start is used."""
        self.begin(random.integers(2**64, size=1, dtype=np.uint64), _ALONE, 1)

    def update(self, sensors: Sensors) -> PoseEstimate:
        """Return the estimate; raise ArenaError when the sensors carry no reference."""
        if sensors.reference is None:
            raise ArenaError(f"{type(self).__name__} needs sensors.reference, which only simulators give; use localizer=amcl")
        estimate = self.estimates(sensors.reference.array()[None], _ALONE)[0]
        return PoseEstimate(Pose.of(estimate), self.covariance(estimate))


class GlobalPlanner(ABC):
    """Plans a path on a grid."""

    @abstractmethod
    def plan(self, grid: OccupancyGrid, start: Pose, goal: Pose) -> Path:
        """Return a path from start to goal; raise NoPath when there is none."""

    def cost(self, grid: OccupancyGrid, path: Path) -> float:
        """Return what a path costs on a grid, to compare it with others of this planner; inf where it is blocked.

        Unless a planner knows better: its length, inf where a pose lies in an occupied cell.
        """
        cells = grid.cells(path.poses[:, :2])
        inside = cells[grid.contains(cells)]
        return float("inf") if grid.occupied[inside[:, 0], inside[:, 1]].any() else path.length


@dataclass(frozen=True, slots=True, eq=False)
class PathBatch:
    """N paths, packed: ``poses`` (sum of lengths, 3); path k is ``poses[offsets[k]:offsets[k + 1]]``."""

    poses: FloatArray
    offsets: NDArray[np.int64]

    @staticmethod
    def of(paths: Sequence[Path]) -> PathBatch:
        """Pack paths."""
        offsets = np.cumsum([0, *(len(path.poses) for path in paths)])
        return PathBatch(np.concatenate([path.poses for path in paths]), offsets)


WAYPOINT_FOUND = 0
OFF_PATH = 1
WAYPOINT_TIMEOUT = 2
REPLAN_REASONS = {OFF_PATH: "off_path", WAYPOINT_TIMEOUT: "waypoint_timeout"}


@dataclass(frozen=True, slots=True, eq=False)
class Waypoints:
    """One waypoint a world: ``poses`` (N, 3) in ``map`` and ``status`` (N,) int8, WAYPOINT_FOUND or why a new path is needed."""

    poses: FloatArray
    status: NDArray[np.int8]


class WaypointGenerator(ABC):
    """Puts the intermediate goal ahead on the path, for N robots at once."""

    @abstractmethod
    def reset(self, slots: NDArray[np.int64], total: int) -> None:
        """Forget what was kept for these slots of ``total`` worlds."""

    @abstractmethod
    def next(self, paths: PathBatch, poses: FloatArray, stamps: FloatArray, slots: NDArray[np.int64] | None = None) -> Waypoints:
        """Return the waypoint of each robot at ``poses`` (K, 3), ``stamps`` (K,) s, on K ``paths``: those in ``slots``, None: in all."""


class Window:
    """A local map's window after a scan: what is asked of it is computed then, at the latest before the next scan is taken in."""

    def __init__(self, costmap: Callable[[], Costmap]) -> None:
        self.costmap = Once(costmap)

    def is_blocked(self, x: FloatArray, y: FloatArray, robot: Pose) -> bool:
        """Tell whether the robot would touch something on a path through (K,) positions in ``map``, m.

        From the one that is nearest to it, to the first that is outside the window.
        """
        first = int(((x - robot.x) ** 2 + (y - robot.y) ** 2).argmin())
        local_map = self.costmap()
        (rows, columns), (left, below) = local_map.costs.shape, local_map.origin_xy.tolist()
        column = ((x[first:] - left) / local_map.resolution).astype(np.int64)
        row = ((y[first:] - below) / local_map.resolution).astype(np.int64)
        outside = (column.view(np.uint64) >= columns) | (row.view(np.uint64) >= rows)  # what is below 0 counts as very large
        end = int(outside.argmax()) if outside.any() else len(outside)
        return bool((local_map.costs[row[:end], column[:end]] >= INSCRIBED).any())


class LocalMap(ABC):
    """A rolling cost grid around the robot, from scan and map."""

    @abstractmethod
    def reset(self, grid: OccupancyGrid | None) -> None:
        """Begin an episode; ``grid`` is the static map or None."""

    @abstractmethod
    def update(self, scan: LaserScan, pose: Pose) -> Costmap:
        """Take in one scan seen from ``pose`` (base_link in ``map`` at the scan's stamp) and return the window."""

    def take_in(self, scan: LaserScan, pose: Pose) -> Window:
        """Take in one scan as ``update`` does; a map that can is to compute no costs that nobody asks for."""
        costmap = self.update(scan, pose)
        return Window(lambda: costmap)

    @abstractmethod
    def planning_grid(self, goal: Pose, all_marks: bool) -> OccupancyGrid:
        """Return the static map with the window's marks on it; without a map, all that scans have shown so far, unknown cells free.

        Unless ``all_marks``, those that may be walls of the map seen from a pose that is a little off are left out. A grid without a map
        beneath holds ``goal``.
        """

    def clear(self, pose: Pose, beyond: float) -> None:  # noqa: B027 - a map without marks has nothing to clear
        """Forget the marks of the window that are at least ``beyond`` m from ``pose``, as a recovery does; the map beneath stays."""


class Tracker(ABC):
    """Follows moving obstacles, from scan and pose alone."""

    @abstractmethod
    def reset(self, grid: OccupancyGrid | None) -> None:
        """Begin an episode without tracks."""

    @abstractmethod
    def update(self, scan: LaserScan, pose: Pose, stamp: float) -> Tracks:
        """Return the tracks at ``stamp``."""


class WorldSource(ABC):
    """A source of worlds: a file gives always the same, a generator a new one for each (seed, index)."""

    @abstractmethod
    def world(self, seed: int, index: int) -> World:
        """Return the world of scenario ``index``."""

    def at(self, difficulty: float) -> WorldSource:
        """Return this source with worlds of another difficulty, 0 .. 1; raise ConfigurationError where worlds have none."""
        raise ConfigurationError(f"difficulty is {difficulty:g}, but this world has none; allowed: a generated world")


class TaskMode(ABC):
    """A seeded source of scenarios; a pure function of (seed, index). The constructor receives ``robot`` and ``world: WorldSource``."""

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
    """N robots as the crowd meets them: ``poses`` (N, 3) in ``map``, ``velocities_xy`` (N, 2) in ``map`` m/s, ``radius`` m."""

    poses: FloatArray
    velocities_xy: FloatArray
    radius: float


class PedestrianModel(ABC):
    """How people walk, in N worlds at once; its simulator calls it and keeps bodies apart.

    People may leave and come: who is not in the world is at NaN, ABSENT. Who comes back elsewhere is absent for a step at least. The
    simulator lets nobody appear in the robot's place: who is still absent in the crowd that ``step`` is given has to be put again.

    Where its configuration has a key ``reaction`` (to the robot: ignore, yield ...), tables tell cells apart by it.

    ``gait`` is how lidars see who ``walks``: as two legs; None: everybody is a disc. Contacts and clearances are those of discs always.
    """

    gait: Gait | None = None

    @abstractmethod
    def reset(self, slots: NDArray[np.int64], scenarios: Sequence[Scenario], total: int) -> Crowd:
        """Begin ``scenarios`` in these slots of ``total`` worlds and return the crowd of all worlds."""

    @abstractmethod
    def step(self, crowd: Crowd, robots: RobotBatch, ticks: NDArray[np.int64], dt: float) -> Crowd:
        """Return the crowd ``dt`` seconds later, where it wants to be; ``ticks`` (N,) count the inner steps since each episode began."""

    def walks(self, crowd: Crowd) -> NDArray[np.bool_]:
        """Tell who in the crowd (N, P) walks on two legs, unlike a forklift; asked after each ``reset``."""
        return np.ones(crowd.ids.shape, np.bool_)


@dataclass(frozen=True, slots=True, eq=False)
class Snapshot:
    """N worlds at one instant, as a simulator returns them; ``state`` and ``sensors`` give single ones.

    Arrays with leading axis N: ``stamps`` s, ``poses`` (N, 3), ``twists`` (N, 3) in ``base_link``, ``clearances``, ``clearances_people`` m,
    ``in_contact``, ``contact_times`` s, ``ranges`` (N, B) float32 m, ``scan_stamps`` s, ``odometry_stamps`` s, ``odometry_poses`` (N, 3),
    ``odometry_twists`` (N, 3). Where robots have depth cameras, ``depths`` (N, H, W) float32 m and ``depth_stamps`` (N,) s are their newest
    images, and ``depth_header`` what they have in common.
    ``failures`` say of each world in which the simulation cannot go on why: its robot stands from then on.
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
        odometry = Odometry(float(self.odometry_stamps[slot]), Pose.of(self.odometry_poses[slot]), Twist.of(self.odometry_twists[slot]))
        return Sensors(float(self.stamps[slot]), scan, odometry, Pose.of(self.poses[slot]), self._depth(slot))

    def _depth(self, slot: int) -> DepthImage | None:
        if self.depths is None or self.depth_stamps is None or self.depth_header is None:
            return None
        return replace(self.depth_header, stamp=float(self.depth_stamps[slot]), depths=self.depths[slot].copy())


class Simulator(ABC):
    """Moves N robots and their people, and senses. The constructor receives ``robot`` and ``pedestrians: PedestrianModel``.

    ``inner_step`` is the length of a tick, s; control, lidar and odometry periods are multiples of it.
    """

    inner_step: float

    @abstractmethod
    def reset(self, scenarios: Sequence[Scenario], slots: NDArray[np.int64] | None = None) -> Snapshot:
        """Begin ``scenarios``: all worlds anew, or only in these ``slots``."""

    @abstractmethod
    def advance(self, commands: FloatArray, ticks: int) -> Snapshot:
        """Hold ``commands`` (N, 3) for ``ticks`` inner steps and return what then is."""


@dataclass(frozen=True, slots=True)
class Metric:
    """One figure of an episode: ``compute(record)``, NaN where it is not defined. ``better`` is what a reader wishes for.

    What is true or false has the unit ``0/1``; a text has the unit ``text`` and is empty where it is not defined. ``path_metric`` marks
    figures that are reported over all *and* over successful episodes.
    """

    name: str
    unit: str
    better: Better
    description: str
    compute: Callable[[EpisodeRecord], float | str]
    path_metric: bool = False


class MetricPack(ABC):
    """A named set of metrics: pure functions of an EpisodeRecord.

    The columns of its metrics begin with its name and a dot, unless it is ``bare``, as one pack of a run may be.
    """

    bare: bool = False

    @abstractmethod
    def metrics(self) -> Sequence[Metric]:
        """Return the metrics of this pack, in the order of their columns."""


@dataclass(frozen=True, slots=True)
class Job:
    """One episode to run: its run's composed configuration (plain containers), folder, number, and the level of a task that adapts."""

    config: Mapping[str, Any]
    folder: str
    episode: int
    stage: int | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Finished:
    """What came of a job: its row of ``episodes.csv``, and whether the episode succeeded, which a task that adapts goes by."""

    job: Job
    row: Mapping[str, Any]
    succeeded: bool


@dataclass(frozen=True, slots=True)
class Lost:
    """A job that an executor could not bring to its end, and why, in one line."""

    job: Job
    reason: str


class Executor(ABC):
    """Runs jobs somewhere, in one call of ``map`` or several; ``work`` is picklable and never raises for a failed episode."""

    @abstractmethod
    def map(self, work: Callable[[Job], T], jobs: Sequence[Job]) -> Iterator[T | Lost]:
        """Yield what ``work`` returns of each job, in any order; ``Lost`` where it returns nothing."""

    def prepare(self, check: Callable[[Job], T], jobs: Sequence[Job]) -> Iterator[T | Lost]:
        """Run the checks that come before any ``map``, one a run: in this process, unless an executor can protect it from them."""
        return (check(job) for job in jobs)

    def close(self) -> None:  # noqa: B027 - an executor that keeps nothing between two calls has nothing to give back
        """Give back what was kept warm from one ``map`` to the next."""


class Reporter(ABC):
    """Says what runs have shown: pages for people, comparisons for programs."""

    @abstractmethod
    def report(self, folders: Sequence[pathlib.Path], target: pathlib.Path, baseline: str | None = None) -> None:
        """Write tables, pictures and a page over all runs at or below the folders to ``target``, and print what matters."""

    @abstractmethod
    def compare(self, folders: Sequence[pathlib.Path], baseline: str | None = None) -> Sequence[Mapping[str, Any]]:
        """Return how each planner differs from the baseline on the same scenarios: a row for each planner, condition and metric."""


class Listing(ABC):
    """Something beside components that ``arena list`` shows."""

    @abstractmethod
    def names(self) -> Sequence[str]:
        """Return what can be chosen."""

    @abstractmethod
    def summary(self) -> Sequence[str]:
        """Return a few lines for ``arena list``."""

    @abstractmethod
    def details(self) -> Sequence[str]:
        """Return the lines of ``arena list NAME``."""


class Command(ABC):
    """A subcommand of ``arena``."""

    help: ClassVar[str]

    @abstractmethod
    def run(self, arguments: Sequence[str]) -> int:
        """Run with the remaining arguments and return the exit status."""

    def complete(self, words: Sequence[str], word: str) -> Sequence[str]:
        """Return what the unfinished ``word`` after ``words`` can become, whole words; none: a shell offers the names of files."""
        return ()
