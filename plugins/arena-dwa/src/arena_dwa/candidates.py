"""The fan of arcs that a search weighed, for who watches: scored again, by the same critics, at some
velocities of the window.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arena_core import Candidate
from arena_dwa.approach import approach_cost
from arena_dwa.columns import COST, VELOCITY, X, Y
from arena_dwa.map_grid import cost_fields
from arena_dwa.obstacles import REJECTED, obstacle_cost
from arena_dwa.search import cheap_costs
from arena_dwa.settings import BodyOnWindow, FieldArray, FloatArray, MapGrids, Settings
from arena_dwa.trajectory import compose_poses, planar_pose, pose_after_arc
from arena_kernels.costmap_window import CostmapWindow, outline_clearance

SHOWN, POINTS = 40, 12  # arcs that are told, besides the driven one, and points of each after the robot's


class SearchInputs(NamedTuple):
    """What ``cheapest_sample`` was told, but for the state, the period and the settings."""

    window: CostmapWindow
    grids: MapGrids
    speeds: FieldArray
    path: FloatArray
    velocities: FloatArray
    only: NDArray[np.int8]


def arc_candidates(
    state: FloatArray, searched: SearchInputs | None, driven: FloatArray | None, period: float, settings: Settings
) -> list[Candidate]:
    """Return arcs from ``state`` (6,), evenly chosen from those that were weighed, and the one that is
    ``driven`` (4,), its cost last.
    """
    samples, costs = (
        (np.empty((0, 3)), np.empty(0)) if searched is None else _score_samples(state, searched, period, settings)
    )
    others = [k for k in range(len(samples)) if driven is None or not np.array_equal(samples[k], driven[:COST])]
    found = [Candidate(_arc_points(state, samples[k], settings.roll_out.sim_time), float(costs[k])) for k in others]
    if driven is None:
        return found
    return [Candidate(_arc_points(state, driven[:COST], settings.roll_out.sim_time), float(driven[COST]), True), *found]


def _score_samples(
    state: FloatArray, searched: SearchInputs, period: float, settings: Settings
) -> tuple[FloatArray, FloatArray]:
    """Return some samples (K, 3) of the window and what ``cheapest_sample`` makes of
    each (K,), inf where it collides.
    """
    window, grids, speeds, path, velocities, only = searched
    limits, roll_out, body, scales, approach = settings
    start = planar_pose(*state[:VELOCITY].tolist())
    gap = outline_clearance(window, body.outline, start, body.padding)
    aligning = math.hypot(path[-1, X] - state[X], path[-1, Y] - state[Y]) > scales.forward_point_distance
    samples, lows = cheap_costs(
        window, *cost_fields(grids, window, scales, aligning), start, velocities, settings, only
    )
    chosen = np.unique(np.linspace(0, len(samples) - 1, min(SHOWN, len(samples))).round().astype(np.int64))
    samples, costs = samples[chosen], lows[chosen]
    for k, (vx, vy, wz) in enumerate(samples.tolist()):
        near = obstacle_cost(
            BodyOnWindow(window, body),
            limits,
            roll_out,
            period,
            start,
            (vx, vy, wz),
            gap,
            scales.occdist_mean,
            math.inf,
        )
        costs[k] = math.inf if near == REJECTED else costs[k] + scales.occdist_scale * near
        if gap < body.padding:
            end = compose_poses(start, pose_after_arc(vx, vy, wz, roll_out.sim_time))
            costs[k] += scales.escape_scale * max(
                0.0, body.padding - outline_clearance(window, body.outline, end, body.padding)
            )
        if approach.scale > 0.0:
            costs[k] += approach.scale * approach_cost(
                BodyOnWindow(window, body), speeds, approach, start, (vx, vy, wz)
            )
    return samples, costs


def _arc_points(state: FloatArray, velocity: FloatArray, time: float) -> FloatArray:
    """Return positions (POINTS + 1, 2) along the arc of a velocity (3,)."""
    start, (vx, vy, wz) = planar_pose(*state[:VELOCITY].tolist()), velocity.tolist()
    return np.array(
        [compose_poses(start, pose_after_arc(vx, vy, wz, float(t)))[:2] for t in np.linspace(0.0, time, POINTS + 1)]
    )
