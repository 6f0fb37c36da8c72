"""Speed of one DWA control step: the compiled search against the same search in vectorised numpy."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from arena_dwa.map_grid import map_grids
from arena_dwa.parameters import Body, Limits, RollOut, Scales, Window
from arena_dwa.search import best_velocity
from arena_dwa.window import axis_samples
from arena_kernels.distance import distance_field
from timing import interleave

LIMITS = Limits(-0.5, 1.0, 0.0, 2.0, 0.0, 1.0, 0.0, 100.0, 0.0, 100.0, 0.0)
ROLL_OUT = RollOut(1.7, 0.1, 0.2, 0.2, 20, 1, 40)
BODY = Body(0.2, 0.2, np.empty((0, 2)), 0.02, 0.25, 0.2)
SCALES = Scales(32.0, 20.0, 0.02, True, 0.325, 0.0, 30.0, 100.0)
STEPS = 17  # of 0.1 s
NO_FLAGS = np.zeros(3, np.int8)


def scene() -> tuple[Window, np.ndarray, np.ndarray]:
    """Return a 6 m window with boxes beside the way, a path through it, and the robot's state."""
    lethal = np.zeros((120, 120), np.bool_)
    generator = np.random.default_rng(1)
    for row, column in generator.integers(0, 112, (12, 2)):
        lethal[row : row + 8, column : column + 8] = True
    lethal[52:68, 40:120] = False
    distance = distance_field(lethal, 0.05)
    costs = np.where(distance <= 0.2, 253.0, np.where(distance > 1.0, 0.0, 252.0 * np.exp(-3.0 * (distance - 0.2)))).astype(np.uint8)
    path = np.column_stack((np.linspace(0.0, 5.0, 51), np.zeros(51), np.zeros(51)))
    return Window(costs, distance, 0.05, -3.0, -3.0), path, np.array((0.0, 0.0, 0.2, 0.5, 0.0, 0.0))


def compiled(window: Window, path: np.ndarray, state: np.ndarray) -> np.ndarray:
    """Choose a velocity with the planner's own search."""
    return best_velocity(window, path, state, 0.1, LIMITS, ROLL_OUT, BODY, SCALES, NO_FLAGS)


def vectorised(window: Window, path: np.ndarray, state: np.ndarray) -> np.ndarray:
    """Choose a velocity with the same critics, all samples at once, in numpy; the map grids are the compiled ones."""
    grids = map_grids(window, BODY, path, state[0], state[1], SCALES.forward_point_distance)
    speeds = axis_samples(LIMITS.vx_min, LIMITS.vx_max, ROLL_OUT.vx_samples)
    turns = axis_samples(-LIMITS.wz_max, LIMITS.wz_max, ROLL_OUT.vth_samples)
    vx, wz = (axis.ravel() for axis in np.meshgrid(speeds, turns, indexing="ij"))
    times = np.arange(1, STEPS + 1) * ROLL_OUT.sim_time / STEPS
    x, y, theta = _poses(state, vx[:, None], wz[:, None], times)
    rows, columns = _cells(window, x, y)
    growth = BODY.max_scaling_factor * BODY.radius * np.clip((np.abs(vx) - BODY.scaling_speed) / (1.0 - BODY.scaling_speed), 0.0, None)
    gaps = window.distance[rows, columns] - 0.025 - BODY.radius
    free = (gaps >= (growth + BODY.padding)[:, None]).all(axis=1)
    cost = SCALES.occdist_scale * window.costs[rows, columns].mean(axis=1) + SCALES.reverse_scale * np.maximum(0.0, -vx)
    front_x = x[:, -1] + SCALES.forward_point_distance * np.cos(theta[:, -1])
    front_y = y[:, -1] + SCALES.forward_point_distance * np.sin(theta[:, -1])
    to_path = _lookup(window, grids.path, x[:, -1], y[:, -1]) + _lookup(window, grids.path, front_x, front_y)
    to_goal = _lookup(window, grids.goal, x[:, -1], y[:, -1]) + _lookup(window, grids.goal_front, front_x, front_y)
    cost += 0.5 * (SCALES.path_distance_bias * to_path + SCALES.goal_distance_bias * to_goal)
    best = int(np.argmin(np.where(free, cost, np.inf)))
    return np.array((vx[best], 0.0, wz[best], cost[best]))


def _poses(state: np.ndarray, vx: np.ndarray, wz: np.ndarray, times: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    theta = state[2] + wz * times
    turning = np.where(np.abs(wz) < 1e-9, 1.0, wz)
    straight = np.abs(wz) < 1e-9
    x = state[0] + np.where(straight, vx * times * math.cos(state[2]), vx / turning * (np.sin(theta) - math.sin(state[2])))
    y = state[1] + np.where(straight, vx * times * math.sin(state[2]), vx / turning * (math.cos(state[2]) - np.cos(theta)))
    return x, y, theta


def _cells(window: Window, x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    rows = ((y - window.origin_y) / window.resolution).astype(np.int64)
    return rows, ((x - window.origin_x) / window.resolution).astype(np.int64)


def _lookup(window: Window, steps: np.ndarray, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    grid = steps.reshape(window.distance.shape[0] + 2, -1)[1:-1, 1:-1] * window.resolution
    u, v = (x - window.origin_x) / window.resolution - 0.5, (y - window.origin_y) / window.resolution - 0.5
    column, row = u.astype(np.int64), v.astype(np.int64)
    u, v = u - column, v - row
    below = grid[row, column] * (1.0 - u) + grid[row, column + 1] * u
    above = grid[row + 1, column] * (1.0 - u) + grid[row + 1, column + 1] * u
    return below * (1.0 - v) + above * v


def measure() -> list[dict[str, Any]]:
    """Return the median user CPU time of a control step, of the peer, and their ratio."""
    arguments = scene()
    np.testing.assert_allclose(compiled(*arguments)[:3], vectorised(*arguments)[:3], atol=1e-9)
    times = interleave({"ours": lambda: _repeat(compiled, arguments), "numpy": lambda: _repeat(vectorised, arguments)}, repeats=15)
    ours, peer = (float(np.median(times[name])) / REPEATS * 1e3 for name in ("ours", "numpy"))
    return [
        {
            "what": "DWA control step, 21 x 41 samples, 120 x 120 cells",
            "ours_ms": ours,
            "peer": "vectorised numpy",
            "peer_ms": peer,
            "ratio": ours / peer,
            "goal": 1.0 / 7.0,
            "unit": "x peer",
        },
        {"what": "the same, absolute", "ours_ms": ours, "peer": None, "peer_ms": None, "ratio": None, "goal": 0.5, "unit": "ms"},
    ]


REPEATS = 20


def _repeat(choose: Any, arguments: Any) -> None:
    for _ in range(REPEATS):
        choose(*arguments)


if __name__ == "__main__":
    for row in measure():
        ratio = f"{row['ratio']:.3f} (goal {row['goal']:.3f})" if row["peer"] else f"goal {row['goal']} ms"
        print(f"{row['what']:55} {row['ours_ms']:.3f} ms   {row['peer'] or '':18} {row['peer_ms'] or 0.0:.3f} ms   {ratio}")
