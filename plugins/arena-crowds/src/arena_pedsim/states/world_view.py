"""One world as the state machine sees it."""

from __future__ import annotations

from math import sqrt
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from arena_kernels.compiled import inner
from arena_kernels.crowds import Robots, nearest_robot
from arena_kernels.ground import Ground
from arena_kernels.slide_along import is_visible

Floats = NDArray[np.float64]
Ints = NDArray[np.int32]

SIGHT_LINE = 0.05  # m free on both sides of a line of sight


class WorldView(NamedTuple):
    """The P people of a world and where they are, m and m/s; ``members`` (P,) counts those of each group who are on the
    move, ``first`` (P,) and ``following`` (P,) link people: the first of each circle, then of each group, and who comes
    next, or NOBODY; ``angles`` (P,) rad are where people stand in their circle.

    ``states``, ``people`` and ``minds`` are written to. ``table``, ``transitions`` and ``numbers`` are those of the
    StateTable.
    """

    positions: Floats
    velocities: Floats
    radii: Floats
    states: NDArray[np.int8]
    people: NDArray[np.void]
    minds: NDArray[np.void]
    members: Ints
    first: Ints
    following: Ints
    angles: Floats
    world: Any
    tick: int
    robots: Robots
    ground: Ground
    table: NDArray[np.void]
    transitions: NDArray[np.void]
    numbers: Any
    parameters: Any


@inner
def gap_between(scene: WorldView, i: int, j: int) -> float:
    """Return the distance of two people's centres, m; NaN if one is not there."""
    dx, dy = scene.positions[j, 0] - scene.positions[i, 0], scene.positions[j, 1] - scene.positions[i, 1]
    return sqrt(dx * dx + dy * dy)


@inner
def robot_gap(scene: WorldView, i: int) -> float:
    """Return the distance of a person's centre from that of the nearest robot, m."""
    nearest = nearest_robot(scene.robots, scene.positions[i, 0], scene.positions[i, 1])
    dx = scene.robots.poses[nearest, 0] - scene.positions[i, 0]
    dy = scene.robots.poses[nearest, 1] - scene.positions[i, 1]
    return sqrt(dx * dx + dy * dy)


@inner
def can_join(scene: WorldView, i: int, j: int, reach: float) -> bool:
    """Return whether ``j`` is free for a talk, within ``reach`` m of ``i`` and in sight."""
    if (
        i == j
        or scene.table[scene.states[j]].free == 0
        or scene.people[j].sociable == 0
        or not gap_between(scene, i, j) < reach
    ):
        return False
    x, y = scene.positions[i, 0], scene.positions[i, 1]
    return is_visible(scene.ground, (x, y, scene.positions[j, 0], scene.positions[j, 1]), SIGHT_LINE)


@inner
def is_in(state: int, of: int) -> bool:
    """Return whether a state is among those whose bits are set."""
    return (of >> state) & 1 == 1
