"""Time a whole-map A* query against pyastar2d on the same costs, and what the robot's brain
does with paths and scans at each step.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from statistics import median
from typing import Any

import numpy as np
from numpy.typing import NDArray
from timing import interleave

from arena_core import INSCRIBED, LaserScan, OccupancyGrid, PathBatch, Pose
from arena_core.testing import component, robot
from arena_kernels.grids import stack_grids
from arena_kernels.raycast import make_beams, scan_grids
from arena_navigation.planning.inflation import InflatedCosts, Inflation

QUERIES, UPDATES, REPEATS = 10, 100, 9
START, GOALS = (10, 10), ((389, 389), (389, 388))  # two goals in turn: no query can use the search of the one before
BODY = robot()


def make_rooms() -> OccupancyGrid:
    """Return 20 x 20 m of 400 x 400 cells: 2 x 2 rooms joined by doors of 1.5 m, and twelve boxes of 0.6 m."""
    data = np.zeros((400, 400), np.int8)
    data[:2] = data[-2:] = data[:, :2] = data[:, -2:] = 100
    data[199:202] = data[:, 199:202] = 100
    for door in (85, 285):
        data[199:202, door : door + 30] = data[door : door + 30, 199:202] = 0
    random = np.random.default_rng(0)
    for _ in range(12):
        row, column = random.integers(20, 370, 2)
        data[row : row + 12, column : column + 12] = 100
    return OccupancyGrid(data, 0.05, Pose(0.0, 0.0))


def pose_of(grid: OccupancyGrid, cell: tuple[int, int]) -> Pose:
    """Return the pose at a cell's centre."""
    x, y = grid.positions(cell)
    return Pose(float(x), float(y))


def our_queries(grid: OccupancyGrid) -> Callable[[], None]:
    """Return QUERIES whole queries: search, straight lines, smoothing, poses."""
    planner = component("global_planner", "astar", robot=BODY)
    start, goals = pose_of(grid, START), [pose_of(grid, cell) for cell in GOALS]

    def run() -> None:
        for k in range(QUERIES):
            planner.plan(grid, start, goals[k % 2])

    return run


def repeated_queries(grid: OccupancyGrid) -> Callable[[], None]:
    """Return QUERIES queries to one goal from places along the path."""
    planner = component("global_planner", "astar", robot=BODY)
    goal = pose_of(grid, GOALS[0])
    poses = planner.plan(grid, pose_of(grid, START), goal).poses
    places = [Pose.of(poses[k]) for k in np.linspace(0, len(poses) - 2, QUERIES).astype(int)]

    def run() -> None:
        for place in places:
            planner.plan(grid, place, goal)

    return run


def pyastar2d_queries(grid: OccupancyGrid) -> Callable[[], None] | None:
    """Return the same searches by pyastar2d, cells only; None where it is not installed."""
    try:
        import pyastar2d
    except ImportError:
        return None
    costs = grid.derive(InflatedCosts(Inflation(BODY.footprint.inscribed_radius, 1.0, 3.0), False))
    weights: NDArray[np.float32] = np.where(costs < INSCRIBED, 1.0 + 0.8 * costs / 50.0, np.inf).astype(np.float32)

    def run() -> None:
        for k in range(QUERIES):
            pyastar2d.astar_path(weights, START, GOALS[k % 2], allow_diagonal=True)

    return run


def window_updates(grid: OccupancyGrid, size: float) -> Callable[[], None]:
    """Return UPDATES of the rolling map on a drive of 5 m past walls and boxes, 360 beams with 1 cm of noise."""
    local_map = component("local_map", "rolling", [f"local_map.size={size}"], robot=BODY)
    local_map.reset(grid)
    poses = np.column_stack((np.linspace(3.0, 8.0, UPDATES), np.full(UPDATES, 5.0), np.full(UPDATES, 0.1)))
    ranges = np.empty((UPDATES, 360), np.float32)
    scan_grids(
        stack_grids([grid])[0],
        np.zeros(UPDATES, np.int64),
        poses,
        make_beams(-math.pi, math.pi / 180.0, 360, 10.0),
        ranges,
    )
    ranges += np.random.default_rng(1).normal(0.0, 0.01, ranges.shape).astype(np.float32)
    scans = [
        LaserScan(0.1 * k, -math.pi, math.pi / 180.0, 0.1, 10.0, row, Pose(0.0, 0.0)) for k, row in enumerate(ranges)
    ]

    def run() -> None:
        for scan, pose in zip(scans, poses, strict=True):
            local_map.update(scan, Pose.of(pose))

    return run


def waypoint_updates(grid: OccupancyGrid) -> Callable[[], None]:
    """Return UPDATES waypoints of one robot along the whole path."""
    path = component("global_planner", "astar", robot=BODY).plan(grid, pose_of(grid, START), pose_of(grid, GOALS[0]))
    generator = component("waypoints", "spatial_horizon")
    generator.reset(np.zeros(1, np.int64), 1)
    paths, poses = PathBatch.of([path]), path.poses[np.linspace(0, len(path.poses) - 1, UPDATES).astype(int)]

    def run() -> None:
        for k in range(UPDATES):
            generator.next(paths, poses[k : k + 1], np.array((0.1 * k,)))

    return run


def measure() -> list[dict[str, Any]]:
    """Return the median times; A* as a ratio to pyastar2d where that is installed."""
    grid = make_rooms()
    peer = pyastar2d_queries(grid)
    functions = {"ours": our_queries(grid)} | ({"pyastar2d": peer} if peer else {})
    times = {name: 1e3 * median(seconds) / QUERIES for name, seconds in interleave(functions, REPEATS).items()}
    rows = [_make_row("A* query across 400 x 400 cells, smoothed path", times["ours"], times.get("pyastar2d"))]
    alone = {
        "A* query again for the same goal": (repeated_queries(grid), QUERIES),
        "rolling map update, 4 m at 0.05 m, 360 beams": (window_updates(grid, 4.0), UPDATES),
        "rolling map update, 6 m at 0.05 m, 360 beams": (window_updates(grid, 6.0), UPDATES),
        "waypoint of the spatial horizon": (waypoint_updates(grid), UPDATES),
    }
    for what, (function, calls) in alone.items():
        rows.append(_make_row(what, 1e3 * median(interleave({what: function}, REPEATS)[what]) / calls, None))
    return rows


def _make_row(what: str, ours_ms: float, peer_ms: float | None) -> dict[str, Any]:
    ratio = None if peer_ms is None else ours_ms / peer_ms
    peer = None if peer_ms is None else "pyastar2d"
    goal = 1.5 if what.startswith("A* query across") else None
    return {
        "what": what,
        "ours_ms": ours_ms,
        "peer": peer,
        "peer_ms": peer_ms,
        "ratio": ratio,
        "goal": goal,
        "unit": "x peer",
    }


if __name__ == "__main__":
    for row in measure():
        against = (
            ""
            if row["ratio"] is None
            else f", {row['peer']} {row['peer_ms']:.3f} ms, ratio {row['ratio']:.3f} (goal {row['goal']})"
        )
        print(f"{row['what']}: {row['ours_ms']:.4f} ms{against}")
