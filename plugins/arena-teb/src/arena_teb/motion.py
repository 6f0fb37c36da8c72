"""The command that a band asks for, and the ways out when it asks for too much."""

from __future__ import annotations

import math

import numpy as np

from arena_core import Twist
from arena_kernels.compiled import compiled
from arena_teb.columns import THETA, TIME, X, Y
from arena_teb.problem import FloatArray
from arena_teb.terms import wrap_to_pi


@compiled
def first_velocity(band: FloatArray, period: float) -> FloatArray:
    """Return the body velocity (3,) that leads to where a band (N, 4) is after about a control period."""
    k, time = 0, band[0, TIME]
    while time < period - 1e-9 and k + 2 < len(band):
        k += 1
        time += band[k, TIME]
    turn = wrap_to_pi(band[k + 1, THETA] - band[0, THETA])
    heading = band[0, THETA] + 0.5 * turn
    dx, dy = band[k + 1, X] - band[0, X], band[k + 1, Y] - band[0, Y]
    c, s = math.cos(heading), math.sin(heading)
    return np.array(((c * dx + s * dy) / time, (c * dy - s * dx) / time, turn / time))


def saturate_velocity(
    velocity: FloatArray, least: FloatArray, most: FloatArray, turn_radius: float, *, holonomic: bool
) -> Twist:
    """Return a velocity within limits, slowed down as a whole so that its curvature stays;
    sideways only if ``holonomic``.
    """
    vx, vy, wz = velocity.tolist()
    share = 1.0
    for speed, low, high in zip((vx, vy if holonomic else 0.0, wz), least.tolist(), most.tolist(), strict=True):
        if speed > high:
            share = min(share, high / speed)
        elif speed < low:
            share = min(share, low / speed)
    vx, vy, wz = share * vx, share * vy if holonomic else 0.0, share * wz
    if turn_radius > 0.0:
        wz = math.copysign(min(abs(wz), abs(vx) / turn_radius), wz)
    return Twist(vx, vy, wz)
