"""Which disc is which track's: the assignment of least total Mahalanobis distance within a gate."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from arena_kernels.compiled import borrowing, inner
from arena_kernels.scalars import Integer
from arena_navigation.columns import X, Y
from arena_navigation.tracking.assignment import Assignment, assign_rows

_IMPOSSIBLE = 1e9  # costlier than any sum of possible pairs


@borrowing
def match_discs(
    beliefs: tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]],
    measured: tuple[NDArray[np.float64], NDArray[np.float64]],
    gate: float,
    room: Assignment,
    matches: NDArray[np.int64],
) -> None:
    """Write for each of N tracks the number of its disc, -1 where there is none, to ``matches`` (N,).

    A disc may be a track's within ``gate`` (squared Mahalanobis distance), or with its middle inside the track's body:
    bodies do not pass through each other.
    """
    positions, _ = measured
    states, _, _ = beliefs
    tracks, discs = len(states), len(positions)
    across, down = (discs, 1) if tracks <= discs else (1, tracks)  # rows are what there is less of
    _write_costs(beliefs, measured, gate, across, down, room.costs)
    assign_rows(min(tracks, discs), max(tracks, discs), room)
    for k in range(tracks):
        matches[k] = room.column_of[k] if tracks <= discs else room.row_of[k]
        if matches[k] >= 0 and room.costs[k * across + matches[k] * down] >= _IMPOSSIBLE:
            matches[k] = -1


@inner
def _write_costs(
    beliefs: tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]],
    measured: tuple[NDArray[np.float64], NDArray[np.float64]],
    gate: float,
    across: Integer,
    down: Integer,
    costs: NDArray[np.float64],
) -> None:
    """Write d^2 + ln det S for every pair (k, m) at ``k * across + m * down``: what minus twice
    the log likelihood differs in.
    """
    positions, noises = measured
    states, covariances, radii = beliefs
    for k in range(len(states)):
        p = covariances[k]
        for m in range(len(positions)):
            r = noises[m]
            sxx, sxy, syy = p[X, X] + r[X, X], p[X, Y] + r[X, Y], p[Y, Y] + r[Y, Y]
            det = sxx * syy - sxy * sxy
            x, y = positions[m, X] - states[k, X], positions[m, Y] - states[k, Y]
            squared = (syy * x * x - 2.0 * sxy * x * y + sxx * y * y) / det
            possible = squared <= gate or x * x + y * y < radii[k] ** 2
            costs[k * across + m * down] = squared + np.log(det) if possible else _IMPOSSIBLE
