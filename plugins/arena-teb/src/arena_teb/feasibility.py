"""Whether the robot fits where a band leads it, with its exact footprint."""

from __future__ import annotations

import math

import numpy as np

from arena_kernels.compiled import borrowing
from arena_kernels.costmap_window import CostmapWindow, Outline, allowed_gap, outline_clearance
from arena_teb.columns import THETA, X, Y
from arena_teb.problem import FloatArray
from arena_teb.terms import wrap_to_pi

TURN_STEP = 0.2  # rad between two checks


@borrowing
def free_poses(band: FloatArray, window: CostmapWindow, outline: Outline, wanted: float, close: float) -> int:
    """Return how many poses of a band (N, 4) can be reached one by one with the ``wanted`` gap, m, all interpolated.

    A robot that stands near to something may come nearer by half of the gap, down to ``close`` m. Beyond the window
    everything counts as free.
    """
    start = outline_clearance(
        window, outline, (band[0, X], band[0, Y], math.cos(band[0, THETA]), math.sin(band[0, THETA])), 1.0
    )
    least = allowed_gap(start, wanted, close)
    for k in range(len(band) - 1):
        dx, dy = band[k + 1, X] - band[k, X], band[k + 1, Y] - band[k, Y]
        turn = wrap_to_pi(band[k + 1, THETA] - band[k, THETA])
        parts = max(1, math.ceil(math.hypot(dx, dy) / outline.inscribed_radius), math.ceil(abs(turn) / TURN_STEP))
        for part in range(1, parts + 1):
            share = part / parts
            theta = band[k, THETA] + share * turn
            x, y = band[k, X] + share * dx, band[k, Y] + share * dy
            gap = outline_clearance(window, outline, (x, y, math.cos(theta), math.sin(theta)), wanted)
            if gap < least and gap > -np.inf:
                return k + 1
    return len(band)
