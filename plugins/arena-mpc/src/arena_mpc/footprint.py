"""The footprint: discs that cover it in the optimisation, its exact outline when a plan is checked."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from arena_core import Footprint
from arena_kernels.compiled import borrowing
from arena_kernels.costmap_window import CostmapWindow, Outline, outline_clearance
from arena_mpc.arrays import FloatArray
from arena_mpc.columns import THETA, X, Y

CHECK_SPACING = 0.05  # m, between two poses that are checked
CHECK_TURN = 0.2  # rad, between two poses that are checked


class Discs(NamedTuple):
    """Equal discs: ``centres_xy`` (C, 2) in ``base_link``, ``radius`` m."""

    centres_xy: FloatArray
    radius: float


def covering_discs(footprint: Footprint, count: int | None) -> Discs:
    """Cover a footprint with ``count`` discs in a row along its longer side; 0 is a point, None
    one for a circle, else two.
    """
    if count == 0:
        return Discs(np.zeros((1, 2)), 0.0)
    if footprint.is_circle:
        return Discs(np.zeros((1, 2)), footprint.radius)
    low, high = footprint.vertices_xy.min(axis=0), footprint.vertices_xy.max(axis=0)
    sides, count = high - low, 2 if count is None else count
    longer = int(np.argmax(sides))
    piece = sides[longer] / count
    centres = np.tile(0.5 * (low + high), (count, 1))
    centres[:, longer] = low[longer] + piece * (0.5 + np.arange(count))
    return Discs(centres, math.hypot(0.5 * piece, 0.5 * sides[1 - longer]))


def place_discs(discs: Discs, poses: FloatArray) -> FloatArray:
    """Return where the discs' centres lie at ``poses`` (N, 3): (N, C, 2)."""
    c, s = np.cos(poses[:, THETA])[:, None], np.sin(poses[:, THETA])[:, None]
    x, y = discs.centres_xy.T
    return np.stack((poses[:, 0, None] + c * x - s * y, poses[:, 1, None] + s * x + c * y), axis=2)


@borrowing
def free_until(window: CostmapWindow, outline: Outline, poses: FloatArray, allowed: float) -> float:
    """Return how many stages of ``poses`` (N + 1, 3), parts included, are driven before the outline is
    nearer than ``allowed`` m.
    """
    for k in range(len(poses) - 1):
        dx, dy, turn = (
            poses[k + 1, X] - poses[k, X],
            poses[k + 1, Y] - poses[k, Y],
            poses[k + 1, THETA] - poses[k, THETA],
        )
        parts = max(1, math.ceil(max(math.hypot(dx, dy) / CHECK_SPACING, abs(turn) / CHECK_TURN)))
        for i in range(1, parts + 1):
            share = i / parts
            theta = poses[k, THETA] + share * turn
            gap = outline_clearance(
                window,
                outline,
                (poses[k, X] + share * dx, poses[k, Y] + share * dy, math.cos(theta), math.sin(theta)),
                allowed,
            )
            if gap < allowed:
                return float(k + share)
    return float(len(poses) - 1)
