"""What moves: the tracked obstacles that matter most to a plan, expected to keep their velocity."""

from __future__ import annotations

import math

import numpy as np

from arena_core import Tracks
from arena_kernels.compiled import borrowing, compiled
from arena_mpc.arrays import FloatArray
from arena_mpc.columns import MOVER, MOVER_RADIUS, MOVER_VX, MOVER_VY, MOVER_X, MOVER_Y, THETA, X, Y
from arena_mpc.footprint import Discs
from arena_mpc.plan import Plan

FAR = 1e3  # m, where the obstacles stand that fill a problem up
NEAR = 0.01  # m, more than what is rounded off
SPACING = 0.05  # s, between two moments that are checked


def relevant_movers(tracks: Tracks, positions: FloatArray, step: float, distance: float, count: int) -> FloatArray:
    """Return ``count`` rows (x, y, vx, vy, radius): the tracks that come nearest to ``positions`` (N + 1, 2), radii
    grown by ``distance``.

    Position k is reached ``k * step`` s from now. Rows without a track stand far away.
    """
    return _nearest_movers(tracks.positions, tracks.velocities, tracks.radii, positions, step, distance, count)


def first_hit(tracks: Tracks, plan: Plan, discs: Discs, deeper: float) -> float:
    """Return after how many seconds discs of the footprint that drive a plan first touch a track, inf if never.

    A track that would touch a robot that stands counts when it is touched by ``deeper`` m more: standing is then no
    better.
    """
    return _first_hit(
        tracks.positions,
        tracks.velocities,
        tracks.radii,
        plan.states,
        plan.step,
        discs.centres_xy,
        discs.radius,
        deeper,
    )


@compiled
def _nearest_movers(
    positions: FloatArray,
    velocities: FloatArray,
    radii: FloatArray,
    places: FloatArray,
    step: float,
    distance: float,
    count: int,
) -> FloatArray:
    """Return the movers among tracks (K, 2), (K, 2), (K,), the one that comes nearest first."""
    rows = np.zeros((count, MOVER))
    rows[:, :2] = FAR
    gaps, filled = np.empty(count), 0
    for track in range(len(radii) if count > 0 else 0):
        nearest = math.inf
        for k in range(len(places)):
            time = k * step
            x, y = positions[track, X] + time * velocities[track, X], positions[track, Y] + time * velocities[track, Y]
            nearest = min(nearest, math.hypot(x - places[k, 0], y - places[k, 1]))
        gap, row = nearest - radii[track], filled
        while row > 0 and gap < gaps[row - 1]:
            row -= 1
        if row == count:
            continue
        filled = min(filled + 1, count)
        for below in range(filled - 1, row, -1):
            gaps[below] = gaps[below - 1]
            rows[below] = rows[below - 1]
        gaps[row] = gap
        rows[row, MOVER_X], rows[row, MOVER_Y] = positions[track, X], positions[track, Y]
        rows[row, MOVER_VX], rows[row, MOVER_VY], rows[row, MOVER_RADIUS] = (
            velocities[track, X],
            velocities[track, Y],
            radii[track] + distance,
        )
    return rows


@borrowing
def _first_hit(
    positions: FloatArray,
    velocities: FloatArray,
    radii: FloatArray,
    states: FloatArray,
    step: float,
    centres: FloatArray,
    radius: float,
    deeper: float,
) -> float:
    """Look at every ``SPACING`` of a plan (N + 1, 3 or more) where discs round ``centres`` (C, 2) and tracks are."""
    duration = (len(states) - 1) * step
    first, moments = (states[0, X], states[0, Y], states[0, THETA]), math.ceil((duration + 1e-9) / SPACING)
    hit = moments  # that of the tracks looked at so far
    driven = _plan_reach(states, centres) + radius + NEAR
    for track in range(len(radii)):
        away = math.hypot(positions[track, X] - first[0], positions[track, Y] - first[1]) - radii[track]
        if away - math.hypot(velocities[track, X], velocities[track, Y]) * duration > driven:
            continue  # wherever both are within the duration, they are farther apart
        touched = radii[track] + radius
        for moment in range(hit):
            time = moment * SPACING
            x, y = positions[track, X] + time * velocities[track, X], positions[track, Y] + time * velocities[track, Y]
            standing = _disc_distance(x, y, first, centres) - touched
            allowed = 0.0 if standing > 0.0 else standing - deeper
            if _disc_distance(x, y, _pose_at(states, step, time), centres) - touched < allowed:
                hit = moment
                break
    return hit * SPACING if hit < moments else math.inf


@borrowing
def _plan_reach(states: FloatArray, centres: FloatArray) -> float:
    """Return how far a plan leads away from its beginning, and how far the outermost disc's centre is from
    the robot's, m, together.
    """
    driven, outermost = 0.0, 0.0
    for k in range(len(states)):
        driven = max(driven, math.hypot(states[k, X] - states[0, X], states[k, Y] - states[0, Y]))
    for i in range(len(centres)):
        outermost = max(outermost, math.hypot(centres[i, X], centres[i, Y]))
    return driven + outermost


@borrowing
def _pose_at(states: FloatArray, step: float, time: float) -> tuple[float, float, float]:
    """Return x, y and theta of a plan at a time, linear between its states."""
    k = int(time / step)
    while k * step > time:
        k -= 1
    while k + 1 < len(states) and (k + 1) * step <= time:
        k += 1
    if k >= len(states) - 1:
        return states[-1, X], states[-1, Y], states[-1, THETA]
    since, wide = time - k * step, (k + 1) * step - k * step
    return (
        (states[k + 1, X] - states[k, X]) / wide * since + states[k, X],
        (states[k + 1, Y] - states[k, Y]) / wide * since + states[k, Y],
        (states[k + 1, THETA] - states[k, THETA]) / wide * since + states[k, THETA],
    )


@borrowing
def _disc_distance(x: float, y: float, pose: tuple[float, float, float], centres: FloatArray) -> float:
    """Return how far (x, y) is from the nearest disc's centre of a robot at a pose, m."""
    c, s, nearest = math.cos(pose[THETA]), math.sin(pose[THETA]), math.inf
    for i in range(len(centres)):
        px, py = pose[X] + c * centres[i, X] - s * centres[i, Y], pose[Y] + s * centres[i, X] + c * centres[i, Y]
        nearest = min(nearest, math.hypot(x - px, y - py))
    return nearest
