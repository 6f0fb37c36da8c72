"""H-signatures: which way round each obstacle a band goes.

Bhattacharya, Likhachev and Kumar, Topological constraints in search-based robot path planning, Autonomous Robots 33,
2012: paths with common ends are homologous if the integrals of dz / (z - zeta) agree for a point zeta in every
obstacle. Their real parts depend on the ends alone; the imaginary parts are kept, an angle an obstacle. Round a moving
obstacle the integral follows the relative motion, which is the linking with its world line in x-y-t.
"""

from __future__ import annotations

import math

import numpy as np

from arena_kernels.compiled import borrowing, compiled
from arena_kernels.foreseen import Foreseen, leg_at, place_on
from arena_teb.columns import TIME, X, Y
from arena_teb.problem import FloatArray


@compiled
def h_signature(band: FloatArray, points: FloatArray, foreseen: Foreseen, horizon: float) -> FloatArray:
    """Return the angle, rad, by which a band (N, 4) goes round each of ``points`` (C, 2) and of K moving discs, (C +
    K,).

    Discs move as ``foreseen`` for ``horizon`` s and then stand.
    """
    count, static = len(band), len(points)
    angles = np.zeros(static + len(foreseen.places))
    time = 0.0
    for k in range(count - 1):
        later = time + band[k, TIME]
        now, then = min(time, horizon), min(later, horizon)
        leg, next_leg = leg_at(foreseen, now), leg_at(foreseen, then)
        for j in range(len(angles)):
            if j < static:
                ax, ay, bx, by = points[j, X], points[j, Y], points[j, X], points[j, Y]
            else:
                i = j - static
                ax, ay = place_on(foreseen, i, leg, now)
                bx, by = place_on(foreseen, i, next_leg, then)
            ax, ay, bx, by = band[k, X] - ax, band[k, Y] - ay, band[k + 1, X] - bx, band[k + 1, Y] - by
            angles[j] += math.atan2(ax * by - ay * bx, ax * bx + ay * by)
        time = later
    return angles


@borrowing
def same_class(angles: FloatArray, others: FloatArray) -> bool:
    """Return whether two signatures differ by less than half a turn round every obstacle."""
    same = True
    for j in range(len(angles)):
        same = same and abs(angles[j] - others[j]) <= math.pi
    return same
