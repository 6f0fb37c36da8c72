"""The obstacle critic: follows a sample's arc with the robot's outline over the window's distance field."""

from __future__ import annotations

import math

from arena_dwa.columns import X, Y
from arena_dwa.settings import Body, BodyOnWindow, Limits, RollOut
from arena_dwa.trajectory import PlanarPose, compose_poses, pose_after_arc
from arena_kernels.compiled import borrowing
from arena_kernels.costmap_window import CostmapWindow, allowed_gap, distance_at, outline_clearance

REJECTED = -1.0
# by which distance between cells falls at most, per m of way: as they are interpolated, below the root of 2
STEEPEST = 1.5


@borrowing
def cell_cost(window: CostmapWindow, x: float, y: float) -> float:
    """Return the cost of the cell at a position inside the window."""
    return float(
        window.costs[int((y - window.origin_y) / window.resolution), int((x - window.origin_x) / window.resolution)]
    )


@borrowing
def outline_growth(body: Body, limits: Limits, speed: float) -> float:
    """Return how far the outline is widened at ``speed``, m: ROS's scaling_speed and max_scaling_factor."""
    if speed <= body.scaling_speed or limits.trans_max <= body.scaling_speed:
        return 0.0
    return (
        body.outline.inscribed_radius
        * body.max_scaling_factor
        * (speed - body.scaling_speed)
        / (limits.trans_max - body.scaling_speed)
    )


@borrowing
def stopping_time(vx: float, vy: float, wz: float, limits: Limits) -> float:
    """Return how long the robot brakes from a velocity, s."""
    time = max(abs(vx) / limits.ax_max, abs(wz) / limits.alpha_max)
    return max(time, abs(vy) / limits.ay_max) if limits.ay_max > 0.0 else time


@borrowing
def free_around(window: CostmapWindow, body: Body, stand: PlanarPose) -> float:
    """Return how much room there is about the circle round the outline, up to the nearest lethal
    cell and to the window's edge, m.
    """
    rows, columns = window.distance.shape
    east, north = stand[X] - window.origin_x, stand[Y] - window.origin_y
    edge = min(min(east, columns * window.resolution - east), min(north, rows * window.resolution - north))
    return float(min(edge, distance_at(window, stand[X], stand[Y]) - body.outline.radius))


@borrowing
def obstacle_cost(
    ground: BodyOnWindow,
    limits: Limits,
    roll_out: RollOut,
    period: float,
    stand: PlanarPose,
    sample: tuple[float, float, float],
    start_clearance: float,
    mean: bool,
    within: float,
) -> float:
    """Return the greatest (or mean) cell cost under the robot's centre along the arc; REJECTED where the outline would
    touch.

    REJECTED too where the arc leaves the window. Well beyond ``within`` something that is no more than the cost will
    do. The arc lasts ``sim_time``, or as long as the robot needs to stop, with ``stop_time_buffer`` to spare.
    """
    vx, vy, wz = sample
    speed = math.hypot(vx, vy)
    allowed = outline_growth(ground.body, limits, speed) + allowed_gap(start_clearance, ground.body.padding, 0.0)
    braking = 0.5 * stopping_time(vx, vy, wz, limits)  # at full speed as far as the robot comes while it brakes evenly
    time = max(roll_out.sim_time, period + braking + roll_out.stop_time_buffer)
    steps = max(
        1, math.ceil(max(speed * time / roll_out.sim_granularity, abs(wz) * time / roll_out.angular_sim_granularity))
    )
    step, length = pose_after_arc(vx, vy, wz, time / steps), speed * time / steps
    total, greatest, free = 0.0, 0.0, 0.0
    for _ in range(steps):
        stand = compose_poses(stand, step)
        free -= STEEPEST * length
        if free <= 0.0:
            free = free_around(ground.window, ground.body, stand) - allowed
            if free <= 0.0 and outline_clearance(ground.window, ground.body.outline, stand, allowed) < allowed:
                return REJECTED
        cost = cell_cost(ground.window, stand[X], stand[Y])
        total += cost
        greatest = max(greatest, cost)
        if (total / steps if mean else greatest) > 1.001 * within + 1e-6:
            break
    return total / steps if mean else greatest
