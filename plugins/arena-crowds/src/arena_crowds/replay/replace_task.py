"""Problems in which the robot takes the place of a recorded person."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from arena_core import (
    ConfigurationError,
    ImpossibleScenario,
    OccupancyGrid,
    Pose,
    Robot,
    Scenario,
    TaskMode,
    World,
    WorldSource,
)
from arena_core.files import local_path
from arena_core.parameters import NonNegative, Positive
from arena_core.scenes import add_furniture
from arena_core.tasks import RecordedWalk
from arena_crowds.replay.recordings import Format, Recording, read_recording
from arena_crowds.replay.scale import Unit
from arena_kernels.distance import grid_distance

Floats = NDArray[np.float64]
LOOK_AHEAD = 0.5  # m of a walk by which the robot's first heading is that of the person


@dataclass(frozen=True, slots=True)
class RecordingParameters:
    """A recording as the ``model`` of people, replay, reads it, where it lies in ``map``, and the ``radius`` of its
    people, m.
    """

    model: str
    path: str
    format: Format
    unit: Unit | None
    frame_rate: Positive | None
    offset_xy: Sequence[float]
    rotation: float
    radius: Positive

    def read(self) -> Recording:
        """Read the file; raise InputFileError, and ConfigurationError where no recorded people walk."""
        if self.model != "replay":
            raise ConfigurationError(f"pedestrians is {self.model} with task=replace; allowed: pedestrians=replay")
        recording = read_recording(local_path(self.path), self.format, self.frame_rate, self.unit)
        return recording.transform(np.array(self.offset_xy, np.float64), self.rotation)


@dataclass(frozen=True, slots=True)
class WalkParameters:
    """Which walks a robot can take over: so long (m, straight) and (s), with so much ``room`` (m) about its body.

    It has ``time_share`` times the time of a walk.
    """

    least_distance: Positive
    least_time: Positive
    room: NonNegative
    time_share: Positive


class ReplaceTask(TaskMode):
    """Scenario ``index`` is that of the next recorded person whose walk a robot can take over, in the order of time;
    after the last one the first comes again.

    The robot starts where and when the person appeared, heads as they did, and is to go where they vanished.
    The others are those of ``pedestrians=replay``.
    """

    def __init__(
        self,
        robot: Robot,
        world: WorldSource,
        recording: RecordingParameters,
        walks: WalkParameters,
        goal_radius: Positive,
    ) -> None:
        self._robot, self._world, self._rules = robot, world, walks
        self._recording, self._radius = recording.read(), recording.radius
        self._goal_radius = goal_radius
        self._order = np.argsort(self._recording.begins, kind="stable")
        self._fitting: tuple[OccupancyGrid, list[int]] | None = None
        if not any(self._is_long(walk) for walk in self._order.tolist()):
            raise ConfigurationError(
                f"{recording.path}: nobody walks {walks.least_distance:g} m in {walks.least_time:g} s or more; "
                "allowed: a recording of longer walks, or a lower task.walks.least_distance"
            )

    def scenario(self, seed: int, index: int) -> Scenario:
        """Return problem ``index``; raise ImpossibleScenario where nobody's walk fits the world."""
        world = self._world.world(seed, index)
        fitting = self._fitting_walks(world)
        if not fitting:
            raise ImpossibleScenario(f"no recorded walk begins and ends in free space of world {world.name}")
        walk = self._walk(fitting[index % len(fitting)])
        (x, y), (goal_x, goal_y) = walk.positions_xy[0].tolist(), walk.positions_xy[-1].tolist()
        away = np.hypot(*(walk.positions_xy - walk.positions_xy[0]).T)
        ahead = walk.positions_xy[int(np.argmax(away >= min(LOOK_AHEAD, away.max())))] - walk.positions_xy[0]
        return Scenario(
            f"replace/{walk.person}/{index // len(fitting):04d}",
            seed,
            world,
            Pose(x, y, float(np.arctan2(ahead[1], ahead[0]))),
            Pose(goal_x, goal_y),
            (),
            (),
            self._goal_radius,
            float(self._rules.time_share * walk.stamps[-1]),
            replaces=walk,
        )

    def _walk(self, number: int) -> RecordedWalk:
        recording = self._recording
        rows = slice(recording.first[number], recording.first[number + 1])
        stamps = recording.stamps[rows]
        return RecordedWalk(
            int(recording.ids[number]), float(stamps[0]), stamps - stamps[0], recording.positions[rows].copy()
        )

    def _is_long(self, number: int) -> bool:
        walk = self._walk(number)
        straight = float(np.hypot(*(walk.positions_xy[-1] - walk.positions_xy[0])))
        seen = np.diff(walk.stamps).max(initial=0.0) <= self._recording.longest_gap
        return bool(straight >= self._rules.least_distance and walk.stamps[-1] >= self._rules.least_time and seen)

    def _fitting_walks(self, world: World) -> list[int]:
        """Return the walks that fit a world, in the order of time."""
        if self._fitting is None or self._fitting[0] is not world.grid:
            self._fitting = world.grid, [number for number in self._order.tolist() if self._fits(number, world)]
        return self._fitting[1]

    def _fits(self, number: int, world: World) -> bool:
        """Return whether the robot has room where a walk begins and ends, and nobody stands in its start."""
        if not self._is_long(number):
            return False
        walk, grid = self._walk(number), add_furniture(world)
        ends = walk.positions_xy[[0, -1]]
        inside = grid.contains(grid.cells(ends)).all()
        need = self._robot.footprint.radius + self._rules.room
        if not inside or grid.derive(grid_distance)[tuple(grid.cells(ends).T)].min() < need:
            return False
        others = np.delete(np.arange(len(self._recording.ids)), number)
        places, _ = self._recording.at(others, np.full(len(others), walk.begin))
        away = np.hypot(*(places - ends[0]).T)
        return not bool((away < need + self._radius).any())
