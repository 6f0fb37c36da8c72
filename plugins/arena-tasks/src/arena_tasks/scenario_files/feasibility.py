"""Whether a problem from a file can be run in a world: nobody in a wall, the goal within reach."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import shapely
from numpy.typing import NDArray
from scipy import ndimage

from arena_core import ImpossibleScenario, Obstacle, OccupancyGrid, Pose, Robot
from arena_kernels.distance import distance_field
from arena_tasks.scenario_files.problem import Problem

EIGHT_NEIGHBOURS = np.ones((3, 3), bool)


@dataclass(frozen=True, slots=True, eq=False)
class Feasibility:
    """A check for ``grid.derive``, so that it runs once for each world; raises ImpossibleScenario with file and key.

    It refuses what is certainly impossible: a start or goal that is off the map, on no known free cell or deeper in a wall
    than the robot's inscribed radius; a goal that no way with this radius joins to the start; people in walls or on the robot.
    """

    file: Path
    problem: Problem
    robot: Robot
    goal_radius: float

    def __call__(self, grid: OccupancyGrid) -> bool:
        """Return True, or raise."""
        problem = self.problem
        blocked = grid.occupied | _covered(problem.obstacles, grid)
        away = distance_field(blocked, grid.resolution)
        self._check_pose(grid, away, problem.start, problem.keys.start)
        self._check_pose(grid, away, problem.goal, problem.keys.goal)
        if problem.start.distance(problem.goal) <= self.goal_radius:
            raise self._impossible(problem.keys.goal, problem.goal, f"lies within the goal radius, {self.goal_radius:g} m, of the start")
        if not self._is_reachable(grid, away):
            raise self._impossible(problem.keys.goal, problem.goal, "cannot be reached from the start")
        for key, person in zip(problem.keys.people, problem.pedestrians, strict=True):
            for role, position in (
                ("its position", person.position_xy),
                *((f"its waypoint {k}", w) for k, w in enumerate(person.waypoints_xy)),
            ):
                self._check_person(grid, blocked, position, key, role)
            gap = np.hypot(*(person.position_xy - (problem.start.x, problem.start.y))) - person.radius
            if gap < self.robot.footprint.inscribed_radius:
                raise self._impossible(key, Pose(*person.position_xy.tolist()), "stands on the robot's start")
        return True

    def _check_pose(self, grid: OccupancyGrid, away: NDArray[np.float32], pose: Pose, key: str) -> None:
        row, column = grid.cells((pose.x, pose.y)).tolist()
        if not grid.contains(np.array((row, column))):
            raise self._impossible(key, pose, "lies outside the map")
        if grid.data[row, column] < 0:
            raise self._impossible(key, pose, "lies on an unknown cell")
        if away[row, column] <= max(self.robot.footprint.inscribed_radius - grid.resolution, 0.0):
            raise self._impossible(key, pose, "lies inside a wall or an obstacle")

    def _check_person(self, grid: OccupancyGrid, blocked: NDArray[np.bool_], position: NDArray[np.float64], key: str, role: str) -> None:
        cell = grid.cells(position)
        place = Pose(*position.tolist())
        if not grid.contains(cell):
            raise self._impossible(key, place, f"{role} lies outside the map")
        if blocked[tuple(cell)]:
            raise self._impossible(key, place, f"{role} lies inside a wall or an obstacle")

    def _is_reachable(self, grid: OccupancyGrid, away: NDArray[np.float32]) -> bool:
        radius = self.robot.footprint.inscribed_radius
        regions, _ = ndimage.label((away > radius) & (grid.data >= 0), EIGHT_NEIGHBOURS)
        # a robot that stands close to a wall may leave it, and a goal close to a wall is reached within the goal radius
        near_start = _labels_near(grid, regions, self.problem.start, radius + 2.0 * grid.resolution)
        near_goal = _labels_near(grid, regions, self.problem.goal, self.goal_radius)
        return bool(near_start & near_goal)

    def _impossible(self, key: str, place: Pose, why: str) -> ImpossibleScenario:
        return ImpossibleScenario(f"{self.file}: {key} ({place.x:.2f}, {place.y:.2f}) {why}")


def _labels_near(grid: OccupancyGrid, regions: NDArray[np.int32], pose: Pose, radius: float) -> set[int]:
    row, column = grid.cells((pose.x, pose.y)).tolist()
    reach = int(radius / grid.resolution) + 1
    window = regions[max(row - reach, 0) : row + reach + 1, max(column - reach, 0) : column + reach + 1]
    return set(np.unique(window).tolist()) - {0}


def _covered(obstacles: tuple[Obstacle, ...], grid: OccupancyGrid) -> NDArray[np.bool_]:
    """Return which cells have their centre in an obstacle, (H, W); each obstacle is asked for the cells about it alone."""
    covered = np.zeros(grid.data.shape, bool)
    for shape in map(_shape, obstacles):
        left, bottom, right, top = shape.bounds
        corners = grid.cells(((left, bottom), (left, top), (right, bottom), (right, top)))
        first, end = np.clip((corners.min(axis=0), corners.max(axis=0) + 1), 0, grid.data.shape)
        if (first < end).all():
            rows, columns = (np.arange(*ends) for ends in zip(first, end, strict=True))
            centres = grid.positions(np.stack(np.meshgrid(rows, columns, indexing="ij"), axis=-1))
            shapely.prepare(shape)
            covered[first[0] : end[0], first[1] : end[1]] |= shapely.contains_xy(shape, centres[..., 0], centres[..., 1])
    return covered


def _shape(obstacle: Obstacle) -> shapely.Geometry:
    if obstacle.radius > 0.0:
        return shapely.Point(obstacle.vertices_xy[0]).buffer(obstacle.radius)
    return shapely.Polygon(obstacle.vertices_xy)
