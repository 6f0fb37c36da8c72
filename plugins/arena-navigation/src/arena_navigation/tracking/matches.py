"""Which disc is which track's: the assignment of least total Mahalanobis distance within a gate."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

from arena_kernels.compiled import borrowing

_IMPOSSIBLE = 1e9  # dearer than any sum of possible pairs


def matched(
    states: NDArray[np.float64],
    covariances: NDArray[np.float64],
    radii: NDArray[np.float64],
    positions: NDArray[np.float64],
    noises: NDArray[np.float64],
    gate: float,
) -> NDArray[np.int64]:
    """Return for each of N tracks the number of its disc, -1 where there is none; (N,).

    A disc may be a track's within ``gate`` (squared Mahalanobis distance), or with its middle inside the track's body: bodies do
    not pass through each other.
    """
    matches = np.full(len(states), -1, np.int64)
    if not len(states) or not len(positions):
        return matches
    costs = np.empty((len(states), len(positions)))
    write_costs(states, covariances, radii, positions, noises, gate, costs)
    tracks, discs = linear_sum_assignment(costs)
    possible = costs[tracks, discs] < _IMPOSSIBLE
    matches[tracks[possible]] = discs[possible]
    return matches


@borrowing
def write_costs(
    states: NDArray[np.float64],
    covariances: NDArray[np.float64],
    radii: NDArray[np.float64],
    positions: NDArray[np.float64],
    noises: NDArray[np.float64],
    gate: float,
    costs: NDArray[np.float64],
) -> None:
    """Write d^2 + ln det S for every pair (N, M): what minus twice the log likelihood differs in."""
    for k in range(len(states)):
        p = covariances[k]
        for m in range(len(positions)):
            r = noises[m]
            sxx, sxy, syy = p[0, 0] + r[0, 0], p[0, 1] + r[0, 1], p[1, 1] + r[1, 1]
            det = sxx * syy - sxy * sxy
            x, y = positions[m, 0] - states[k, 0], positions[m, 1] - states[k, 1]
            squared = (syy * x * x - 2.0 * sxy * x * y + sxx * y * y) / det
            possible = squared <= gate or x * x + y * y < radii[k] ** 2
            costs[k, m] = squared + np.log(det) if possible else _IMPOSSIBLE
