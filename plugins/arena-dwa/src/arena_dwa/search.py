"""One control step of the dynamic window approach as a single compiled call."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from arena_dwa.map_grid import grid_distance, map_grids
from arena_dwa.obstacles import REJECTED, advance, clearance, obstacle_cost
from arena_dwa.oscillation import oscillates
from arena_dwa.parameters import Body, FloatArray, Limits, MapGrids, RollOut, Scales, Window
from arena_dwa.window import axis_samples, driven, dynamic_window, turn_samples


@njit(cache=True)
def best_velocity(
    window: Window,
    path: FloatArray,
    state: FloatArray,
    period: float,
    limits: Limits,
    roll_out: RollOut,
    body: Body,
    scales: Scales,
    only: NDArray[np.int8],
) -> FloatArray:
    """Return (vx, vy, wz, cost) of the cheapest admissible sample; its cost is inf when there is none.

    ``state`` is (x, y, theta, vx, vy, wz); ``path`` (M, 3), both in ``map``. A sample is followed over obstacles only if the
    cheap critics leave it a chance, which changes no choice because no critic is negative.
    """
    pose = (state[0], state[1], state[2])
    velocities = dynamic_window(state[3:], limits, period)
    grids = map_grids(window, body, path, pose[0], pose[1], scales.forward_point_distance)
    aligning = np.hypot(path[-1, 0] - pose[0], path[-1, 1] - pose[1]) > scales.forward_point_distance
    start_clearance = clearance(window, body, pose[0], pose[1], pose[2], body.padding)
    best = np.array((0.0, 0.0, 0.0, np.inf))
    for vx in axis_samples(velocities[0, 0], velocities[0, 1], roll_out.vx_samples):
        for vy in axis_samples(velocities[1, 0], velocities[1, 1], roll_out.vy_samples):
            for wz in turn_samples(vx, velocities, limits, roll_out.vth_samples):
                if not driven(vx, vy, wz, limits) or oscillates(only, vx, vy, wz):
                    continue
                end = advance(pose, vx, vy, wz, roll_out.sim_time)
                cost = map_grid_cost(grids, window, scales, end, aligning) + motion_cost(vx, wz, scales)
                if cost >= best[3]:
                    continue
                near = obstacle_cost(window, body, limits, roll_out, period, pose, (vx, vy, wz), start_clearance, scales.occdist_mean)
                if near == REJECTED:
                    continue
                cost += scales.occdist_scale * near
                if start_clearance < body.padding:
                    cost += scales.escape_scale * lack_of_clearance(window, body, end)
                if cost < best[3]:
                    best[0], best[1], best[2], best[3] = vx, vy, wz, cost
    return best


@njit(cache=True)
def map_grid_cost(
    grids: MapGrids,
    window: Window,
    scales: Scales,
    end: tuple[float, float, float],
    aligning: bool,
) -> float:
    """Return path, goal, alignment and goal-front critics of the last pose: each pair shares its bias, as in ROS."""
    x, y, theta = end
    front_x = x + scales.forward_point_distance * np.cos(theta)
    front_y = y + scales.forward_point_distance * np.sin(theta)
    to_goal = grid_distance(grids.goal, window, x, y) + grid_distance(grids.goal_front, window, front_x, front_y)
    to_path = grid_distance(grids.path, window, x, y)
    if aligning:
        to_path += grid_distance(grids.path, window, front_x, front_y)
    return 0.5 * (scales.path_distance_bias * to_path + scales.goal_distance_bias * to_goal)


@njit(cache=True)
def motion_cost(vx: float, wz: float, scales: Scales) -> float:
    """Return the twirling critic and the one that prefers driving forward."""
    return scales.twirling_scale * abs(wz) + scales.reverse_scale * max(0.0, -vx)


@njit(cache=True)
def lack_of_clearance(window: Window, body: Body, end: tuple[float, float, float]) -> float:
    """Return how much clearance the last pose lacks, m: what drives a robot out that stands too close."""
    return max(0.0, body.padding - clearance(window, body, end[0], end[1], end[2], body.padding))
