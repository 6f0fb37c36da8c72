"""The last word: the exact footprint, for one period of a command and while the robot is braked to rest, in the window."""

from __future__ import annotations

import math

from arena_kernels.compiled import borrowing
from arena_kernels.window import Outline, Window, clearance
from arena_orca.motion import toward
from arena_orca.parameters import Limits

LAPSE = 0.02  # s between two poses that are looked at: a cell at most, for robots below 2.5 m/s
MOST_LOOKS = 500


@borrowing
def allowed_gap(gap_now: float, padding: float, resolution: float) -> float:
    """Return how near an obstacle may be, m: the padding, or somewhat less than now where the robot already stands nearer."""
    return min(padding, 0.5 * gap_now if gap_now > 0.0 else gap_now - 0.5 * resolution)


@borrowing
def can_stop(
    window: Window,
    outline: Outline,
    limits: Limits,
    stand: tuple[float, float, float, float],
    twist: tuple[float, float, float],
    command: tuple[float, float, float],
    period: float,
    gap: float,
) -> bool:
    """Tell whether the footprint keeps ``gap`` m when ``command`` is held for a period and then every axis braked, from ``twist`` now."""
    x, y, cosine, sine = stand
    vx, vy, wz = twist
    held = round(period / LAPSE)
    for look in range(MOST_LOOKS):
        holding = look < held
        vx = toward(vx, command[0] if holding else 0.0, limits.ax_max * LAPSE)
        vy = toward(vy, command[1] if holding else 0.0, limits.ay_max * LAPSE)
        wz = toward(wz, command[2] if holding else 0.0, limits.alpha_max * LAPSE)
        if not holding and vx == 0.0 and vy == 0.0 and wz == 0.0:
            break
        half_c, half_s = math.cos(0.5 * wz * LAPSE), math.sin(0.5 * wz * LAPSE)
        cosine, sine = cosine * half_c - sine * half_s, sine * half_c + cosine * half_s
        x += (cosine * vx - sine * vy) * LAPSE
        y += (sine * vx + cosine * vy) * LAPSE
        cosine, sine = cosine * half_c - sine * half_s, sine * half_c + cosine * half_s
        if clearance(window, outline, x, y, cosine, sine, gap) < gap:
            return False
    return True
