"""The preferred velocity: towards the farthest point of the path ahead that can be seen, as fast as the robot may."""

from __future__ import annotations

import math

from arena_kernels.compiled import borrowing
from arena_kernels.half_planes import FloatArray
from arena_kernels.paths import nearest_index
from arena_kernels.window import Outline, Window, distance_at
from arena_orca.parameters import ACKERMANN, OMNIDIRECTIONAL, Body, DriveRules, Limits

STEP = 0.05  # m between two looks along a line of sight


@borrowing
def in_sight(window: Window, x: float, y: float, to_x: float, to_y: float, needed: float) -> bool:
    """Tell whether a disc of radius ``needed`` fits along the straight line between two positions."""
    parts = max(1, math.ceil(math.hypot(to_x - x, to_y - y) / STEP))
    for k in range(1, parts + 1):  # noqa: SIM110 - kernels know no generators
        if distance_at(window, x + (to_x - x) * k / parts, y + (to_y - y) * k / parts) < needed:
            return False
    return True


@borrowing
def target_on(path: FloatArray, window: Window, outline: Outline, x: float, y: float, lookahead: float) -> tuple[float, float, bool]:
    """Return the point of the path to drive to from (x, y): at most ``lookahead`` m on and in sight; and whether it is the last."""
    first = nearest_index(path, x, y)
    found, along = first, 0.0
    for i in range(first + 1, len(path)):
        along += math.hypot(path[i, 0] - path[i - 1, 0], path[i, 1] - path[i - 1, 1])
        if along > 0.25 * lookahead and not in_sight(window, x, y, path[i, 0], path[i, 1], outline.inscribed_radius):
            break
        found = i
        if along >= lookahead:
            break
    return path[found, 0], path[found, 1], found == len(path) - 1


@borrowing
def preferred_velocity(
    path: FloatArray,
    window: Window,
    outline: Outline,
    body: Body,
    limits: Limits,
    drive: DriveRules,
    stand: tuple[float, float, float, float],
    gear: float,
) -> tuple[float, float]:
    """Return the velocity of the effective centre that the path asks for, seen from the robot at ``stand`` (x, y, cosine, sine).

    Robots that steer or turn face the target first; in the backward ``gear`` a steered robot turns as it would forwards.
    """
    x, y, cosine, sine = stand
    to_x, to_y, last = target_on(path, window, outline, x, y, drive.lookahead)
    dx, dy = to_x - x, to_y - y
    forward, left, away = cosine * dx + sine * dy, cosine * dy - sine * dx, math.hypot(dx, dy)
    speed = min(limits.vx_max, away / drive.goal_time) if last else limits.vx_max
    if away < 1e-9:
        return 0.0, 0.0
    if body.kinematics == OMNIDIRECTIONAL:
        return speed * forward / away, speed * left / away
    bearing = math.atan2(left, forward)
    turn = min(max(bearing / drive.turn_time, -limits.wz_max), limits.wz_max)
    ahead = speed * max(0.0, math.cos(bearing))
    if body.kinematics == ACKERMANN:
        ahead = gear * speed * (max(0.25, math.cos(bearing)) if gear > 0.0 else 0.25)
        steered = abs(ahead) / limits.turn_radius
        turn = min(max(turn, -steered), steered)
    return ahead, body.ahead * turn
