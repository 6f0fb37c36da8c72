"""The obstacle critic: follows a sample's arc with the robot's outline over the window's distance field."""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from arena_dwa.map_grid import interpolated
from arena_dwa.parameters import Body, FloatArray, Limits, RollOut, Window
from arena_dwa.trajectory import Stand, arc, moved

REJECTED = -1.0


@njit(cache=True)
def obstacle_distance(window: Window, x: float, y: float) -> float:
    """Return the distance from a position to the nearest lethal cell's edge, m, interpolated between cells; outside the window -inf."""
    rows, columns = window.distance.shape
    u, v = (x - window.origin_x) / window.resolution - 0.5, (y - window.origin_y) / window.resolution - 0.5
    if u < -0.5 or v < -0.5 or u >= columns - 0.5 or v >= rows - 0.5:
        return -math.inf
    if math.isinf(window.distance[0, 0]):  # a field is infinite everywhere or nowhere
        return math.inf
    return interpolated(window.distance, window, x, y) - 0.5 * window.resolution


@njit(cache=True)
def cell_cost(window: Window, x: float, y: float) -> float:
    """Return the cost of the cell at a position inside the window."""
    return float(window.costs[int((y - window.origin_y) / window.resolution), int((x - window.origin_x) / window.resolution)])


@njit(cache=True)
def clearance(window: Window, body: Body, stand: Stand, enough: float) -> float:
    """Return how far the outline is from the nearest lethal cell, m, negative in collision; beyond ``enough`` a lower bound will do."""
    x, y, c, s = stand
    centre = obstacle_distance(window, x, y)
    if len(body.outline_xy) == 0 or centre - body.radius > enough:
        return centre - body.radius
    least = centre - body.inscribed_radius
    for i in range(len(body.outline_xy)):
        px, py = body.outline_xy[i]
        least = min(least, obstacle_distance(window, x + c * px - s * py, y + s * px + c * py))
    return least


@njit(cache=True)
def outline_growth(body: Body, limits: Limits, speed: float) -> float:
    """Return how far the outline is widened at ``speed``, m: ROS's scaling_speed and max_scaling_factor."""
    if speed <= body.scaling_speed or limits.trans_max <= body.scaling_speed:
        return 0.0
    return body.inscribed_radius * body.max_scaling_factor * (speed - body.scaling_speed) / (limits.trans_max - body.scaling_speed)


@njit(cache=True)
def stopping_time(vx: float, vy: float, wz: float, limits: Limits) -> float:
    """Return how long the robot brakes from a velocity, s."""
    time = max(abs(vx) / limits.ax_max, abs(wz) / limits.alpha_max)
    return max(time, abs(vy) / limits.ay_max) if limits.ay_max > 0.0 else time


@njit(cache=True)
def least_gap(window: Window, body: Body, start_clearance: float) -> float:
    """Return how near an obstacle may be, m: the padding, or somewhat less than now where the robot already stands nearer."""
    nearer = 0.5 * start_clearance if start_clearance > 0.0 else start_clearance - 0.5 * window.resolution
    return min(body.padding, nearer)


@njit(cache=True)
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
    time = max(roll_out.sim_time, period + stopping_time(vx, vy, wz, limits) + roll_out.stop_time_buffer)
    steps = max(1, math.ceil(max(speed * time / roll_out.sim_granularity, abs(wz) * time / roll_out.angular_sim_granularity)))
    step = arc(vx, vy, wz, time / steps)
    total, greatest = 0.0, 0.0
    for _ in range(steps):
        stand = moved(stand, step)
        if clearance(window, body, stand, allowed) < allowed:
            return REJECTED
        cost = cell_cost(window, stand[0], stand[1])
        total += cost
        greatest = max(greatest, cost)
    return total / steps if mean else greatest


def footprint_outline(vertices_xy: FloatArray, spacing: float) -> FloatArray:
    """Return points along a polygon's edges, at most ``spacing`` m apart, (S, 2)."""
    points = [(0.0, 0.0)]
    for i in range(len(vertices_xy)):
        a, b = vertices_xy[i], vertices_xy[(i + 1) % len(vertices_xy)]
        parts = math.ceil(math.hypot(b[0] - a[0], b[1] - a[1]) / spacing)
        points.extend([(a[0] + (b[0] - a[0]) * k / parts, a[1] + (b[1] - a[1]) * k / parts) for k in range(parts)])
    return np.array(points[1:]).reshape(-1, 2)
