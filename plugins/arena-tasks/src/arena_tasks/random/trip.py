"""Where the robot starts, where it shall go, and its likely way between the two."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from arena_core import ImpossibleScenario, OccupancyGrid, Pose
from arena_tasks.random.free_space import FreeSpace
from arena_tasks.random.route import find_route

Placement = Literal["along_route", "anywhere"]  # of what the robot shall meet
AHEAD = 0.5  # m before and behind a place on the route that say which way the route runs there


@dataclass(frozen=True, slots=True)
class TripRules:
    """What a start and a goal must fulfil, m; ``clearance`` is what both need, ``passage`` what
    the way between them needs.
    """

    clearance: float
    passage: float
    min_distance: float
    max_distance: float
    shrink_to_world: bool


@dataclass(frozen=True, slots=True, eq=False)
class Trip:
    """A robot's problem; ``route_xy`` (M, 2) leads from start to goal in steps of about a cell, its points
    lie at ``lengths`` (M,), m.
    """

    start: Pose
    goal: Pose
    route_xy: NDArray[np.float64]
    lengths: NDArray[np.float64]

    def at(self, lengths: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the positions so far along the route, (..., 2); its ends for what lies beyond them."""
        return np.stack([np.interp(lengths, self.lengths, self.route_xy[:, k]) for k in (0, 1)], axis=-1)

    def positions_beside(self, along: NDArray[np.float64], across: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the positions (N, 2) that lie ``along`` (N,) m along the route and ``across`` (N,) m to its left."""
        ahead = self.at(along + AHEAD) - self.at(along - AHEAD)
        ahead /= np.maximum(np.hypot(*ahead.T), 1e-9)[:, None]
        return self.at(along) + across[:, None] * np.stack((-ahead[:, 1], ahead[:, 0]), axis=1)

    def route_direction(self, length: float) -> NDArray[np.float64]:
        """Return the unit vector (2,) along the route there."""
        ahead = self.at(np.array(length + AHEAD)) - self.at(np.array(length - AHEAD))
        return np.asarray(ahead / max(float(np.hypot(*ahead)), 1e-9))

    def reroute_on(self, grid: OccupancyGrid, passage: float) -> Trip | None:
        """Return the same trip on another grid, None where no way joins its ends."""
        route = find_route(grid, passage, np.array((self.start.x, self.start.y)), np.array((self.goal.x, self.goal.y)))
        return replace(self, route_xy=route, lengths=_route_lengths(route)) if len(route) else None


class Ground:
    """Where a robot has room to stand: ``positions`` (N, 2) m, and which of them a way joins."""

    def __init__(self, positions: NDArray[np.float64], labels: NDArray[np.int32]) -> None:
        self.positions = positions
        self._labels = labels
        self._joined: dict[int, Joined] = {}

    def joined_with(self, start: int) -> Joined:
        """Return all positions that can be reached from this one."""
        label = int(self._labels[start])
        if label not in self._joined:
            self._joined[label] = Joined.of(self.positions[self._labels == label])
        return self._joined[label]


@dataclass(frozen=True, slots=True, eq=False)
class Joined:
    """Positions (N, 2) that are joined by ways, their coordinates apart, and the diagonal of the box about them, m."""

    positions: NDArray[np.float64]
    coordinates: tuple[NDArray[np.float64], NDArray[np.float64]]
    diagonal: float

    @staticmethod
    def of(positions: NDArray[np.float64]) -> Joined:
        """Prepare positions."""
        x, y = np.ascontiguousarray(positions.T)
        return Joined(positions, (x, y), float(np.hypot(*np.ptp(positions, axis=0))))

    def in_range(self, start: NDArray[np.float64], rules: TripRules) -> NDArray[np.float64]:
        """Return those of the positions that may be the goal of a robot at ``start``, (M, 2)."""
        least = min(rules.min_distance, 0.5 * self.diagonal) if rules.shrink_to_world else rules.min_distance
        away = np.hypot(self.coordinates[0] - start[0], self.coordinates[1] - start[1])
        return np.asarray(self.positions[(away >= least) & (away <= rules.max_distance) & (away > 0.0)])


@dataclass(frozen=True, slots=True)
class GroundOf:
    """A key and function for ``grid.derive``: the ground of robots that need this much
    clearance, and this much of it on the way.
    """

    clearance: float
    passage: float

    def __call__(self, grid: OccupancyGrid) -> Ground:
        """Return the ground."""
        space = grid.derive(FreeSpace)
        positions = space.places(self.clearance)
        return Ground(positions, space.regions(self.passage)[tuple(grid.cells(positions).T)])


def draw_trip(space: FreeSpace, rules: TripRules, random: np.random.Generator, tries: int) -> Trip:
    """Draw a start, then a goal that can be reached from it; raise ImpossibleScenario after so many starts in vain."""
    ground = space.grid.derive(GroundOf(rules.clearance, rules.passage))
    if len(ground.positions) == 0:
        raise ImpossibleScenario(f"no cell is free with {rules.clearance:.2f} m around it for the robot to start from")
    for _ in range(tries):
        number = int(random.integers(len(ground.positions)))
        start = ground.positions[number]
        goals = ground.joined_with(number).in_range(start, rules)
        if len(goals):
            return _make_trip(space, rules, start, goals[random.integers(len(goals))], random)
    raise ImpossibleScenario(
        f"no goal {rules.min_distance:g} .. {rules.max_distance:g} m from its start was found with {tries} starts; "
        "lower task.trip.min_distance or raise task.trip.max_distance"
    )


def _make_trip(
    space: FreeSpace,
    rules: TripRules,
    start: NDArray[np.float64],
    goal: NDArray[np.float64],
    random: np.random.Generator,
) -> Trip:
    heading = float(random.uniform(-np.pi, np.pi))
    route = find_route(space.grid, rules.passage, start, goal)
    return Trip(
        Pose(start[0].item(), start[1].item(), heading),
        Pose(goal[0].item(), goal[1].item()),
        route,
        _route_lengths(route),
    )


def _route_lengths(route: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.concatenate(((0.0,), np.hypot(*np.diff(route, axis=0).T).cumsum()))
