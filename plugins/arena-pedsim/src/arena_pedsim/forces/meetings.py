"""Who stands face to face with whom: two who want to go where the other is."""

from __future__ import annotations

from math import sqrt

import numpy as np
from numpy.typing import NDArray

from arena_kernels.compiled import compiled

Floats = NDArray[np.float64]

NEAR = 0.3  # m between two bodies that may hinder each other
AHEAD = 0.7  # cosine of the angle from the heading, to either side, at which somebody is in the way


@compiled
def notice_meetings(
    positions: Floats, radii: Floats, people: NDArray[np.void], headings: Floats, pairs: NDArray[np.int32], found: int
) -> None:
    """Note for everybody whether to turn round for who comes the other way; of two parties the later one does, its leader first."""
    for i in range(len(positions)):
        people[i].opposed = 0
    for k in range(found):
        i, j = pairs[k, 0], pairs[k, 1]
        if people[i].party != people[j].party and _face(positions, radii, headings, i, j):
            later = max(people[i].party, people[j].party)
            people[later].opposed = 1


@compiled
def _face(positions: Floats, radii: Floats, headings: Floats, i: int, j: int) -> bool:
    """Tell whether two are near and each is in the way of the other."""
    dx, dy = positions[j, 0] - positions[i, 0], positions[j, 1] - positions[i, 1]
    distance = sqrt(dx * dx + dy * dy)
    if distance > radii[i] + radii[j] + NEAR:
        return False
    ahead: float = headings[i, 0] * dx + headings[i, 1] * dy
    facing: float = -(headings[j, 0] * dx + headings[j, 1] * dy)
    return min(ahead, facing) > AHEAD * distance
