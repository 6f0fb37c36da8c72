"""Bodies against each other: people who overlap are pushed apart."""

from __future__ import annotations

from math import sqrt

import numpy as np
from numpy.typing import NDArray

from arena_kernels.compiled import borrowing


@borrowing
def push_apart(
    positions: NDArray[np.float64],
    radii: NDArray[np.float64],
    pairs: NDArray[np.int32],
    found: int,
    pushes: NDArray[np.float64],
) -> bool:
    """Write by how far each body moves so that every overlapping pair shares its overlap evenly; return whether any
    moves.

    Each pair is resolved as if alone (a Jacobi pass over unchanged positions), so no one is favoured by a place in the
    list.
    """
    touching = False
    for pair in range(found):
        i, j = pairs[pair, 0], pairs[pair, 1]
        depth, ux, uy = body_overlap(positions, radii, i, j)
        if depth <= 0.0:
            continue
        if not touching:
            touching = True
            for k in range(len(pushes)):
                pushes[k, 0], pushes[k, 1] = 0.0, 0.0
        half = 0.5 * depth
        pushes[i, 0] -= half * ux
        pushes[i, 1] -= half * uy
        pushes[j, 0] += half * ux
        pushes[j, 1] += half * uy
    return touching


@borrowing
def body_overlap(
    positions: NDArray[np.float64], radii: NDArray[np.float64], i: int, j: int
) -> tuple[float, float, float]:
    """Return by how much two bodies overlap (0 if they do not), and the unit vector from the first to the second."""
    dx, dy = positions[j, 0] - positions[i, 0], positions[j, 1] - positions[i, 1]
    reach = radii[i] + radii[j]
    squared = dx * dx + dy * dy
    if squared >= reach * reach:
        return 0.0, 0.0, 0.0
    separation = sqrt(squared)
    if separation == 0.0:
        return reach, 1.0, 0.0
    return reach - separation, dx / separation, dy / separation
