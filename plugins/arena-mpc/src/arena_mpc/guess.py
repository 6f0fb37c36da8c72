"""Where the optimisation begins: the last plan, moved on in time, or a drive along the path."""

from __future__ import annotations

import math

import numpy as np

from arena_kernels.compiled import compiled
from arena_mpc.arrays import FloatArray
from arena_mpc.columns import THETA, VELOCITIES, VX, VY, WZ, X, Y

TURN_FIRST = 1.0  # rad, bearing of the path from which the drive turns on the spot
AHEAD = 0.4  # m, how far along the path the drive steers to


@compiled
def shift_plan(
    states: FloatArray, step: float, elapsed: float, end: FloatArray, stages: int, new_step: float
) -> FloatArray:
    """Return a plan (N + 1, S) as it looks ``elapsed`` s later, in ``stages`` intervals of ``new_step`` s.

    Past its end it goes to ``end``.
    """
    last = len(states) - 1
    finish = max(elapsed + stages * new_step, last * step + 1e-6)
    moved, k = np.empty((stages + 1, states.shape[1])), 0
    for stage in range(stages + 1):
        time = elapsed + stage * new_step
        while k < last and (k + 1) * step <= time:
            k += 1
        begins, ends = k * step, (k + 1) * step if k < last else finish
        for i in range(states.shape[1]):
            to = states[k + 1, i] if k < last else end[i]
            moved[stage, i] = (
                to if time >= finish else (to - states[k, i]) / (ends - begins) * (time - begins) + states[k, i]
            )
    return moved


@compiled
def drive_along(
    path: FloatArray,
    start: FloatArray,
    speed: float,
    turn: float,
    sideways: bool,
    radius: float,
    stages: int,
    step: float,
) -> FloatArray:
    """Return a drive (N + 1, 6) of x, y, theta, vx, vy, wz from ``start`` (3,) along ``path`` (M, 3), to its end if
    there is time.

    It steers to a point of the path ahead, on the spot where that lies aside, unless ``sideways`` motion is possible;
    ``radius`` is the least of a car's turns, m, 0 for others.
    """
    drive = np.zeros((stages + 1, 6))
    drive[0, :VELOCITIES] = start
    place = 0
    for k in range(stages):
        x, y, theta = drive[k, X], drive[k, Y], drive[k, THETA]
        while place < len(path) - 1 and math.hypot(path[place, X] - x, path[place, Y] - y) < max(AHEAD, speed * step):
            place += 1
        dx, dy = path[place, X] - x, path[place, Y] - y
        left = math.hypot(dx, dy)
        bearing = 0.0
        if left > 1e-6:
            bearing = (math.atan2(dy, dx) - theta + math.pi) % (2.0 * math.pi) - math.pi
        wz = min(max(bearing / step, -turn), turn)
        go = min(speed, left / step)
        vx, vy = go, 0.0
        if sideways:
            vx, vy = go * math.cos(bearing), go * math.sin(bearing)
        elif radius > 0.0:
            wz = min(max(wz, -go / radius), go / radius)
        elif abs(bearing) > TURN_FIRST:
            vx = 0.0
        middle = theta + 0.5 * wz * step
        c, s = math.cos(middle), math.sin(middle)
        drive[k + 1, X] = x + step * (c * vx - s * vy)
        drive[k + 1, Y] = y + step * (s * vx + c * vy)
        drive[k + 1, THETA] = theta + step * wz
        drive[k + 1, VX], drive[k + 1, VY], drive[k + 1, WZ] = vx, vy, wz
    return drive
