"""From twists to velocities of the effective centre and back: Snape, van den Berg, Guy, Manocha, Smooth Navigation
(IROS 2010).

A point ahead of a driven axle can move in every direction at once: forward with vx, sideways with its distance times
wz. Velocities are seen from the robot, in ``base_link``.
"""

from __future__ import annotations

import math

from arena_kernels.compiled import borrowing
from arena_kernels.half_planes import FloatArray, put_bound
from arena_orca.parameters import ACKERMANN, OMNIDIRECTIONAL, Body, Limits

FORWARD, BACKWARD = 1.0, -1.0


@borrowing
def sideways_limits(body: Body, limits: Limits) -> tuple[float, float]:
    """Return the effective centre's greatest speed (m/s) and acceleration (m/s^2) to a side."""
    if body.kinematics == OMNIDIRECTIONAL:
        return limits.vy_max, limits.ay_max
    return body.ahead * limits.wz_max, body.ahead * limits.alpha_max


@borrowing
def centre_velocity(body: Body, limits: Limits, vx: float, vy: float, wz: float) -> tuple[float, float]:
    """Return the effective centre's velocity at a twist, led back to the limits."""
    side, _ = sideways_limits(body, limits)
    aside = vy if body.kinematics == OMNIDIRECTIONAL else body.ahead * wz
    forward = min(max(vx, limits.vx_min), limits.vx_max)
    if body.kinematics == ACKERMANN:
        side = min(side, abs(forward) * body.ahead / limits.turn_radius)
    return forward, min(max(aside, -side), side)


@borrowing
def top_speed(body: Body, limits: Limits) -> float:
    """Return a bound of the effective centre's speed: for omnidirectional robots in any
    direction, else one that holds all twists.
    """
    forward, (side, _) = max(limits.vx_max, -limits.vx_min), sideways_limits(body, limits)
    return max(forward, side) if body.kinematics == OMNIDIRECTIONAL else math.hypot(forward, side) * 1.000001


@borrowing
def put_reach(
    lines: FloatArray, row: int, body: Body, limits: Limits, now: tuple[float, float], reach_time: float, gear: float
) -> int:
    """Write the half-planes of velocities within the limits that can be had ``reach_time`` s from now; return the next
    row.

    An Ackermann robot turns no tighter than its steering allows: in one gear, a cone.
    """
    side, side_change = sideways_limits(body, limits)
    forward_change, aside_change = limits.ax_max * reach_time, side_change * reach_time
    high, low = min(limits.vx_max, now[0] + forward_change), max(limits.vx_min, now[0] - forward_change)
    put_bound(lines, row, 1.0, 0.0, high)
    put_bound(lines, row + 1, -1.0, 0.0, -low)
    put_bound(lines, row + 2, 0.0, 1.0, min(side, now[1] + aside_change))
    put_bound(lines, row + 3, 0.0, -1.0, -max(-side, now[1] - aside_change))
    if body.kinematics != ACKERMANN:
        return row + 4
    length = math.hypot(limits.turn_radius, body.ahead)
    put_bound(lines, row + 4, -gear * body.ahead / length, limits.turn_radius / length, 0.0)
    put_bound(lines, row + 5, -gear * body.ahead / length, -limits.turn_radius / length, 0.0)
    return row + 6


@borrowing
def step_towards(now: float, wanted: float, most: float) -> float:
    """Return ``wanted``, or what is nearest to it within ``most`` of ``now``."""
    return min(max(wanted, now - most), now + most)


@borrowing
def command_for(
    body: Body, limits: Limits, twist: tuple[float, float, float], wish: tuple[float, float], period: float
) -> tuple[float, float, float]:
    """Return the twist, reachable within ``period`` s of ``twist``, that comes nearest to moving the
    effective centre as wished.
    """
    if body.kinematics == OMNIDIRECTIONAL:
        return strafe_command(limits, twist, wish, period)
    vx = step_towards(twist[0], wish[0], limits.ax_max * period)
    wz = step_towards(
        twist[2], min(max(wish[1] / body.ahead, -limits.wz_max), limits.wz_max), limits.alpha_max * period
    )
    if body.kinematics == ACKERMANN:
        steered = abs(vx) / limits.turn_radius
        wz = min(max(wz, -steered), steered)
    return vx, 0.0, wz


@borrowing
def strafe_command(
    limits: Limits, twist: tuple[float, float, float], wish: tuple[float, float], period: float
) -> tuple[float, float, float]:
    """Return an omnidirectional robot's twist: it turns its front, where its scanner looks, to where it goes.

    The wish is seen from the heading in the middle of the period, else it would be driven round a bend.
    """
    wz = step_towards(twist[2], facing_rate(limits, wish), limits.alpha_max * period)
    c, s = math.cos(0.5 * wz * period), math.sin(0.5 * wz * period)
    forward, left = c * wish[0] + s * wish[1], c * wish[1] - s * wish[0]
    return (
        step_towards(twist[0], forward, limits.ax_max * period),
        step_towards(twist[1], left, limits.ay_max * period),
        wz,
    )


@borrowing
def facing_rate(limits: Limits, wish: tuple[float, float]) -> float:
    """Return the turning speed towards the direction of a velocity from which the turn can still be braked in time."""
    speed = math.hypot(wish[0], wish[1])
    if speed < 0.05:
        return 0.0
    bearing = math.atan2(wish[1], wish[0])
    return math.copysign(min(limits.wz_max, math.sqrt(limits.alpha_max * abs(bearing)), 2.0 * abs(bearing)), bearing)
