"""Bodies of different mass against each other."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from arena_kernels.compiled import compiled
from arena_kernels.crowds import NearPairs
from arena_kernels.separation import body_overlap


@compiled
def push_by_mass(
    positions: NDArray[np.float64],
    radii: NDArray[np.float64],
    people: NDArray[np.void],
    near: NearPairs,
    pushes: NDArray[np.float64],
) -> bool:
    """Write by how far each body moves so that no pair overlaps any more, the lighter one farther; return whether any
    moves.

    ``arena_kernels.separation.push_apart`` is the same for bodies of equal mass.
    """
    touching = False
    for pair in range(near.found):
        i, j = near.pairs[pair, 0], near.pairs[pair, 1]
        depth, ux, uy = body_overlap(positions, radii, i, j)
        if depth <= 0.0:
            continue
        if not touching:
            touching = True
            for k in range(len(pushes)):
                pushes[k, 0], pushes[k, 1] = 0.0, 0.0
        share = people[j].mass / (people[i].mass + people[j].mass)
        first, second = share * depth, (1.0 - share) * depth
        pushes[i, 0] -= first * ux
        pushes[i, 1] -= first * uy
        pushes[j, 0] += second * ux
        pushes[j, 1] += second * uy
    return touching
