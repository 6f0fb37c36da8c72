"""The global planner that puts its queries to OMPL's sampling-based planners."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from arena_core import UNKNOWN, ConfigurationError, GlobalPlanner, NoPath, OccupancyGrid, Path, Pose, Robot, stream_key
from arena_core.parameters import NonNegative, NonNegativeInt, Positive, PositiveInt
from arena_ompl.algorithms import NOT_FOR_CARS, NOT_FOR_DUBINS, Algorithm
from arena_ompl.curves import DUBINS, REEDS_SHEPP, STRAIGHT
from arena_ompl.ground import ROUNDING, CostField, Field, ObstacleField, body_clearance, body_discs, reachable_cells
from arena_ompl.motions import Motions, Poses, Rules
from arena_ompl.search import Effort, Query, XYTheta, find_path
from arena_ompl.smoothing import smooth_path

Cell = tuple[int, int]

_NEARER = 1e-3  # m: how much nearer than at its start a robot that starts too near may come
_SEEDS = 2**31 - 2  # OMPL takes a seed of 32 bits, not 0


@dataclass(frozen=True, slots=True)
class Nearness:
    """What nearness to obstacles costs: ``weight`` exp(-``scaling`` clearance) a metre within
    ``inflation_radius`` m of them.
    """

    weight: NonNegative
    scaling: NonNegative
    inflation_radius: NonNegative


@dataclass(frozen=True, slots=True)
class Car:
    """How Ackermann robots are planned for; ``turning_slack`` is the least turning radius over the robot's own."""

    curves: Literal["dubins", "reeds_shepp"]
    turning_slack: Positive
    discs: PositiveInt
    goal_headings: PositiveInt


class OmplPlanner(GlobalPlanner):
    """Searches with one of OMPL's planners, then shortens and smooths what it found (docs/ompl.md)."""

    def __init__(
        self,
        robot: Robot,
        algorithm: Algorithm,
        evaluations: PositiveInt,
        seed: int,
        motion_range: Positive | None,
        nearness: Nearness,
        car: Car,
        tolerance: NonNegative,
        spacing: Positive,
        smoothing_rounds: NonNegativeInt,
        *,
        allow_unknown: bool,
    ) -> None:
        self._effort = Effort(algorithm, evaluations, motion_range, nearness.weight > 0.0)
        self._seed = seed
        self._steering = _steering_curves(robot, car, algorithm)
        self._discs = body_discs(robot, car.discs)
        self._field = ObstacleField(float(self._discs[0, 2]), allow_unknown)
        self._inscribed_radius = robot.footprint.inscribed_radius
        self._reach = 2.0 * robot.footprint.radius
        influence = max(0.0, nearness.inflation_radius - self._inscribed_radius)
        self._prices = CostField(self._field, nearness.weight, nearness.scaling, influence)
        self._goal_headings = 1 if self._steering[0] == STRAIGHT else car.goal_headings
        self._tolerance = tolerance
        self._spacing = spacing
        self._smoothing_rounds = smoothing_rounds

    def plan(self, grid: OccupancyGrid, start: Pose, goal: Pose) -> Path:
        """Return the path; raise NoPath if start or goal is blocked, no way joins them, or none was found by count."""
        field = grid.derive(self._field)
        motions = self._make_motions(grid, field, start)
        query = self._make_query(grid, field, motions, start, goal)
        if math.dist(query.start[:2], query.goals[0][:2]) < self._spacing:
            return self._map_path(grid, np.array((query.start, (*query.goals[0][:2], query.start[2]))))
        key = stream_key(self._seed, f"{goal.x} {goal.y}", "ompl")
        found = find_path(motions, query, self._effort, 1 + int(key) % _SEEDS)
        if found is None:
            raise NoPath(
                f"no way found from {_format_position(start)} to {_format_position(goal)} by "
                f"{self._effort.algorithm} within {self._effort.evaluations} evaluations"
            )
        return self._map_path(grid, smooth_path(motions, found, self._spacing, self._smoothing_rounds))

    def _make_motions(self, grid: OccupancyGrid, field: Field, start: Pose) -> Motions:
        """Return the checks for a start; one that is too near an obstacle may go on like that for a while."""
        x, y, theta = _in_grid(grid, start)
        there = body_clearance(field, self._discs, grid.resolution, (x, y, theta))
        reach, allowed = (0.0, 0.0) if there > 0.0 else (self._reach, there - _NEARER)
        return Motions(
            Rules(field, grid.derive(self._prices), self._discs, grid.resolution, reach, allowed, x, y, *self._steering)
        )

    def _make_query(self, grid: OccupancyGrid, field: Field, motions: Motions, start: Pose, goal: Pose) -> Query:
        """Return what to search for; raise NoPath where no search could succeed."""
        start_cell, goal_cell = _cell_of(grid, start, "start"), _cell_of(grid, goal, "goal")
        barred = grid.occupied if self._field.allow_unknown else grid.occupied | (grid.data == UNKNOWN)
        if barred[start_cell]:
            raise NoPath(
                f"the start {_format_position(start)} lies in an occupied or unknown cell; a free one is needed"
            )
        reached = reachable_cells(
            field, barred, grid.resolution, self._inscribed_radius + ROUNDING, motions.rules.reach, *start_cell
        )
        goals = next(self._goal_poses(grid, reached, motions, goal, goal_cell), ())
        if not goals:
            raise NoPath(self._failure_reason(field, start, goal, goal_cell))
        rows, columns = np.flatnonzero(reached.any(axis=1)), np.flatnonzero(reached.any(axis=0))
        low = columns[0] * grid.resolution, rows[0] * grid.resolution
        high = (columns[-1] + 1) * grid.resolution, (rows[-1] + 1) * grid.resolution
        return Query(_in_grid(grid, start), goals, low, high)

    def _goal_poses(
        self, grid: OccupancyGrid, reached: NDArray[np.bool_], motions: Motions, goal: Pose, goal_cell: Cell
    ) -> Iterator[tuple[XYTheta, ...]]:
        """Yield the free poses at the goal, then those at the reached cells within
        the tolerance of it, nearest first.
        """
        x, y, _ = _in_grid(grid, goal)
        positions = [(x, y)] if reached[goal_cell] else []
        rows, columns = np.nonzero(reached)
        centres = (np.stack((columns, rows), axis=1) + 0.5) * grid.resolution
        distances = np.hypot(*(centres - (x, y)).T)
        near = np.flatnonzero(distances <= self._tolerance)
        positions += [
            (float(centres[i, 0]), float(centres[i, 1])) for i in near[np.argsort(distances[near], kind="stable")]
        ]
        headings = [2.0 * math.pi * k / self._goal_headings for k in range(self._goal_headings)]
        for position in positions:
            goals = tuple((*position, theta) for theta in headings if motions.is_free(*position, theta))
            if goals:
                yield goals

    def _failure_reason(self, field: Field, start: Pose, goal: Pose, goal_cell: Cell) -> str:
        body = f"(inscribed radius {self._inscribed_radius:.3f} m)"
        if field[goal_cell] <= self._inscribed_radius + ROUNDING:
            return f"the goal {_format_position(goal)} is blocked, no way leads within {self._tolerance} m of it {body}"
        return f"no way leads from {_format_position(start)} to {_format_position(goal)} {body}"

    def _map_path(self, grid: OccupancyGrid, poses: Poses) -> Path:
        """Return poses of the grid's frame in ``map``; straight lines head for the
        next pose, the last as the one before.
        """
        if self._steering[0] == STRAIGHT:
            steps = np.diff(poses[:, :2], axis=0)
            poses[:-1, 2] = np.arctan2(steps[:, 1], steps[:, 0])
            poses[-1, 2] = poses[-2, 2]
        headings = np.angle(np.exp(1j * (poses[:, 2] + grid.origin.theta)))
        return Path(np.column_stack((grid.positions(poses[:, 1::-1] / grid.resolution - 0.5), headings)))


