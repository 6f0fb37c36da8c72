"""The local map: a rolling window of costs from scan and map."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from arena_core import Costmap, LaserScan, LocalMap, OccupancyGrid, Pose, Robot, Window
from arena_core.parameters import NonNegative, Positive
from arena_kernels.compiled import TypedDispatch
from arena_navigation.local_map.log_odds import LogOddsUpdate
from arena_navigation.local_map.mapping import ScanMap, with_marks
from arena_navigation.local_map.marks import NEVER, MarkingRange, PlacedScan
from arena_navigation.local_map.window import MapLayer, costs_of, covered_cells, is_path_blocked, move_window
from arena_navigation.planning.inflation import Inflation

Floats = NDArray[np.float64]


class RollingMap(LocalMap):
    """A window of ``size`` m around the robot whose cells lie at whole multiples of ``resolution`` in ``map``
    (docs/navigation.md).

    Hits mark cells, beams that pass clear them, and cells keep their marks while they stay in the window. The known map
    is a layer beneath that no scan clears. Without a map, all that scans have shown is kept, too.
    """

    def __init__(
        self,
        robot: Robot,
        size: Positive,
        resolution: Positive,
        obstacle_range: Positive,
        raytrace_range: Positive,
        inflation_radius: NonNegative,
        cost_scaling_factor: NonNegative,
        forget_after: Positive | None,
        mapping_range: Positive,
        evidence: LogOddsUpdate,
        *,
        use_map: bool,
    ) -> None:
        inscribed = robot.footprint.inscribed_radius
        self._cells = max(1, math.ceil(size / resolution - 1e-9))
        self._resolution = resolution
        self._reach = MarkingRange(
            obstacle_range, raytrace_range, inscribed, math.inf if forget_after is None else forget_after
        )
        self._mapping_reach = MarkingRange(mapping_range, mapping_range, inscribed, math.inf)
        self._evidence = evidence
        self._table = Inflation(inscribed, inflation_radius, cost_scaling_factor).table(resolution)
        self._use_map = use_map
        self._body = covered_cells(self._table)
        self._moved_on, self._costs_of, self._blocked_way = (
            TypedDispatch(move_window),
            TypedDispatch(costs_of),
            TypedDispatch(is_path_blocked),
        )
        self.reset(None)

    def reset(self, grid: OccupancyGrid | None) -> None:
        """Begin an episode with no marks."""
        self._grid = grid
        self._layer = MapLayer.of(grid if self._use_map else None, self._resolution)
        self._seen = ScanMap(self._resolution, self._mapping_reach, self._evidence) if grid is None else None
        self._corner = (0, 0)  # of the window, in cells: row, column
        self._hit_at = np.full((self._cells, self._cells), NEVER, np.float32)
        self._static = np.zeros((self._cells, self._cells), np.uint8)
        self._placed = False

    def update(self, scan: LaserScan, pose: Pose) -> Costmap:
        """Take in one scan and return the window around ``pose``."""
        return self.take_in(scan, pose).costmap()

    def take_in(self, scan: LaserScan, pose: Pose) -> Window:
        """Take in one scan; costs and distances of the window around ``pose`` are
        computed when they are asked for.
        """
        beams = PlacedScan.of(scan, pose)
        self._move_to(pose, beams)
        if self._seen is not None:
            self._seen.update(beams)
        return _RollingWindow(self._make_costmap, self._is_blocked)

    def clear(self, pose: Pose, beyond: float) -> None:
        """Forget the window's marks that are at least ``beyond`` m from ``pose``."""
        rows, columns = np.nonzero(self._hit_at > NEVER)
        centres = (np.stack((columns, rows), axis=1) + self._corner[::-1] + 0.5) * self._resolution
        far = np.hypot(*(centres - (pose.x, pose.y)).T) >= beyond
        self._hit_at[rows[far], columns[far]] = NEVER

    def planning_grid(self, goal: Pose, *, all_marks: bool) -> OccupancyGrid:
        """Return the map with the window's marks on it; without a map, all that scans
        have shown, grown to hold ``goal``.
        """
        if self._grid is None:
            assert self._seen is not None
            return self._seen.grid(goal)
        rows, columns = np.nonzero(self._hit_at > NEVER)
        return with_marks(
            self._grid, np.stack((columns, rows), axis=1) + self._corner[::-1], self._resolution, all_marks=all_marks
        )

    def _move_to(self, pose: Pose, beams: PlacedScan) -> None:
        """Centre the window on the robot's cell and take in a scan; cells that come into it take their
        static part from the map.
        """
        half = self._cells // 2
        corner = math.floor(pose.y / self._resolution) - half, math.floor(pose.x / self._resolution) - half
        moved = corner[0] - self._corner[0], corner[1] - self._corner[1]
        self._moved_on(self._hit_at, self._static, moved, corner, self._placed, self._layer, beams, self._reach)
        self._corner, self._placed = corner, True

    def _make_costmap(self) -> Costmap:
        costs, distance = self._costs_of(self._hit_at, self._static, self._resolution, self._table)
        return Costmap(costs, distance, self._resolution, np.array(self._corner[::-1]) * self._resolution)

    def _is_blocked(self, x: Floats, y: Floats, robot: Pose) -> bool:
        here = float(robot.x), float(robot.y)
        return self._blocked_way(self._hit_at, self._static, self._corner, self._resolution, self._body, x, y, here)


class _RollingWindow(Window):
    """A window whose costs are not needed to return whether a path runs into a marked cell."""

    def __init__(self, costmap: Callable[[], Costmap], is_blocked: Callable[[Floats, Floats, Pose], bool]) -> None:
        super().__init__(costmap)
        self._is_blocked = is_blocked

    def is_blocked(self, x: Floats, y: Floats, robot: Pose) -> bool:
        """Return whether the robot would touch something on a path through (K,) positions, as in ``Window``."""
        return self._is_blocked(x, y, robot)
