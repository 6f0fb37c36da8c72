"""Slow ways out of a place where a planner finds no other: the arc that ends with most room,
people's motion foreseen.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from arena_kernels.compiled import borrowing, compiled
from arena_kernels.costmap_window import CLOSE, CostmapWindow, Outline, allowed_gap, keeps_from_walls, outline_clearance
from arena_kernels.foreseen import Foreseen, leg_at, place_on

FloatArray = NDArray[np.float64]

LOOK = 1.0  # s that an arc is followed
STEPS = 10
ENOUGH = 0.3  # m of clearance, beyond which more is worth nothing


@compiled
def escape_command(
    start: FloatArray,
    window: CostmapWindow,
    outline: Outline,
    foreseen: Foreseen,
    radii: FloatArray,
    commands: FloatArray,
    wanted: float,
) -> FloatArray:
    """Return the row of ``commands`` (C, 3) whose arc ends with most clearance; none: empty.

    It keeps the ``wanted`` gap, m, or half of the one where it begins. Discs with ``radii``
    (K,) go where they are ``foreseen``.
    """
    here = outline_clearance(window, outline, (start[0], start[1], math.cos(start[2]), math.sin(start[2])), ENOUGH)
    least = allowed_gap(here, wanted, CLOSE)
    best, chosen = here + 0.005, -1
    for i in range(len(commands)):
        x, y, theta, gap = start[0], start[1], start[2], math.inf
        for step in range(STEPS):
            dt = LOOK / STEPS
            heading = theta + 0.5 * dt * commands[i, 2]
            x += dt * (commands[i, 0] * math.cos(heading) - commands[i, 1] * math.sin(heading))
            y += dt * (commands[i, 0] * math.sin(heading) + commands[i, 1] * math.cos(heading))
            theta += dt * commands[i, 2]
            gap = outline_clearance(window, outline, (x, y, math.cos(theta), math.sin(theta)), ENOUGH)
            time = (step + 1) * dt
            leg = leg_at(foreseen, time)
            for j in range(len(radii)):
                px, py = place_on(foreseen, j, leg, time)
                gap = min(gap, math.hypot(px - x, py - y) - radii[j] - outline.radius)
            if gap < least:
                break
        gap = min(gap, ENOUGH)
        if gap >= least and gap > best:
            best, chosen = gap, i
    return commands[chosen : chosen + 1].copy() if chosen >= 0 else np.empty((0, 3))


def escape_commands(
    least: FloatArray, most: FloatArray, share: float, turn_radius: float, *, holonomic: bool
) -> FloatArray:
    """Return slow velocities (C, 3) in all directions that the robot can move."""
    forward, backward = share * most[0], share * least[0]
    turns = np.array((0.0, 0.5, -0.5, 1.0, -1.0)) * min(most[2], 1.0)
    if turn_radius > 0.0:
        return np.array(
            [(v, 0.0, math.copysign(min(abs(w), abs(v) / turn_radius), w)) for v in (backward, forward) for w in turns]
        )
    commands = [(v, 0.0, w) for v in (backward, forward, 0.5 * backward, 0.5 * forward, 0.0) for w in turns]
    if holonomic:
        side = share * most[1]
        commands += [(v, u, 0.0) for v in (backward, 0.0, forward) for u in (side, -side)]
    return np.array(commands)


@borrowing
def keeps_gap(
    window: CostmapWindow,
    outline: Outline,
    pose: FloatArray,
    velocity: FloatArray,
    time: float,
    turn_braking: float,
    wanted: float,
    close: float,
) -> bool:
    """Return whether a robot at ``pose`` (3,) with a body ``velocity`` (3,) keeps the ``wanted`` gap, m, for ``time``
    s.

    A polygon keeps it until it has stopped turning, with ``turn_braking`` rad/s^2. Where the robot stands nearer
    already, ``allowed_gap`` is enough. What is driven at once is so held against the exact outline: a plan may be off,
    for it thinks of mean velocities.
    """
    if len(outline.points_xy) > 0:
        time += 0.5 * abs(velocity[2]) / turn_braking
    x, y, theta = pose[0], pose[1], pose[2]
    now = (x, y, math.cos(theta), math.sin(theta))
    for _ in range(STEPS):
        dt = time / STEPS
        heading = theta + 0.5 * dt * velocity[2]
        x += dt * (velocity[0] * math.cos(heading) - velocity[1] * math.sin(heading))
        y += dt * (velocity[0] * math.sin(heading) + velocity[1] * math.cos(heading))
        theta += dt * velocity[2]
        if not keeps_from_walls(window, outline, now, (x, y, math.cos(theta), math.sin(theta)), wanted, close):
            return False
    return True
