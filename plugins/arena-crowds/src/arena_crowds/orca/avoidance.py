"""The velocity that one person chooses: half-planes of walls, robots and neighbours, then the linear programme."""

from __future__ import annotations

from math import cos, pi, sin, sqrt

import numpy as np
from numpy.typing import NDArray

from arena_crowds.orca.parameters import OrcaRules
from arena_kernels.compiled import borrowing
from arena_kernels.crowds import Bodies, Robots, robot_at
from arena_kernels.ground import Ground, clearance_and_gradient
from arena_kernels.half_planes import put_bound, put_person
from arena_kernels.linear_program import Wish, nearest_allowed, safest_velocity

Floats = NDArray[np.float64]

LOOKS = 8  # directions in which walls beside the nearest one are looked for
WALLS = LOOKS + 1
WITHIN = 0.95  # share of the free disc's radius at which that is done: beyond it a position may lie inside a wall
BEHIND = 1e-6  # m
COSINES = np.array([cos(2.0 * pi * look / LOOKS) for look in range(LOOKS)])
SINES = np.array([sin(2.0 * pi * look / LOOKS) for look in range(LOOKS)])


@borrowing
def choose_velocity(
    i: int,
    bodies: Bodies,
    near: NDArray[np.int32],
    wish: tuple[float, float],
    speed: float,
    ground: Ground,
    robots: Robots,
    rules: OrcaRules,
    lines: Floats,
    scratch: Floats,
) -> tuple[float, float]:
    """Return the velocity nearest to ``wish`` that stays clear of all, or the safest; walls are never given up for
    people.

    ``near`` are the neighbours, nearest first.
    """
    positions, velocities, radii, _ = bodies
    x, y, own, radius = positions[i, 0], positions[i, 1], (velocities[i, 0], velocities[i, 1]), radii[i]
    walls = _put_walls(lines, ground, x, y, radius, speed, rules, scratch)
    count = walls
    if rules.yields:
        how = (rules.horizon, rules.overlap_time, rules.robot_share)
        for member in range(len(robots.radii)):
            robot = robot_at(robots, member)
            place = (robot.x - x, robot.y - y, robot.vx, robot.vy)
            put_person(lines, count, place, own, radius + robot.radius + rules.robot_margin, how)
            count += 1
    how = (rules.horizon, rules.overlap_time, 0.5)
    for j in near:
        place = (positions[j, 0] - x, positions[j, 1] - y, velocities[j, 0], velocities[j, 1])
        put_person(lines, count, place, own, radius + radii[j], how)
        count += 1
    kept, vx, vy = nearest_allowed(lines, count, speed, Wish(wish, False))
    if kept < walls:  # squeezed between walls: they alone decide
        return safest_velocity(lines, 0, walls, kept, speed, (vx, vy), scratch)
    if kept < count:
        return safest_velocity(lines, walls, count, kept, speed, (vx, vy), scratch)
    return vx, vy


@borrowing
def _put_walls(
    lines: Floats, ground: Ground, x: float, y: float, radius: float, speed: float, rules: OrcaRules, points: Floats
) -> int:
    """Write a half-plane for the nearest point of the walls, drop what lies behind it, and so on; return how many there
    are.

    The convex free space round a position, after Deits and Tedrake, Computing large convex regions of obstacle-free
    space, WAFR 2014.
    """
    reach = radius + speed * rules.wall_horizon
    count = _near_walls(ground, x, y, reach, points)
    row = 0
    while count > 0:
        nearest = 0
        for k in range(count):
            if points[k, 2] < points[nearest, 2]:
                nearest = k
        nx, ny, away = points[nearest, 0], points[nearest, 1], points[nearest, 2]
        gap = away - radius
        put_bound(lines, row, nx, ny, gap / (rules.wall_horizon if gap > 0.0 else rules.overlap_time))
        row += 1
        left = 0
        for k in range(count):
            if points[k, 2] * (points[k, 0] * nx + points[k, 1] * ny) < away - BEHIND and k != nearest:
                points[left, 0], points[left, 1], points[left, 2] = points[k, 0], points[k, 1], points[k, 2]
                left += 1
        count = left
    return row


@borrowing
def _near_walls(ground: Ground, x: float, y: float, reach: float, points: Floats) -> int:
    """Write points of the walls within ``reach`` m as rows (unit vector towards it, distance): the nearest one, and
    those nearest to places at the rim of the free disc.
    """
    room, gx, gy = clearance_and_gradient(ground, x, y)
    steepness = sqrt(gx * gx + gy * gy)
    if not room < reach or steepness < BEHIND:
        return 0
    points[0, 0], points[0, 1], points[0, 2] = -gx / steepness, -gy / steepness, room
    found = 1
    for look in range(LOOKS if room > 0.0 else 0):
        ux, uy = WITHIN * room * COSINES[look], WITHIN * room * SINES[look]
        further, gx, gy = clearance_and_gradient(ground, x + ux, y + uy)
        steepness = sqrt(gx * gx + gy * gy)
        if steepness < BEHIND:
            continue
        wx, wy = ux - further * gx / steepness, uy - further * gy / steepness
        away = sqrt(wx * wx + wy * wy)
        if BEHIND < away < reach:
            points[found, 0], points[found, 1], points[found, 2] = wx / away, wy / away, away
            found += 1
    return found
