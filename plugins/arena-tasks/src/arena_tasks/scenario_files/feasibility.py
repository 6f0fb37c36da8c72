"""Whether a problem from a file can be run in a world: no one in a wall, the goal within reach."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import shapely
from numpy.typing import NDArray
from scipy import ndimage

from arena_core import ImpossibleScenario, Obstacle, OccupancyGrid, PedestrianSpec, Pose, Robot
from arena_kernels.distance import distance_field
from arena_tasks.scenario_files.problem import Problem

EIGHT_NEIGHBOURS = np.ones((3, 3), bool)


@dataclass(frozen=True, slots=True)
class Finding:
    """Why a problem is impossible: what is at ``key`` of its file, at (``x``, ``y``) m in ``map``, NaN
    where no place is at fault.
    """

    key: str
    x: float
    y: float
    why: str

    @property
    def line(self) -> str:
        """Return it in one line, without its file."""
        return f"{self.key} ({self.x:.2f}, {self.y:.2f}) {self.why}" if math.isfinite(self.x) else self.why


@dataclass(frozen=True, slots=True, eq=False)
class Feasibility:
    """A check for ``grid.derive``, so that it runs once for each world; raises ImpossibleScenario with file and key.

    It refuses what is certainly impossible: a start or goal that is off the map, on no known free cell or deeper in a
    wall than the robot's inscribed radius; a goal that no way with this radius joins to the start; people in walls or
    on the robot.
    """

    file: Path
    problem: Problem
    robot: Robot
    goal_radius: float

    def __call__(self, grid: OccupancyGrid) -> bool:
        """Return True, or raise."""
        for finding in self.findings(grid):
            raise ImpossibleScenario(f"{self.file}: {finding.line}")
        return True

    def findings(self, grid: OccupancyGrid) -> Iterator[Finding]:
        """Yield all that is impossible, start and goal first."""
        blocked = grid.occupied | _covered_cells(self.problem.obstacles, grid)
        ends = list(self._check_ends(grid, distance_field(blocked, grid.resolution)))
        yield from ends
        for key, person in zip(self.problem.keys.people, self.problem.pedestrians, strict=True):
            yield from self._check_person(grid, blocked, key, person)

    def _check_ends(self, grid: OccupancyGrid, away: NDArray[np.float32]) -> Iterator[Finding]:
        """Yield what is wrong with start and goal of each robot."""
        for start_key, start, goal_key, goal in self.problem.ways():
            wrong = [
                (key, pose, self._blocking_reason(grid, away, pose))
                for key, pose in ((start_key, start), (goal_key, goal))
            ]
            yield from (Finding(key, pose.x, pose.y, why) for key, pose, why in wrong if why)
            if start.distance(goal) <= self.goal_radius:
                yield Finding(
                    goal_key, goal.x, goal.y, f"lies within the goal radius, {self.goal_radius:g} m, of the start"
                )
            elif not any(why for *_, why in wrong) and not self._is_reachable(grid, away, start, goal):
                yield Finding(goal_key, goal.x, goal.y, "cannot be reached from the start")

    def _blocking_reason(self, grid: OccupancyGrid, away: NDArray[np.float32], pose: Pose) -> str:
        """Return why the robot cannot be at a pose; empty where it can."""
        row, column = grid.cells((pose.x, pose.y)).tolist()
        if not grid.contains(np.array((row, column))):
            return "lies outside the map"
        if grid.data[row, column] < 0:
            return "lies on an unknown cell"
        inside = away[row, column] <= max(self.robot.footprint.inscribed_radius - grid.resolution, 0.0)
        return "lies inside a wall or an obstacle" if inside else ""

    def _check_person(
        self, grid: OccupancyGrid, blocked: NDArray[np.bool_], key: str, person: PedestrianSpec
    ) -> Iterator[Finding]:
        """Yield what is wrong with where a person is and goes."""
        roles = ["its position", *(f"its waypoint {number}" for number in range(len(person.waypoints_xy)))]
        for role, (x, y) in zip(roles, [person.position_xy.tolist(), *person.waypoints_xy.tolist()], strict=True):
            cell = grid.cells((x, y))
            if not grid.contains(cell):
                yield Finding(key, x, y, f"{role} lies outside the map")
            elif blocked[tuple(cell)]:
                yield Finding(key, x, y, f"{role} lies inside a wall or an obstacle")
        x, y = person.position_xy.tolist()
        if (
            math.hypot(x - self.problem.start.x, y - self.problem.start.y) - person.radius
            < self.robot.footprint.inscribed_radius
        ):
            yield Finding(key, x, y, "stands on the robot's start")

    def _is_reachable(self, grid: OccupancyGrid, away: NDArray[np.float32], start: Pose, goal: Pose) -> bool:
        radius = self.robot.footprint.inscribed_radius
        regions, _ = ndimage.label((away > radius) & (grid.data >= 0), EIGHT_NEIGHBOURS)
        # a robot that stands close to a wall may leave it, and a goal close to a wall is reached within the goal radius
        near_start = _labels_near(grid, regions, start, radius + 2.0 * grid.resolution)
        near_goal = _labels_near(grid, regions, goal, self.goal_radius)
        return bool(near_start & near_goal)


def _labels_near(grid: OccupancyGrid, regions: NDArray[np.int32], pose: Pose, radius: float) -> set[int]:
    row, column = grid.cells((pose.x, pose.y)).tolist()
    reach = int(radius / grid.resolution) + 1
    window = regions[max(row - reach, 0) : row + reach + 1, max(column - reach, 0) : column + reach + 1]
    return set(np.unique(window).tolist()) - {0}


def _covered_cells(obstacles: tuple[Obstacle, ...], grid: OccupancyGrid) -> NDArray[np.bool_]:
    """Return which cells have their centre in an obstacle, (H, W); each obstacle is asked for
    the cells about it alone.
    """
    covered = np.zeros(grid.data.shape, bool)
    for shape in map(_obstacle_shape, obstacles):
        left, bottom, right, top = shape.bounds
        corners = grid.cells(((left, bottom), (left, top), (right, bottom), (right, top)))
        first, end = np.clip((corners.min(axis=0), corners.max(axis=0) + 1), 0, grid.data.shape)
        if (first < end).all():
            rows, columns = (np.arange(*ends) for ends in zip(first, end, strict=True))
            centres = grid.positions(np.stack(np.meshgrid(rows, columns, indexing="ij"), axis=-1))
            shapely.prepare(shape)
            covered[first[0] : end[0], first[1] : end[1]] |= shapely.contains_xy(
                shape, centres[..., 0], centres[..., 1]
            )
    return covered


def _obstacle_shape(obstacle: Obstacle) -> shapely.Geometry:
    if obstacle.radius > 0.0:
        return shapely.Point(obstacle.vertices_xy[0]).buffer(obstacle.radius)
    return shapely.Polygon(obstacle.vertices_xy)
