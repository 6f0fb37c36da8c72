"""What moves: the tracked obstacles that matter most to a plan, expected to keep their velocity."""

from __future__ import annotations

import math

import numpy as np

from arena_core import Tracks
from arena_mpc.arrays import FloatArray
from arena_mpc.footprint import Discs, placed
from arena_mpc.plan import Plan
from arena_mpc.terms import MOVER

FAR = 1e3  # m, where the obstacles stand that fill a problem up
NEAR = 0.01  # m, more than what is rounded off
SPACING = 0.05  # s, between two moments that are checked


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


def first_hit(tracks: Tracks, plan: Plan, discs: Discs, deeper: float) -> float:
    """Return after how many seconds discs of the footprint that drive a plan first touch a track, inf if never.

    A track that would touch a robot that stands counts when it is touched by ``deeper`` m more: standing is then no better.
    """
    if len(tracks.ids) == 0:
        return math.inf
    tracks = _within_reach(tracks, plan, discs)
    if len(tracks.ids) == 0:
        return math.inf
    times = np.arange(0.0, plan.duration + 1e-9, SPACING)
    knots = np.arange(len(plan.states)) * plan.step
    poses = np.column_stack([np.interp(times, knots, column) for column in plan.states[:, :3].T])
    predicted = tracks.positions[:, None] + times[:, None] * tracks.velocities[:, None]
    touched = tracks.radii[:, None] + discs.radius
    standing = _apart(predicted, placed(discs, poses[:1])) - touched
    allowed = np.where(standing > 0.0, 0.0, standing - deeper)
    touching = (_apart(predicted, placed(discs, poses)) - touched < allowed).any(axis=0)
    return float(times[int(np.argmax(touching))]) if touching.any() else math.inf


def _within_reach(tracks: Tracks, plan: Plan, discs: Discs) -> Tracks:
    """Return the tracks that may touch the robot on a plan: wherever both are within its duration, they are no farther apart."""
    first = plan.states[0, :2]
    driven = np.hypot(*(plan.states[:, :2] - first).T).max() + np.hypot(*discs.centres_xy.T).max() + discs.radius + NEAR
    away = np.hypot(*(tracks.positions - first).T) - tracks.radii
    near = ~(away - np.hypot(*tracks.velocities.T) * plan.duration > driven)
    return Tracks(tracks.ids[near], tracks.positions[near], tracks.velocities[near], tracks.radii[near], tracks.covariances[near])


def _apart(positions: FloatArray, centres: FloatArray) -> FloatArray:
    """Return (K, T) how far ``positions`` (K, T, 2) are from the nearest of ``centres`` (T or 1, C, 2), m."""
    return np.asarray(np.hypot(*(positions[:, :, None] - centres).transpose(3, 0, 1, 2)).min(axis=2))
