"""Time a scan of 360 beams on 400 x 400 cells against plain DDA, whose answer it must give within 1 mm."""

from __future__ import annotations

from collections.abc import Callable
from statistics import median
from typing import Any

import numpy as np
from numpy.typing import NDArray
from timing import interleave

from arena_core import OccupancyGrid, Pose
from arena_kernels.compiled import compiled
from arena_kernels.distance import grid_distance
from arena_kernels.grids import GridStack, stack_grids
from arena_kernels.raycast import Beams, cast_disc, make_beams, plain_dda, scan_grids

POSES, BEAMS, RANGE, REPEATS, GOAL = 2000, 360, 10.0, 7, 1 / 8
Floats = NDArray[np.float64]
Ranges = NDArray[np.float32]


def rooms() -> OccupancyGrid:
    """Return four rooms with 1.5 m doors and twelve boxes of 0.6 m, 20 x 20 m in cells of 0.05 m."""
    data = np.zeros((400, 400), np.int8)
    data[:2] = data[-2:] = data[:, :2] = data[:, -2:] = 100
    data[199:202] = data[:, 199:202] = 100
    for door in (85, 285):
        data[199:202, door : door + 30] = data[door : door + 30, 199:202] = 0
    random = np.random.default_rng(0)
    for row, column in random.integers(20, 370, (12, 2)):
        data[row : row + 12, column : column + 12] = 100
    return OccupancyGrid(data, 0.05, Pose(0.0, 0.0))


def free_poses(grid: OccupancyGrid, count: int, clearance: float, seed: int) -> Floats:
    """Return poses (count, 3) whose cells are at least ``clearance`` m from walls."""
    random = np.random.default_rng(seed)
    drawn = np.column_stack((random.uniform(0.3, 19.7, (20 * count, 2)), random.uniform(-np.pi, np.pi, 20 * count)))
    rows, columns = grid.cells(drawn[:, :2]).T
    free = drawn[grid.derive(grid_distance)[rows, columns] > clearance]
    return free[:count]


@compiled
def scan_dda(stack: GridStack, poses: Floats, beams: Beams, ranges: Ranges) -> None:
    """Scan from every pose by plain DDA."""
    for k in range(len(poses)):
        plain_dda(stack, 0, (poses[k, 0], poses[k, 1], poses[k, 2]), beams, ranges[k])


@compiled
def add_discs(poses: Floats, discs: Floats, beams: Beams, ranges: Ranges) -> None:
    """Add ten discs to every scan."""
    for k in range(len(poses)):
        for i in range(len(discs)):
            cast_disc((poses[k, 0], poses[k, 1], poses[k, 2]), beams, (discs[i, 0], discs[i, 1], 0.3), ranges[k])


def measure() -> list[dict[str, Any]]:
    """Return the scan of the walls against plain DDA, and what ten people on top of it cost."""
    grid = rooms()
    stack, _ = stack_grids([grid])
    poses, discs = free_poses(grid, POSES, 0.4, 1), free_poses(grid, 10, 0.4, 5)[:, :2].copy()
    beams, worlds = make_beams(0.0, 2.0 * np.pi / BEAMS, BEAMS, RANGE), np.zeros(POSES, np.int64)
    ours, plain, crowded = (np.empty((POSES, BEAMS), np.float32) for _ in range(3))
    runs: dict[str, Callable[[], None]] = {
        "ours": lambda: scan_grids(stack, worlds, poses, beams, ours),
        "plain": lambda: scan_dda(stack, poses, beams, plain),
        "discs": lambda: add_discs(poses, discs, beams, crowded),
    }
    times = {name: 1e3 * median(values) / POSES for name, values in interleave(runs, REPEATS).items()}
    off = int((np.abs(np.nan_to_num(ours, posinf=99.0) - np.nan_to_num(plain, posinf=99.0)) > 1e-3).sum())
    what = f"lidar scan, {BEAMS} beams, 400 x 400 cells ({off} of {ours.size} beams off by more than 1 mm)"
    return [
        _make_row(what, times["ours"], "plain DDA", times["plain"], GOAL),
        _make_row("ten people on top of a scan", times["discs"]),
    ]


def _make_row(
    what: str, ours_ms: float, peer: str | None = None, peer_ms: float | None = None, goal: float | None = None
) -> dict[str, Any]:
    ratio = None if peer_ms is None else ours_ms / peer_ms
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
        print(f"{row['what']}: {1e3 * row['ours_ms']:.2f} us", end="")
        print("" if row["peer"] is None else f", {row['peer']} {1e3 * row['peer_ms']:.2f} us, 1/{1 / row['ratio']:.1f}")
