"""What moves: the tracked obstacles that matter most to a plan, where they are expected."""

from __future__ import annotations

import math

import numpy as np

from arena_kernels.compiled import borrowing, compiled
from arena_kernels.foreseen import Foreseen, leg_at, place_on
from arena_mpc.arrays import FloatArray
from arena_mpc.columns import MOVER, MOVER_RADIUS, MOVER_VX, MOVER_VY, MOVER_X, MOVER_Y, THETA, X, Y
from arena_mpc.footprint import Discs
from arena_mpc.plan import Plan
from arena_mpc.scene import Scene

FAR = 1e3  # m, where the obstacles stand that fill a problem up
NEAR = 0.01  # m, more than what is rounded off
SPACING = 0.05  # s, between two moments that are checked


def relevant_movers(scene: Scene, positions: FloatArray, step: float, distance: float, count: int) -> FloatArray:
    """Return ``count`` rows (x, y, vx, vy, radius) for each of ``positions`` (N + 1, 2): the discs that come nearest to
    them, radii grown by ``distance``.

    Position k is reached ``k * step`` s from now; what a row says holds about then, and x, y are where the disc would
    have begun now. Rows without a disc stand far away.
    """
    return _nearest_movers(scene.foreseen, scene.radii, positions, step, distance, count)


def first_hit(scene: Scene, plan: Plan, discs: Discs, deeper: float) -> float:
    """Return after how many seconds discs of the footprint that drive a plan first touch what moves, inf if never.

    A disc that would touch a robot that stands counts when it is touched by ``deeper`` m more: standing is then no
    better.
    """
    return _first_hit(
        scene.foreseen,
        scene.radii,
        plan.states,
        plan.step,
        discs.centres_xy,
        discs.radius,
        deeper,
    )


@compiled
def _nearest_movers(
    foreseen: Foreseen,
    radii: FloatArray,
    places: FloatArray,
    step: float,
    distance: float,
    count: int,
) -> FloatArray:
    """Return the movers (N + 1, count, MOVER) among K discs, the one that comes nearest first."""
    chosen, gaps, filled = np.empty(count, np.int64), np.empty(count), 0
    for track in range(len(radii) if count > 0 else 0):
        nearest = math.inf
        for k in range(len(places)):
            time = k * step
            x, y = place_on(foreseen, track, leg_at(foreseen, time), time)
            nearest = min(nearest, math.hypot(x - places[k, 0], y - places[k, 1]))
        gap, row = nearest - radii[track], filled
        while row > 0 and gap < gaps[row - 1]:
            row -= 1
        if row == count:
            continue
        filled = min(filled + 1, count)
        for below in range(filled - 1, row, -1):
            gaps[below] = gaps[below - 1]
            chosen[below] = chosen[below - 1]
        gaps[row], chosen[row] = gap, track
    rows = np.zeros((len(places), count, MOVER))
    rows[:, :, :2] = FAR
    for k in range(len(places)):
        leg = leg_at(foreseen, k * step)
        for row in range(filled):
            track = chosen[row]
            vx, vy = foreseen.velocities[track, leg, X], foreseen.velocities[track, leg, Y]
            rows[k, row, MOVER_X] = foreseen.places[track, leg, X] - foreseen.times[leg] * vx
            rows[k, row, MOVER_Y] = foreseen.places[track, leg, Y] - foreseen.times[leg] * vy
            rows[k, row, MOVER_VX], rows[k, row, MOVER_VY] = vx, vy
            rows[k, row, MOVER_RADIUS] = radii[track] + distance
    return rows


@borrowing
def _first_hit(
    foreseen: Foreseen,
    radii: FloatArray,
    states: FloatArray,
    step: float,
    centres: FloatArray,
    radius: float,
    deeper: float,
) -> float:
    """Look at every ``SPACING`` of a plan (N + 1, 3 or more) where discs round ``centres`` (C, 2) and movers are."""
    duration = (len(states) - 1) * step
    first, moments = (states[0, X], states[0, Y], states[0, THETA]), math.ceil((duration + 1e-9) / SPACING)
    hit = moments  # that of the tracks looked at so far
    driven = _plan_reach(states, centres) + radius + NEAR
    for track in range(len(radii)):
        x, y = foreseen.places[track, 0, X], foreseen.places[track, 0, Y]
        away = math.hypot(x - first[0], y - first[1]) - radii[track]
        if away - _top_speed(foreseen, track) * duration > driven:
            continue  # wherever both are within the duration, they are farther apart
        touched = radii[track] + radius
        for moment in range(hit):
            time = moment * SPACING
            x, y = place_on(foreseen, track, leg_at(foreseen, time), time)
            standing = _disc_distance(x, y, first, centres) - touched
            allowed = 0.0 if standing > 0.0 else standing - deeper
            if _disc_distance(x, y, _pose_at(states, step, time), centres) - touched < allowed:
                hit = moment
                break
    return hit * SPACING if hit < moments else math.inf


@borrowing
def _top_speed(foreseen: Foreseen, disc: int) -> float:
    """Return how fast a disc ever goes, m/s."""
    fastest = 0.0
    for leg in range(len(foreseen.times)):
        fastest = max(fastest, math.hypot(foreseen.velocities[disc, leg, X], foreseen.velocities[disc, leg, Y]))
    return fastest


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
