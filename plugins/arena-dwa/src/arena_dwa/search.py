"""The search of the dynamic window: every sample is scored by all critics, the cheapest is driven."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from arena_dwa.approach import approach_cost
from arena_dwa.map_grid import cost_fields, interpolated
from arena_dwa.obstacles import REJECTED, obstacle_cost
from arena_dwa.oscillation import oscillates
from arena_dwa.settings import FieldArray, FloatArray, MapGrids, Settings
from arena_dwa.trajectory import arc, moved, stand_at
from arena_dwa.window import axis_samples, driven, turn_samples
from arena_kernels.compiled import compiled
from arena_kernels.window import Window, clearance


@compiled
def cheapest_sample(
    window: Window,
    grids: MapGrids,
    speeds: FieldArray,
    path: FloatArray,
    state: FloatArray,
    velocities: FloatArray,
    period: float,
    settings: Settings,
    only: NDArray[np.int8],
) -> FloatArray:
    """Return (vx, vy, wz, cost) of the cheapest admissible sample of the window ``velocities`` (3, 2); its cost is inf if there is none.

    ``state`` is (x, y, theta, vx, vy, wz); ``path`` (M, 3), both in ``map``. A sample is followed over obstacles only if the cheap
    critics leave it a chance, which changes no choice because no critic is negative.
    """
    limits, roll_out, body, scales, approach = settings
    start = stand_at(state[0], state[1], state[2])
    gap = clearance(window, body.outline, *start, body.padding)
    aligning = math.hypot(path[-1, 0] - state[0], path[-1, 1] - state[1]) > scales.forward_point_distance
    place, front = cost_fields(grids, window, scales, aligning)
    ahead = scales.forward_point_distance, 0.0, 1.0, 0.0
    best = np.array((0.0, 0.0, 0.0, np.inf))
    for vx in axis_samples(velocities[0, 0], velocities[0, 1], roll_out.vx_samples)[::-1]:  # fast ones first: few others get past them
        for vy in axis_samples(velocities[1, 0], velocities[1, 1], roll_out.vy_samples):
            for wz in turn_samples(vx, velocities, limits, roll_out.vth_samples):
                if not driven(vx, vy, wz, limits) or oscillates(only, vx, vy, wz):
                    continue
                end = moved(start, arc(vx, vy, wz, roll_out.sim_time))
                front_x, front_y, _, _ = moved(end, ahead)
                cost = interpolated(place, window, end[0], end[1]) + interpolated(front, window, front_x, front_y)
                cost += scales.twirling_scale * abs(wz) + scales.reverse_scale * max(0.0, -vx)
                if cost >= best[3]:
                    continue
                near = obstacle_cost(window, body, limits, roll_out, period, start, (vx, vy, wz), gap, scales.occdist_mean)
                if near == REJECTED:
                    continue
                cost += scales.occdist_scale * near
                if gap < body.padding:
                    cost += scales.escape_scale * max(0.0, body.padding - clearance(window, body.outline, *end, body.padding))
                if approach.scale > 0.0 and cost < best[3]:
                    cost += approach.scale * approach_cost(window, body, speeds, approach, start, (vx, vy, wz))
                if cost < best[3]:
                    best[0], best[1], best[2], best[3] = vx, vy, wz, cost
    return best
