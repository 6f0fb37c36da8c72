"""The search of the dynamic window: every sample is scored by all critics, the cheapest is driven."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from arena_dwa.approach import approach_cost
from arena_dwa.columns import COST, HIGH, LOW, THETA, TURN_COSINE, TURN_SINE, VX, VY, WZ, X, Y
from arena_dwa.map_grid import cost_fields, interpolate_field
from arena_dwa.obstacles import REJECTED, obstacle_cost
from arena_dwa.oscillation import is_oscillating
from arena_dwa.settings import BodyOnWindow, FieldArray, FloatArray, MapGrids, Settings
from arena_dwa.trajectory import PlanarPose, compose_poses, planar_pose, pose_after_arc, pose_from_turn, turn_rotations
from arena_dwa.window import axis_samples, is_drivable, turn_samples
from arena_kernels.compiled import borrowing, compiled
from arena_kernels.costmap_window import CostmapWindow, outline_clearance


@compiled
def cheapest_sample(
    window: CostmapWindow,
    grids: MapGrids,
    speeds: FieldArray,
    path: FloatArray,
    state: FloatArray,
    velocities: FloatArray,
    period: float,
    settings: Settings,
    only: NDArray[np.int8],
) -> FloatArray:
    """Return (vx, vy, wz, cost) of the cheapest admissible sample of the window ``velocities`` (3, 2); its cost is inf
    if there is none.

    ``state`` is (x, y, theta, vx, vy, wz); ``path`` (M, 3), both in ``map``. The samples that the cheap critics like
    best are followed over obstacles first, and those that are left no chance never, which changes no choice because no
    critic is negative.
    """
    limits, roll_out, body, scales, approach = settings
    start = planar_pose(state[X], state[Y], state[THETA])
    gap = outline_clearance(window, body.outline, start, body.padding)
    aligning = math.hypot(path[-1, X] - state[X], path[-1, Y] - state[Y]) > scales.forward_point_distance
    place, front = cost_fields(grids, window, scales, aligning)
    samples, lows = cheap_costs(window, place, front, start, velocities, settings, only)
    best, cheapest = np.array((0.0, 0.0, 0.0, np.inf)), -1
    heap = build_heap(lows)
    for left in range(len(heap), 0, -1):
        sample = heap[0]
        cost = lows[sample]
        if cost > best[COST]:
            break
        heap[0] = heap[left - 1]
        sift_down(heap, left - 1, 0, lows)
        velocity = samples[sample, VX], samples[sample, VY], samples[sample, WZ]
        within = (best[COST] - cost) / scales.occdist_scale if scales.occdist_scale > 0.0 else np.inf
        near = obstacle_cost(
            BodyOnWindow(window, body), limits, roll_out, period, start, velocity, gap, scales.occdist_mean, within
        )
        if near == REJECTED:
            continue
        cost += scales.occdist_scale * near
        if gap < body.padding:
            end = compose_poses(start, pose_after_arc(velocity[VX], velocity[VY], velocity[WZ], roll_out.sim_time))
            cost += scales.escape_scale * max(
                0.0, body.padding - outline_clearance(window, body.outline, end, body.padding)
            )
        if approach.scale > 0.0 and cost <= best[COST]:
            cost += approach.scale * approach_cost(BodyOnWindow(window, body), speeds, approach, start, velocity)
        if cost < best[COST] or (cost == best[COST] and sample < cheapest):
            best[VX], best[VY], best[WZ], best[COST] = velocity[VX], velocity[VY], velocity[WZ], cost
            cheapest = sample
    return best


@compiled
def cheap_costs(
    window: CostmapWindow,
    place: FieldArray,
    front: FieldArray,
    start: PlanarPose,
    velocities: FloatArray,
    settings: Settings,
    only: NDArray[np.int8],
) -> tuple[FloatArray, FloatArray]:
    """Return the samples of the window (K, 3), and what the critics that need no trajectory say of each (K,)."""
    limits, roll_out, scales = settings.limits, settings.roll_out, settings.scales
    ahead = scales.forward_point_distance, 0.0, 1.0, 0.0
    # of equal ones the fastest is driven
    along = axis_samples(velocities[VX, LOW], velocities[VX, HIGH], roll_out.vx_samples)[::-1]
    aside = axis_samples(velocities[VY, LOW], velocities[VY, HIGH], roll_out.vy_samples)
    turning, turns = axis_samples(velocities[WZ, LOW], velocities[WZ, HIGH], roll_out.vth_samples), np.empty((0, 2))
    if limits.turn_radius == 0.0:  # all turn alike, whatever their speed
        turns = turn_rotations(turning, roll_out.sim_time)
    most = len(along) * len(aside) * (max(roll_out.vth_samples, 1) + 1)
    samples, lows, count = np.empty((most, 3)), np.empty(most), 0
    for vx in along:
        if limits.turn_radius > 0.0:
            turning = turn_samples(vx, velocities, limits, roll_out.vth_samples)
            turns = turn_rotations(turning, roll_out.sim_time)
        for vy in aside:
            for k in range(len(turning)):
                wz = turning[k]
                if not is_drivable(vx, vy, wz, limits) or is_oscillating(only, vx, vy, wz):
                    continue
                end = compose_poses(
                    start, pose_from_turn(vx, vy, wz, roll_out.sim_time, turns[k, TURN_COSINE], turns[k, TURN_SINE])
                )
                front_x, front_y, _, _ = compose_poses(end, ahead)
                cost = interpolate_field(place, window, end[X], end[Y]) + interpolate_field(
                    front, window, front_x, front_y
                )
                cost += scales.twirling_scale * abs(wz) + scales.reverse_scale * max(0.0, -vx)
                samples[count, VX], samples[count, VY], samples[count, WZ], lows[count] = vx, vy, wz, cost
                count += 1
    return samples[:count], lows[:count]


@compiled
def build_heap(values: FloatArray) -> NDArray[np.int64]:
    """Return the rows of ``values`` as a binary heap, the least value first."""
    heap = np.arange(len(values))
    for place in range(len(heap) // 2 - 1, -1, -1):
        sift_down(heap, len(heap), place, values)
    return heap


@borrowing
def sift_down(heap: NDArray[np.int64], count: int, place: int, values: FloatArray) -> None:
    """Let the row at a place of a heap of ``count`` sink below those with lesser values."""
    row = heap[place]
    while 2 * place + 1 < count:
        below = 2 * place + 1
        if below + 1 < count and values[heap[below + 1]] < values[heap[below]]:
            below += 1
        if values[row] <= values[heap[below]]:
            break
        heap[place] = heap[below]
        place = below
    if place < count:
        heap[place] = row