def _steering_curves(robot: Robot, car: Car, algorithm: Algorithm) -> tuple[int, float]:
    """Return which curves the robot drives, and their turning radius, m; raise
    ConfigurationError if it cannot drive these.
    """
    if robot.kinematics != "ackermann":
        return STRAIGHT, 1.0
    if car.curves == "reeds_shepp" and robot.limits.vx_min >= 0.0:
        raise ConfigurationError(
            f"ompl: car.curves is reeds_shepp; allowed: dubins, for {robot.name} cannot drive backwards"
        )
    barred = NOT_FOR_DUBINS if car.curves == "dubins" else NOT_FOR_CARS
    if algorithm in barred:
        allowed = ", ".join(name for name in get_args(Algorithm) if name not in barred)
        raise ConfigurationError(
            f"ompl: algorithm is {algorithm}; allowed for an Ackermann robot on {car.curves} curves: {allowed}"
        )
    return DUBINS if car.curves == "dubins" else REEDS_SHEPP, car.turning_slack * robot.wheelbase / math.tan(
        robot.steering_max
    )


def _format_position(pose: Pose) -> str:
    return f"({pose.x:.2f}, {pose.y:.2f})"


def _cell_of(grid: OccupancyGrid, pose: Pose, role: str) -> Cell:
    """Return the cell of a position; raise NoPath outside the grid."""
    cell = grid.cells((pose.x, pose.y))
    if not grid.contains(cell):
        raise NoPath(
            f"the {role} {_format_position(pose)} lies outside the map of {grid.data.shape[1]} x "
            f"{grid.data.shape[0]} cells"
        )
    return int(cell[0]), int(cell[1])


def _in_grid(grid: OccupancyGrid, pose: Pose) -> XYTheta:
    """Return a pose of ``map`` in the grid's frame, m from its corner."""
    relative = grid.origin.relative(pose)
    return relative.x, relative.y, relative.theta
