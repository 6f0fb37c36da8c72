"""Slow arcs out of a place where no band is feasible."""

from __future__ import annotations

import math

import numpy as np

from arena_kernels.compiled import compiled
from arena_kernels.window import Outline, Window, allowed_gap, clearance
from arena_teb.feasibility import LEAST_GAP
from arena_teb.problem import FloatArray

LOOK = 1.0  # s that an arc is followed
STEPS = 10
ENOUGH = 0.3  # m of clearance, beyond which more is worth nothing


@compiled
def escape_command(
    start: FloatArray,
    window: Window,
    outline: Outline,
    positions: FloatArray,
    velocities: FloatArray,
    radii: FloatArray,
    commands: FloatArray,
) -> FloatArray:
    """Return the row of ``commands`` (C, 3) whose arc ends with most clearance and never has less than where it begins; none: empty."""
    here = clearance(window, outline, start[0], start[1], math.cos(start[2]), math.sin(start[2]), ENOUGH)
    least = allowed_gap(here, LEAST_GAP)
    best, chosen = here + 0.005, -1
    for i in range(len(commands)):
        x, y, theta, gap = start[0], start[1], start[2], math.inf
        for step in range(STEPS):
            dt = LOOK / STEPS
            heading = theta + 0.5 * dt * commands[i, 2]
            x += dt * (commands[i, 0] * math.cos(heading) - commands[i, 1] * math.sin(heading))
            y += dt * (commands[i, 0] * math.sin(heading) + commands[i, 1] * math.cos(heading))
            theta += dt * commands[i, 2]
            gap = clearance(window, outline, x, y, math.cos(theta), math.sin(theta), ENOUGH)
            for j in range(len(radii)):
                time = (step + 1) * dt
                ox, oy = positions[j, 0] + time * velocities[j, 0] - x, positions[j, 1] + time * velocities[j, 1] - y
                gap = min(gap, math.hypot(ox, oy) - radii[j] - outline.radius)
            if gap < least:
                break
        gap = min(gap, ENOUGH)
        if gap >= least and gap > best:
            best, chosen = gap, i
    return commands[chosen : chosen + 1].copy() if chosen >= 0 else np.empty((0, 3))
