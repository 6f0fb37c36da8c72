"""Speed of one DWA control step: the compiled search against the same search in vectorised numpy."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from timing import interleave

from arena_dwa.map_grid import map_grids
from arena_dwa.search import cheapest_sample
from arena_dwa.settings import Approach, Body, BodyOnWindow, Limits, MapGrids, RollOut, Scales, Settings
from arena_dwa.window import axis_samples, dynamic_window
from arena_kernels.costmap_window import CostmapWindow, outline_of
from arena_kernels.distance import distance_field

LIMITS = Limits(-0.5, 1.0, 0.0, 2.0, 0.0, 1.0, 0.0, 100.0, 0.0, 100.0, 0.0)
ROLL_OUT = RollOut(1.7, 0.1, 0.2, 0.2, 20, 1, 40)
BODY = Body(outline_of(None, 0.2, 0.2, 0.05), 0.02, 0.25, 0.2)
SCALES = Scales(32.0, 20.0, 0.02, True, 0.325, 0.0, 30.0, 100.0)
SETTINGS = Settings(LIMITS, ROLL_OUT, BODY, SCALES, Approach(0.0, 1.0, 1.0))
NOTHING_MOVES = np.zeros((120, 120), np.float32)
STEPS = 17  # of 0.1 s
NO_FLAGS = np.zeros(3, np.int8)
CALLS = 20  # a timing


def make_scene() -> tuple[CostmapWindow, np.ndarray, np.ndarray, MapGrids]:
    """Return a 6 m window with boxes beside the way, a path through it, the robot's state and the map grids."""
    lethal = np.zeros((120, 120), np.bool_)
    generator = np.random.default_rng(1)
    for row, column in generator.integers(0, 112, (12, 2)):
        lethal[row : row + 8, column : column + 8] = True
    lethal[52:68, 40:120] = False
    distance = distance_field(lethal, 0.05)
    costs = np.where(
        distance <= 0.2, 253.0, np.where(distance > 1.0, 0.0, 252.0 * np.exp(-3.0 * (distance - 0.2)))
    ).astype(np.uint8)
    path = np.column_stack((np.linspace(0.0, 5.0, 51), np.zeros(51), np.zeros(51)))
    window, state = CostmapWindow(costs, distance, 0.05, -3.0, -3.0), np.array((0.0, 0.0, 0.2, 0.5, 0.0, 0.0))
    return window, path, state, map_grids(BodyOnWindow(window, BODY), path, (0.0, 0.0), SCALES.forward_point_distance)


def compiled_step(window: CostmapWindow, path: np.ndarray, state: np.ndarray, grids: MapGrids) -> np.ndarray:
    """Choose a velocity as the planner does, map grids included."""
    return compiled_search(
        window,
        path,
        state,
        map_grids(BodyOnWindow(window, BODY), path, (state[0], state[1]), SCALES.forward_point_distance),
    )


def compiled_search(window: CostmapWindow, path: np.ndarray, state: np.ndarray, grids: MapGrids) -> np.ndarray:
    """Choose a velocity with the planner's own search."""
    velocities = dynamic_window(state[3:], LIMITS, 0.1)
    return cheapest_sample(window, grids, NOTHING_MOVES, path, state, velocities, 0.1, SETTINGS, NO_FLAGS)


def vectorised_step(window: CostmapWindow, path: np.ndarray, state: np.ndarray, grids: MapGrids) -> np.ndarray:
    """Choose a velocity in numpy, map grids included."""
    seeds = grids.path == 0, grids.goal == 0
    blocked = np.pad(window.distance < BODY.outline.inscribed_radius, 1, constant_values=True)
    waves = [_dilate_front(blocked, seed.reshape(blocked.shape)) for seed in seeds]
    return vectorised_search(window, path, state, MapGrids(waves[0].ravel(), waves[1].ravel(), waves[1].ravel()))


def _dilate_front(blocked: np.ndarray, front: np.ndarray) -> np.ndarray:
    """Return the octagonal wave from ``front``, ring by ring."""
    steps, ring, free = np.where(front, 0, -1), 0, ~blocked & ~front
    while front.any():
        grown = front.copy()
        if ring % 2:
            grown[:, 1:] |= front[:, :-1]
            grown[:, :-1] |= front[:, 1:]
            sideways = grown.copy()
            grown[1:] |= sideways[:-1]
            grown[:-1] |= sideways[1:]
        else:
            grown[:, 1:] |= front[:, :-1]
            grown[:, :-1] |= front[:, 1:]
            grown[1:] |= front[:-1]
            grown[:-1] |= front[1:]
        ring += 1
        front = grown & free
        free &= ~front
        steps[front] = ring
    return np.where(steps < 0, ring, steps).astype(np.int32)


