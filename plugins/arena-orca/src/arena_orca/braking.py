"""The last word: the exact footprint, along the command's arc until the robot stands, in the window."""

from __future__ import annotations

import math

from arena_kernels.compiled import borrowing
from arena_kernels.window import Outline, Window, clearance
from arena_orca.parameters import Limits

LENGTH_STEP, TURN_STEP = 0.05, 0.15  # m and rad between two poses that are looked at


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
    command: tuple[float, float, float],
    period: float,
    gap: float,
) -> bool:
    """Tell whether the footprint keeps ``gap`` m for one period of ``command`` and while it is braked, every speed alike, to rest."""
    x, y, cosine, sine = stand
    vx, vy, wz = command
    braking = max(abs(vx) / limits.ax_max, abs(wz) / limits.alpha_max)
    if limits.ay_max > 0.0:
        braking = max(braking, abs(vy) / limits.ay_max)
    time = period + 0.5 * braking  # at full speed: the braking path is half as long
    steps = max(1, math.ceil(max(math.hypot(vx, vy) * time / LENGTH_STEP, abs(wz) * time / TURN_STEP)))
    lapse = time / steps
    half_c, half_s = math.cos(0.5 * wz * lapse), math.sin(0.5 * wz * lapse)
    for _ in range(steps):
        cosine, sine = cosine * half_c - sine * half_s, sine * half_c + cosine * half_s
        x += (cosine * vx - sine * vy) * lapse
        y += (sine * vx + cosine * vy) * lapse
        cosine, sine = cosine * half_c - sine * half_s, sine * half_c + cosine * half_s
        if clearance(window, outline, x, y, cosine, sine, gap) < gap:
            return False
    return True
