"""What moves: the tracked obstacles that matter most to a plan, expected to keep their velocity."""

from __future__ import annotations

import numpy as np

from arena_core import Tracks
from arena_mpc.arrays import FloatArray
from arena_mpc.plan import Plan
from arena_mpc.terms import MOVER

FAR = 1e3  # m, where the obstacles stand that fill a problem up


def relevant_movers(tracks: Tracks, positions: FloatArray, step: float, distance: float, count: int) -> FloatArray:
    """Return ``count`` rows (x, y, vx, vy, radius): the tracks that come nearest to ``positions`` (N + 1, 2), radii grown by ``distance``.

    Position k is reached ``k * step`` s from now. Rows without a track stand far away.
    """
    rows = np.tile((FAR, FAR, 0.0, 0.0, 0.0), (count, 1))
    if len(tracks.ids) == 0 or count == 0:
        return rows
    times = np.arange(len(positions)) * step
    predicted = tracks.positions[:, None] + times[:, None] * tracks.velocities[:, None]
    gaps = np.hypot(*(predicted - positions).transpose(2, 0, 1)).min(axis=1) - tracks.radii
    order = np.argsort(gaps, kind="stable")[:count]
    chosen = np.column_stack((tracks.positions, tracks.velocities, tracks.radii + distance))[order]
    rows[: len(order)] = chosen
    assert rows.shape == (count, MOVER)
    return rows


def first_hit(tracks: Tracks, plan: Plan, radius: float) -> float:
    """Return after how many seconds a disc of ``radius`` m that drives a plan first touches a track, inf if never."""
    times = np.arange(len(plan.states)) * plan.step
    predicted = tracks.positions[:, None] + times[:, None] * tracks.velocities[:, None]
    gaps = np.hypot(*(predicted - plan.states[:, :2]).transpose(2, 0, 1)) - tracks.radii[:, None]
    touching = (gaps < radius).any(axis=0)
    return float(times[int(np.argmax(touching))]) if touching.any() else float("inf")
