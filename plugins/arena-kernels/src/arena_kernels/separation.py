"""Bodies against each other: people who overlap are pushed apart."""

from __future__ import annotations

from math import sqrt

import numpy as np
from numpy.typing import NDArray

from arena_kernels.compiled import compiled


@compiled
def push_apart(
    positions: NDArray[np.float64],
    radii: NDArray[np.float64],
    pairs: NDArray[np.int32],
    found: int,
    pushes: NDArray[np.float64],
    masses: NDArray[np.float64] | None = None,
) -> bool:
    """Write by how far each body moves so that no pair overlaps any more; tell whether any moves.

    Both share the overlap evenly; where there are ``masses`` (P,), the lighter one moves more.
    Each pair is resolved as if alone (a Jacobi pass over unchanged positions), so nobody is favoured by a place in the list.
    """
    touching = False
    for pair in range(found):
        i, j = pairs[pair, 0], pairs[pair, 1]
        dx, dy = positions[j, 0] - positions[i, 0], positions[j, 1] - positions[i, 1]
        reach = radii[i] + radii[j]
        squared = dx * dx + dy * dy
        if squared >= reach * reach:
            continue
        if not touching:
            touching = True
            for k in range(len(pushes)):
                pushes[k, 0], pushes[k, 1] = 0.0, 0.0
        separation = sqrt(squared)
        ux, uy = (dx / separation, dy / separation) if separation > 0.0 else (1.0, 0.0)
        share = 0.5 if masses is None else masses[j] / (masses[i] + masses[j])
        first, second = share * (reach - separation), (1.0 - share) * (reach - separation)
        pushes[i, 0] -= first * ux
        pushes[i, 1] -= first * uy
        pushes[j, 0] += second * ux
        pushes[j, 1] += second * uy
    return touching
