"""Who meets whom: two who want to go where the other is, and two who squeeze past each other."""

from __future__ import annotations

from math import sqrt

import numpy as np
from numpy.typing import NDArray

from arena_kernels.compiled import compiled
from arena_kernels.crowds import NearPairs
from arena_kernels.ground import Ground, clearance_and_gradient

Floats = NDArray[np.float64]

NEAR = 0.3  # m between two bodies that may hinder each other
# steps off the walls on which there may be room, for a corner has two; m that each goes too far
STEPS_OFF, OFF = 2, 0.1
PASSING = 2.0  # m between two bodies that begin to squeeze past each other
SAME_WAY = 0.5  # cosine of the angle between two headings from which on one follows the other
AHEAD = 0.7  # cosine of the angle from the heading, to either side, at which a person is in the way


@compiled
def drop_passing_pairs(positions: Floats, radii: Floats, headings: Floats, ground: Ground, near: NearPairs) -> int:
    """Take out of the list of pairs who squeeze past each other, shoulder first, and return how many are left.

    They do where two do not fit beside each other, unless both go the same way: there is no other way for them.
    """
    kept = 0
    for k in range(near.found):
        i, j = near.pairs[k, 0], near.pairs[k, 1]
        if not _is_passing(positions, radii, headings, ground, i, j):
            near.pairs[kept, 0], near.pairs[kept, 1] = i, j
            kept += 1
    return kept


@compiled
def _is_passing(positions: Floats, radii: Floats, headings: Floats, ground: Ground, i: int, j: int) -> bool:
    dx, dy = positions[j, 0] - positions[i, 0], positions[j, 1] - positions[i, 1]
    beside = radii[i] + radii[j]
    if (
        dx * dx + dy * dy > (beside + PASSING) ** 2
        or headings[i, 0] * headings[j, 0] + headings[i, 1] * headings[j, 1] > SAME_WAY
    ):
        return False
    return (
        _is_single_file(ground, positions[i, 0] + 0.5 * dx, positions[i, 1] + 0.5 * dy, beside)
        and _is_single_file(ground, positions[i, 0], positions[i, 1], beside)
        and _is_single_file(ground, positions[j, 0], positions[j, 1], beside)
    )


@compiled
def _is_single_file(ground: Ground, x: float, y: float, beside: float) -> bool:
    """Return whether a way is too narrow at a free place for two bodies who reach ``beside`` m to either side when
    beside each other.

    It is not where there is room a little farther from the walls.
    """
    room, gx, gy = clearance_and_gradient(ground, x, y)
    if room <= 0.0:
        return False
    for _ in range(STEPS_OFF):
        if room >= beside:
            return False
        x, y = x + (beside - room + OFF) * gx, y + (beside - room + OFF) * gy
        room, gx, gy = clearance_and_gradient(ground, x, y)
    return room < beside


@compiled
def detect_deadlocks(
    positions: Floats, radii: Floats, people: NDArray[np.void], headings: Floats, near: NearPairs
) -> None:
    """Note for everybody whether to turn round for who comes the other way; of two parties the
    later one does, its leader first.
    """
    for i in range(len(positions)):
        people[i].opposed = 0
    for k in range(near.found):
        i, j = near.pairs[k, 0], near.pairs[k, 1]
        if people[i].party != people[j].party and _are_facing(positions, radii, headings, i, j):
            later = max(people[i].party, people[j].party)
            people[later].opposed = 1


@compiled
def _are_facing(positions: Floats, radii: Floats, headings: Floats, i: int, j: int) -> bool:
    """Return whether two are near and each is in the way of the other."""
    dx, dy = positions[j, 0] - positions[i, 0], positions[j, 1] - positions[i, 1]
    distance = sqrt(dx * dx + dy * dy)
    if distance > radii[i] + radii[j] + NEAR:
        return False
    ahead: float = headings[i, 0] * dx + headings[i, 1] * dy
    facing: float = -(headings[j, 0] * dx + headings[j, 1] * dy)
    return min(ahead, facing) > AHEAD * distance
