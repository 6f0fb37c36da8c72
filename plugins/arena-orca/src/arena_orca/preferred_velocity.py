"""The preferred velocity: towards the farthest point of the path ahead that can be seen, as fast as the robot may."""

from __future__ import annotations

import math

from arena_kernels.compiled import borrowing
from arena_kernels.costmap_window import CostmapWindow, Outline
from arena_kernels.half_planes import FloatArray
from arena_kernels.lookahead import farthest_in_sight
from arena_orca.columns import X, Y
from arena_orca.parameters import ACKERMANN, OMNIDIRECTIONAL, Body, DriveRules, Limits

STEP = 0.05  # m between two looks along a line of sight


@borrowing
def preferred_velocity(
    path: FloatArray,
    window: CostmapWindow,
    outline: Outline,
    body: Body,
    limits: Limits,
    drive: DriveRules,
    stand: tuple[float, float, float, float],
    gear: float,
) -> tuple[float, float]:
    """Return the velocity of the effective centre that the path asks for, seen from the robot at ``stand`` (x, y,
    cosine, sine).

    Robots that steer or turn face the target first; in the backward ``gear`` a steered robot turns as it would
    forwards.
    """
    x, y, cosine, sine = stand
    target = farthest_in_sight(path, window, outline.inscribed_radius, x, y, drive.lookahead, STEP)
    dx, dy, last = path[target, X] - x, path[target, Y] - y, target == len(path) - 1
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
