"""The last word: the exact footprint, for one period of a command and while the robot is braked to rest, in the window."""

from __future__ import annotations

import math

from arena_kernels.compiled import borrowing
from arena_kernels.window import Outline, Window, clearance
from arena_orca.motion import toward
from arena_orca.parameters import Limits

LAPSE = 0.02  # s between two poses that are looked at: a cell at most, for robots below 2.5 m/s
MOST_LOOKS = 500
Stand = tuple[float, float, float, float]  # x, y (m, map), cosine and sine of the heading


@borrowing
def allowed_gap(gap_now: float, padding: float, resolution: float) -> float:
    """Return how near an obstacle may be, m: the padding, or somewhat less than now where the robot already stands nearer."""
    return min(padding, 0.5 * gap_now if gap_now > 0.0 else gap_now - 0.5 * resolution)


@borrowing
def next_twist(limits: Limits, twist: tuple[float, float, float], command: tuple[float, float, float]) -> tuple[float, float, float]:
    """Return the twist ``LAPSE`` s on, led to ``command`` within the accelerations; a car that brakes keeps its bend."""
    vx = toward(twist[0], command[0], limits.ax_max * LAPSE)
    if limits.turn_radius > 0.0 and command[0] == 0.0:
        return vx, 0.0, twist[2] * vx / twist[0] if twist[0] != 0.0 else 0.0
    return vx, toward(twist[1], command[1], limits.ay_max * LAPSE), toward(twist[2], command[2], limits.alpha_max * LAPSE)


@borrowing
def next_stand(stand: Stand, twist: tuple[float, float, float]) -> Stand:
    """Return where a robot with ``twist`` is ``LAPSE`` s on."""
    x, y, cosine, sine = stand
    vx, vy, wz = twist
    half_c, half_s = math.cos(0.5 * wz * LAPSE), math.sin(0.5 * wz * LAPSE)
    cosine, sine = cosine * half_c - sine * half_s, sine * half_c + cosine * half_s
    x, y = x + (cosine * vx - sine * vy) * LAPSE, y + (sine * vx + cosine * vy) * LAPSE
    return x, y, cosine * half_c - sine * half_s, sine * half_c + cosine * half_s


@borrowing
def stand_after(limits: Limits, stand: Stand, twist: tuple[float, float, float], command: tuple[float, float, float], time: float) -> Stand:
    """Return where a robot with ``twist`` is when ``command`` was held for ``time`` s."""
    for _ in range(round(time / LAPSE)):
        twist = next_twist(limits, twist, command)
        stand = next_stand(stand, twist)
    return stand


@borrowing
def can_stop(
    window: Window,
    outline: Outline,
    limits: Limits,
    stand: Stand,
    twist: tuple[float, float, float],
    command: tuple[float, float, float],
    time: float,
    gap: float,
) -> bool:
    """Tell whether the footprint keeps ``gap`` m when ``command`` is held for ``time`` s and then every axis braked, from ``twist`` now."""
    held = round(time / LAPSE)
    for look in range(MOST_LOOKS):
        twist = next_twist(limits, twist, command if look < held else (0.0, 0.0, 0.0))
        if look >= held and twist[0] == 0.0 and twist[1] == 0.0 and twist[2] == 0.0:
            break
        stand = next_stand(stand, twist)
        if clearance(window, outline, stand[0], stand[1], stand[2], stand[3], gap) < gap:
            return False
    return True
