"""The obstacle critic: follows a sample's arc with the robot's outline over the window's distance field."""

from __future__ import annotations

import math

from arena_dwa.settings import Body, Limits, RollOut
from arena_dwa.trajectory import Stand, arc, moved
from arena_kernels.compiled import compiled
from arena_kernels.window import Window, clearance

REJECTED = -1.0


@compiled
def cell_cost(window: Window, x: float, y: float) -> float:
    """Return the cost of the cell at a position inside the window."""
    return float(window.costs[int((y - window.origin_y) / window.resolution), int((x - window.origin_x) / window.resolution)])


@compiled
def outline_growth(body: Body, limits: Limits, speed: float) -> float:
    """Return how far the outline is widened at ``speed``, m: ROS's scaling_speed and max_scaling_factor."""
    if speed <= body.scaling_speed or limits.trans_max <= body.scaling_speed:
        return 0.0
    return body.outline.inscribed_radius * body.max_scaling_factor * (speed - body.scaling_speed) / (limits.trans_max - body.scaling_speed)


@compiled
def stopping_time(vx: float, vy: float, wz: float, limits: Limits) -> float:
    """Return how long the robot brakes from a velocity, s."""
    time = max(abs(vx) / limits.ax_max, abs(wz) / limits.alpha_max)
    return max(time, abs(vy) / limits.ay_max) if limits.ay_max > 0.0 else time


@compiled
def least_gap(window: Window, body: Body, start_clearance: float) -> float:
    """Return how near an obstacle may be, m: the padding, or somewhat less than now where the robot already stands nearer."""
    nearer = 0.5 * start_clearance if start_clearance > 0.0 else start_clearance - 0.5 * window.resolution
    return min(body.padding, nearer)


@compiled
def obstacle_cost(
    window: Window,
    body: Body,
    limits: Limits,
    roll_out: RollOut,
    period: float,
    stand: Stand,
    sample: tuple[float, float, float],
    start_clearance: float,
    mean: bool,
) -> float:
    """Return the greatest (or mean) cell cost under the robot's centre along the arc; REJECTED where the outline would touch.

    REJECTED too where the arc leaves the window. It lasts ``sim_time``, or as long as the robot needs to stop, with
    ``stop_time_buffer`` to spare.
    """
    vx, vy, wz = sample
    speed = math.hypot(vx, vy)
    allowed = outline_growth(body, limits, speed) + least_gap(window, body, start_clearance)
    braking = 0.5 * stopping_time(vx, vy, wz, limits)  # at full speed as far as the robot comes while it brakes evenly
    time = max(roll_out.sim_time, period + braking + roll_out.stop_time_buffer)
    steps = max(1, math.ceil(max(speed * time / roll_out.sim_granularity, abs(wz) * time / roll_out.angular_sim_granularity)))
    step = arc(vx, vy, wz, time / steps)
    total, greatest = 0.0, 0.0
    for _ in range(steps):
        stand = moved(stand, step)
        if clearance(window, body.outline, *stand, allowed) < allowed:
            return REJECTED
        cost = cell_cost(window, stand[0], stand[1])
        total += cost
        greatest = max(greatest, cost)
    return total / steps if mean else greatest
