"""Floors to validate crowds on: rectangles that are free, in a map that is else wall."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arena_core import OCCUPIED, OccupancyGrid, PedestrianSpec, Pose, Scenario, World

Floats = NDArray[np.float64]

WALL, RESOLUTION = 0.2, 0.05  # m


class Area(NamedTuple):
    """A rectangle, m."""

    left: float
    right: float
    bottom: float
    top: float

    @property
    def size(self) -> float:
        """Return the area, m^2."""
        return (self.right - self.left) * (self.top - self.bottom)

    def contains(self, positions: Floats) -> NDArray[np.bool_]:
        """Tell which positions (..., 2) lie inside."""
        x, y = positions[..., 0], positions[..., 1]
        return (x > self.left) & (x < self.right) & (y > self.bottom) & (y < self.top)

    def places(self, number: int, random: np.random.Generator) -> Floats:
        """Draw places on a lattice, one at most in each square cell, so that people do not start
        in each other: (number, 2).
        """
        columns = int(np.ceil(np.sqrt(number * (self.right - self.left) / (self.top - self.bottom))))
        rows = int(np.ceil(number / columns))
        cells = np.stack(np.divmod(random.permutation(rows * columns)[:number], columns), axis=1)[:, ::-1]
        shares = (cells + random.uniform(0.4, 0.6, cells.shape)) / (columns, rows)
        return (self.left, self.bottom) + shares * (self.right - self.left, self.top - self.bottom)


def floor_world(name: str, areas: Sequence[Area]) -> World:
    """Return a world that is free in these areas."""
    left, bottom = min(area.left for area in areas) - WALL, min(area.bottom for area in areas) - WALL
    right, top = max(area.right for area in areas) + WALL, max(area.top for area in areas) + WALL
    data = np.full((_cell_count(top - bottom), _cell_count(right - left)), OCCUPIED, np.int8)
    for area in areas:
        rows = slice(_cell_count(area.bottom - bottom), _cell_count(area.top - bottom))
        data[rows, _cell_count(area.left - left) : _cell_count(area.right - left)] = 0
    return World(name, OccupancyGrid(data, RESOLUTION, Pose(left, bottom)))


def _cell_count(length: float) -> int:
    return round(length / RESOLUTION)


def make_scenario(world: World, people: Sequence[PedestrianSpec], seconds: float, name: str) -> Scenario:
    """Return these people's problem; its robot is nowhere."""
    here = Pose(0.0, 0.0)
    return Scenario(name, 0, world, here, here, tuple(people), (), 0.3, seconds)
