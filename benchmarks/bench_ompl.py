"""Time of one query by each of OMPL's planners and the length of its path, beside A* on the same maps;
`report` prints the whole table.
"""

from __future__ import annotations

import sys
from pathlib import Path as File
from statistics import mean, median
from typing import Any, get_args

import numpy as np
from numpy.typing import NDArray
from timing import user_seconds

from arena_core import GlobalPlanner, NoPath, OccupancyGrid, Pose
from arena_core.testing import component, robot
from arena_kernels.distance import grid_distance
from arena_ompl.algorithms import Algorithm

BODY = robot()
MAPS = File(__file__).parents[2] / "shared" / "data" / "maps"
RECORDED = (
    "nav2/depot.yaml",
    "turtlebot3/map.yaml",
    "arena_bench/small_warehouse/map.yaml",
    "arena_bench/map5/map.yaml",
)
GRIDS, QUERIES = 8, 2  # random grids, and queries on each map
Query = tuple[OccupancyGrid, Pose, Pose]


def cluttered_grid(seed: int) -> OccupancyGrid:
    """Return 20 x 20 m of 400 x 400 cells with thirty boxes of 1.25 m."""
    data = np.zeros((400, 400), np.int8)
    data[[0, -1]] = data[:, [0, -1]] = 100
    for row, column in np.random.default_rng(seed).integers(0, 375, (30, 2)):
        data[row : row + 25, column : column + 25] = 100
    return OccupancyGrid(data, 0.05, Pose(-10.0, -10.0))


def recorded_maps() -> list[OccupancyGrid]:
    """Return the recorded maps that are there."""
    found = [MAPS / name for name in RECORDED if (MAPS / name).is_file()]
    return [component("world", "ros_map", [f"world.path={path}"]).world(0, 0).grid for path in found]


def make_queries(grids: list[OccupancyGrid], reference: GlobalPlanner) -> list[tuple[Query, float]]:
    """Return queries of 6 m or more that A* can answer, and how long its paths are."""
    chosen = []
    for number, grid in enumerate(grids):
        free = np.argwhere((grid.derive(grid_distance) > 0.4) & (grid.data == 0))
        random = np.random.default_rng(number)
        wanted = [_random_pair(grid, free, random) for _ in range(50)]
        for start, goal in [pair for pair in wanted if pair[0].distance(pair[1]) > 6.0][:QUERIES]:
            try:
                chosen.append(((grid, start, goal), reference.plan(grid, start, goal).length))
            except NoPath:
                continue
    return chosen


def _random_pair(grid: OccupancyGrid, free: NDArray[np.int64], random: np.random.Generator) -> tuple[Pose, Pose]:
    a, b = (Pose(*grid.positions(free[random.integers(len(free))]).tolist()) for _ in range(2))
    return a, b


def query_row(algorithm: str, chosen: list[tuple[Query, float]], where: str) -> dict[str, Any]:
    """Return the median time of a query and the mean ratio of its length to that of A*."""
    planner = component("global_planner", "ompl", [f"global_planner.algorithm={algorithm}"], robot=BODY)
    planner.plan(*chosen[0][0])
    seconds, lengths = [], []
    for query, length in chosen:
        began = user_seconds()
        try:
            path = planner.plan(*query)
        except NoPath:
            continue
        finally:
            seconds.append(user_seconds() - began)
        lengths.append(path.length / length)
    what = f"OMPL {algorithm}, {where}, length {mean(lengths):.3f} x A*, {len(lengths)} of {len(chosen)} found"
    return {
        "what": what,
        "ours_ms": 1e3 * median(seconds),
        "peer": None,
        "peer_ms": None,
        "ratio": None,
        "goal": None,
        "unit": "ms",
    }


def measure(algorithms: tuple[str, ...] = ("rrtstar", "rrtconnect")) -> list[dict[str, Any]]:
    """Return a row for each algorithm and kind of map."""
    reference = component("global_planner", "astar", robot=BODY)
    kinds = {"400 x 400 cells": [cluttered_grid(seed) for seed in range(GRIDS)], "recorded maps": recorded_maps()}
    chosen = {where: make_queries(grids, reference) for where, grids in kinds.items()}
    return [query_row(algorithm, pairs, where) for algorithm in algorithms for where, pairs in chosen.items() if pairs]


if __name__ == "__main__":
    for result in measure(get_args(Algorithm) if "report" in sys.argv else ("rrtstar", "rrtconnect")):
        print(f"{result['what']}: {result['ours_ms']:.1f} ms", flush=True)
