"""The interfaces of a robot's brain: it works on single values; what training shares works on N robots at once."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from arena_core.base.errors import ArenaError
from arena_core.base.once import Once
from arena_core.contracts.truth import BrainPart
from arena_core.values.candidate import Candidate
from arena_core.values.episode import EpisodeStart
from arena_core.values.geometry import FloatArray, Pose, Twist
from arena_core.values.predictions import Predictions
from arena_core.values.sensing import LaserScan, Observation, PoseEstimate, Sensors, Tracks
from arena_core.values.world import INSCRIBED, Costmap, OccupancyGrid, Path

_ALONE = np.zeros(1, np.int64)  # the slot of a robot that is alone


class Planner(BrainPart):
    """A local planner: turns an observation into a velocity command.

    Life cycle: built once in each process of a run; for every episode ``reset`` once, then ``compute_velocity`` at each
    control step. The constructor receives ``robot: Robot`` and, by keyword, exactly the keys of its YAML. A deep copy
    goes on as the planner would; what never changes may be shared by a ``__deepcopy__``.

    Attributes:

    - ``compiles``: whether the first command waits for a compiler. The planner then decides once before the first
      episode, outside any measured time, and is reset.
    - ``untuned``: lines on what of it was made for another robot; a run prints and keeps them.
    - ``learned_by``: how it learned, such as "imitation of teb, 20000 decisions"; empty where it did not.
    - ``drives_team``: whether it drives all robots of its team, also those for which a scenario names other planners.

    ```python
    class Straight(Planner):
        def __init__(self, robot: Robot) -> None:
            self.speed = robot.limits.vx_max

        def compute_velocity(self, observation: Observation) -> Twist:
            return Twist(self.speed, 0.0, observation.pose.relative(observation.waypoint).y)
    ```
    """

    compiles: ClassVar[bool] = False
    drives_team: ClassVar[bool] = False
    untuned: tuple[str, ...] = ()
    learned_by: str = ""

    def reset(self, episode: EpisodeStart) -> None:
        """Forget the episode before; nothing but compiled solvers may survive.

        ``episode`` has the static map (None in an unknown world), the goal in ``map``, the control period in s and the
        random generator of this planner in this episode.
        """

    @abstractmethod
    def compute_velocity(self, observation: Observation) -> Twist:
        """Return the command for the coming control period, in ``base_link``: m/s and rad/s.

        It need not keep the robot's limits: the simulator does. Raises NoValidCommand when there is none: the robot
        brakes, and the event is counted. Any other exception, and a number that is not finite, ends the episode with
        the outcome ``error``.
        """

    def considered(self) -> Sequence[Candidate] | None:
        """Return what the last ``compute_velocity`` weighed, None where the planner does not tell.

        Called after the command, outside of its time, only where a run records it. It must not change later commands.
        """
        return None

    def notes(self) -> Mapping[str, float | str]:
        """Return what the planner has to tell of the episode: its record keeps it as ``notes``, if there is anything.

        Called once, when the episode is over.
        """
        return {}

    def driving(self) -> str | None:
        """Return the name of the member that gave the last command; None for a
        planner that is no switch between several.
        """
        return None


class Localizer(BrainPart):
    """Estimates the robot's pose in ``map`` from its sensors.

    Life cycle: for every episode ``reset`` once, then ``update`` at each control step, before all else.

    Attributes:

    - ``needs_map``: whether it works only with a static map. With ``world.known=false`` it is then refused before
      anything runs.

    ```python
    class DeadReckoning(Localizer):
        def reset(self, grid, start, random) -> None:
            self.origin = None
            self.start = start

        def update(self, sensors: Sensors) -> PoseEstimate:
            self.origin = self.origin or sensors.odometry.pose
            driven = self.origin.relative(sensors.odometry.pose)
            return PoseEstimate(self.start.compose(driven), np.diag((0.01, 0.01, 0.01)))
    ```
    """

    needs_map: ClassVar[bool] = False

    @abstractmethod
    def reset(self, grid: OccupancyGrid | None, start: Pose, random: np.random.Generator) -> None:
        """Begin an episode at the believed pose ``start``, in ``map``.

        ``grid`` is the static map, None in an unknown world; ``random`` is this localiser's generator in this episode.
        """

    @abstractmethod
    def update(self, sensors: Sensors) -> PoseEstimate:
        """Return the estimate at ``sensors.stamp``, s; the scan has a stamp of its own."""


class ReferenceLocalizer(Localizer):
    """Estimates from the pose of an external positioning system alone (in simulation: exact), and so for N robots at
    once.

    Life cycle: ``begin`` for slots whose episode is new, then ``estimates`` at each control step. Robots share one
    localiser, each in a slot of its own; alone, a robot has slot 0 of one.
    """

    @abstractmethod
    def begin(self, keys: NDArray[np.uint64], slots: NDArray[np.int64], total: int) -> None:
        """Begin episodes in K ``slots`` of ``total``, each with the key (K,) of its random stream."""

    @abstractmethod
    def estimates(self, poses: FloatArray, slots: NDArray[np.int64]) -> FloatArray:
        """Return new estimates (K, 3) in ``map`` for robots in K ``slots`` that are at ``poses`` (K, 3) now;
        asked once a control step.
        """

    def covariance(self, pose: FloatArray) -> FloatArray:
        """Return the covariance (3, 3) of an estimate (3,)."""
        return np.zeros((3, 3))

    def reset(self, grid: OccupancyGrid | None, start: Pose, random: np.random.Generator) -> None:
        """Begin an episode; neither map nor start is used."""
        self.begin(random.integers(2**64, size=1, dtype=np.uint64), _ALONE, 1)

    def update(self, sensors: Sensors) -> PoseEstimate:
        """Return the estimate; raise ArenaError when the sensors carry no reference."""
        if sensors.reference is None:
            raise ArenaError(
                f"{type(self).__name__} needs sensors.reference, which only simulators give; use localizer=amcl"
            )
        estimate = self.estimates(sensors.reference.array()[None], _ALONE)[0]
        return PoseEstimate(Pose.of(estimate), self.covariance(estimate))


class GlobalPlanner(BrainPart):
    """Plans a path on a grid.

    Life cycle: built once; it keeps nothing from one ``plan`` to the next but what it derives from a grid
    (``grid.derive``). ``plan`` is called whenever a path is due, ``cost`` after a periodic one.

    ```python
    class Beeline(GlobalPlanner):
        def plan(self, grid: OccupancyGrid, start: Pose, goal: Pose) -> Path:
            path = Path(np.linspace(start.array(), goal.array(), 200))
            if math.isinf(self.cost(grid, path)):
                raise NoPath("something is on the straight line")
            path.poses[:, 2] = math.atan2(goal.y - start.y, goal.x - start.x)
            return path
    ```
    """

    @abstractmethod
    def plan(self, grid: OccupancyGrid, start: Pose, goal: Pose) -> Path:
        """Return a path from ``start`` to ``goal``, all in ``map``; raise NoPath when there is none."""

    def cost(self, grid: OccupancyGrid, path: Path) -> float:
        """Return what a path costs on a grid, to compare it with others of this planner; inf where it is blocked.

        Unless a planner knows better: its length, inf where a pose lies in an occupied cell.
        """
        cells = grid.cells(path.poses[:, :2])
        inside = cells[grid.contains(cells)]
        return float("inf") if grid.occupied[inside[:, 0], inside[:, 1]].any() else path.length

    def is_narrow(self, grid: OccupancyGrid, path: Path) -> bool:
        """Return whether a path leads through a passage that is too narrow for the planner at
        hand; False if it cannot tell.
        """
        return False


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
    """One waypoint a world: ``poses`` (N, 3) in ``map`` and ``status`` (N,) int8, WAYPOINT_FOUND
    or why a new path is needed.
    """

    poses: FloatArray
    status: NDArray[np.int8]


class WaypointGenerator(BrainPart):
    """Puts the intermediate goal ahead on the path, for N robots at once; one robot is a batch of one.

    Life cycle: ``reset`` for slots whose episode or path is new, then ``next`` at each control step. Slot k of N must
    equal a batch of one, bit for bit.

    ```python
    class Last(WaypointGenerator):
        def reset(self, slots, total) -> None:
            pass

        def next(self, paths: PathBatch, poses, stamps, slots=None) -> Waypoints:
            return Waypoints(paths.poses[paths.offsets[1:] - 1], np.full(len(poses), WAYPOINT_FOUND, np.int8))
    ```
    """

    @abstractmethod
    def reset(self, slots: NDArray[np.int64], total: int) -> None:
        """Forget what was kept for these slots, indices (K,) into ``total`` worlds."""

    @abstractmethod
    def next(
        self, paths: PathBatch, poses: FloatArray, stamps: FloatArray, slots: NDArray[np.int64] | None = None
    ) -> Waypoints:
        """Return the waypoint of each robot at ``poses`` (K, 3), ``stamps`` (K,) s, on K
        ``paths``: those in ``slots``, None: in all.
        """


class Window:
    """A local map's window after a scan: what is asked of it is computed then, at the latest
    before the next scan is taken in.
    """

    def __init__(self, costmap: Callable[[], Costmap]) -> None:
        self.costmap = Once(costmap)

    def is_blocked(self, x: FloatArray, y: FloatArray, robot: Pose) -> bool:
        """Return whether the robot would touch something on a path through (K,) positions in ``map``, m.

        From the one that is nearest to it, to the first that is outside the window.
        """
        first = int(((x - robot.x) ** 2 + (y - robot.y) ** 2).argmin())
        local_map = self.costmap()
        (rows, columns), (left, below) = local_map.costs.shape, local_map.origin_xy.tolist()
        column = ((x[first:] - left) / local_map.resolution).astype(np.int64)
        row = ((y[first:] - below) / local_map.resolution).astype(np.int64)
        # what is below 0 counts as very large
        outside = (column.view(np.uint64) >= columns) | (row.view(np.uint64) >= rows)
        end = int(outside.argmax()) if outside.any() else len(outside)
        return bool((local_map.costs[row[:end], column[:end]] >= INSCRIBED).any())


class LocalMap(BrainPart):
    """A rolling cost grid around the robot, from scan and map, as Nav2's local costmap.

    Life cycle: for every episode ``reset`` once, then ``update`` (or ``take_in``) at most once a control step, when the
    planner or the navigator asks for it; ``planning_grid`` with each new path; ``clear`` when the robot recovers.
    """

    @abstractmethod
    def reset(self, grid: OccupancyGrid | None) -> None:
        """Begin an episode; ``grid`` is the static map or None."""

    @abstractmethod
    def update(self, scan: LaserScan, pose: Pose) -> Costmap:
        """Take in one scan seen from ``pose`` (base_link in ``map`` at the scan's stamp) and return the window."""

    def take_in(self, scan: LaserScan, pose: Pose) -> Window:
        """Take in one scan as ``update`` does; a map that can is to compute no costs that no one asks for."""
        costmap = self.update(scan, pose)
        return Window(lambda: costmap)

    @abstractmethod
    def planning_grid(self, goal: Pose, *, all_marks: bool) -> OccupancyGrid:
        """Return the static map with the window's marks on it; without a map, all that scans have shown so far, unknown
        cells free.

        Unless ``all_marks``, those that may be walls of the map seen from a pose that is a little off are left out. A
        grid without a map beneath holds ``goal``.
        """

    def clear(self, pose: Pose, beyond: float) -> None:
        """Forget the marks of the window that are at least ``beyond`` m from ``pose``, as a
        recovery does; the map beneath stays.
        """


class Tracker(BrainPart):
    """Follows moving obstacles, from scan and pose alone.

    Life cycle: for every episode ``reset`` once, then ``update`` at most once a control step, when the planner asks for
    ``observation.tracks``.

    ```python
    class Blind(Tracker):
        def reset(self, grid) -> None:
            pass

        def update(self, scan: LaserScan, pose: Pose, stamp: float) -> Tracks:
            return NO_TRACKS
    ```
    """

    @abstractmethod
    def reset(self, grid: OccupancyGrid | None) -> None:
        """Begin an episode without tracks; ``grid`` is the static map, None in an unknown world."""

    @abstractmethod
    def update(self, scan: LaserScan, pose: Pose, stamp: float) -> Tracks:
        """Return the tracks at ``stamp`` (s), in ``map``; ``pose`` is where ``base_link`` was at the scan's stamp."""


class Predictor(BrainPart):
    """Foresees where tracked obstacles go.

    Life cycle: for every episode ``reset`` once, then ``predict`` at most once a control step, when the planner asks
    for ``observation.predictions``.

    ```python
    class Slowing(Predictor):
        def reset(self, grid) -> None:
            self.times = np.arange(0.0, 3.25, 0.25)

        def predict(self, observation: Observation) -> Predictions:
            tracks, ways = observation.tracks, 1.0 - np.exp(-self.times)
            means = tracks.positions[:, None] + tracks.velocities[:, None] * ways[:, None]
            covariances = np.tile(tracks.covariances[:, None, :2, :2], (1, len(self.times), 1, 1))
            return Predictions.of(self.times, means, covariances)
    ```
    """

    @abstractmethod
    def reset(self, grid: OccupancyGrid | None) -> None:
        """Begin an episode; ``grid`` is the static map, None in an unknown world."""

    @abstractmethod
    def predict(self, observation: Observation) -> Predictions:
        """Return where the observation's tracks will be, in their order; at time 0 they are where they are.

        It sees what a planner sees, which the ``observation`` holds, but for its ``predictions``. Anything else than
        finite numbers of the right shape ends the episode with the outcome ``error``.
        """