def vectorised_search(window: CostmapWindow, path: np.ndarray, state: np.ndarray, grids: MapGrids) -> np.ndarray:
    """Choose a velocity with the same critics in numpy, all samples at once."""
    speeds = axis_samples(LIMITS.vx_min, LIMITS.vx_max, ROLL_OUT.vx_samples)
    turns = axis_samples(-LIMITS.wz_max, LIMITS.wz_max, ROLL_OUT.vth_samples)
    vx, wz = (axis.ravel() for axis in np.meshgrid(speeds, turns, indexing="ij"))
    times = np.arange(1, STEPS + 1) * ROLL_OUT.sim_time / STEPS
    x, y, theta = _rollout_poses(state, vx[:, None], wz[:, None], times)
    rows, columns = _pose_cells(window, x, y)
    faster = np.clip((np.abs(vx) - BODY.scaling_speed) / (1.0 - BODY.scaling_speed), 0.0, None)
    growth = BODY.max_scaling_factor * BODY.outline.radius * faster
    gaps = window.distance[rows, columns] - 0.025 - BODY.outline.radius
    free = (gaps >= (growth + BODY.padding)[:, None]).all(axis=1)
    cost = SCALES.occdist_scale * window.costs[rows, columns].mean(axis=1) + SCALES.reverse_scale * np.maximum(0.0, -vx)
    front_x = x[:, -1] + SCALES.forward_point_distance * np.cos(theta[:, -1])
    front_y = y[:, -1] + SCALES.forward_point_distance * np.sin(theta[:, -1])
    to_path = _lookup_steps(window, grids.path, x[:, -1], y[:, -1]) + _lookup_steps(
        window, grids.path, front_x, front_y
    )
    to_goal = _lookup_steps(window, grids.goal, x[:, -1], y[:, -1]) + _lookup_steps(
        window, grids.goal_front, front_x, front_y
    )
    cost += 0.5 * (SCALES.path_distance_bias * to_path + SCALES.goal_distance_bias * to_goal)
    best = int(np.argmin(np.where(free, cost, np.inf)))
    return np.array((vx[best], 0.0, wz[best], cost[best]))


def _rollout_poses(
    state: np.ndarray, vx: np.ndarray, wz: np.ndarray, times: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    theta = state[2] + wz * times
    turning = np.where(np.abs(wz) < 1e-9, 1.0, wz)
    straight = np.abs(wz) < 1e-9
    x = state[0] + np.where(
        straight, vx * times * math.cos(state[2]), vx / turning * (np.sin(theta) - math.sin(state[2]))
    )
    y = state[1] + np.where(
        straight, vx * times * math.sin(state[2]), vx / turning * (math.cos(state[2]) - np.cos(theta))
    )
    return x, y, theta


def _pose_cells(window: CostmapWindow, x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    rows = ((y - window.origin_y) / window.resolution).astype(np.int64)
    return rows, ((x - window.origin_x) / window.resolution).astype(np.int64)


def _lookup_steps(window: CostmapWindow, steps: np.ndarray, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    grid = steps.reshape(window.distance.shape[0] + 2, -1)[1:-1, 1:-1] * window.resolution
    u, v = (x - window.origin_x) / window.resolution - 0.5, (y - window.origin_y) / window.resolution - 0.5
    column, row = u.astype(np.int64), v.astype(np.int64)
    u, v = u - column, v - row
    below = grid[row, column] * (1.0 - u) + grid[row, column + 1] * u
    above = grid[row + 1, column] * (1.0 - u) + grid[row + 1, column + 1] * u
    return below * (1.0 - v) + above * v


def measure() -> list[dict[str, Any]]:
    """Return the median user CPU time of a control step and of its search alone, each with its peer."""
    arguments = make_scene()
    functions = {
        "step": compiled_step,
        "numpy step": vectorised_step,
        "search": compiled_search,
        "numpy search": vectorised_search,
    }
    choices = [function(*arguments)[:3] for function in functions.values()]
    np.testing.assert_allclose(choices, np.tile(choices[0], (4, 1)), atol=1e-9)
    times = interleave(
        {name: partial(_repeat_calls, function, arguments) for name, function in functions.items()}, repeats=11
    )
    ms = {name: float(np.median(seconds)) / CALLS * 1e3 for name, seconds in times.items()}
    whole, alone = "DWA control step, 21 x 41 samples, 120 x 120 cells", "DWA search alone, map grids given"
    return [
        _make_row(whole, ms["step"], "vectorised numpy", ms["numpy step"]),
        _make_row(alone, ms["search"], "vectorised numpy", ms["numpy search"]),
        {
            "what": whole + ", at most",
            "ours_ms": ms["step"],
            "peer": None,
            "peer_ms": None,
            "ratio": None,
            "goal": 0.5,
            "unit": "ms",
        },
    ]


def _make_row(what: str, ours: float, peer: str, theirs: float) -> dict[str, Any]:
    return {
        "what": what,
        "ours_ms": ours,
        "peer": peer,
        "peer_ms": theirs,
        "ratio": ours / theirs,
        "goal": 1.0 / 7.0,
        "unit": "x peer",
    }


def _repeat_calls(choose: Callable[..., np.ndarray], arguments: tuple[Any, ...]) -> None:
    for _ in range(CALLS):
        choose(*arguments)


if __name__ == "__main__":
    for row in measure():
        peer = f"{row['peer']} {row['peer_ms']:.3f} ms, ratio {row['ratio']:.3f}" if row["peer"] else ""
        print(f"{row['what']:62} {row['ours_ms']:.3f} ms  {peer:45} goal {row['goal']:.3f} {row['unit']}")
