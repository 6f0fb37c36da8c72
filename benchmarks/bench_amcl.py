"""Time one update of the particle filter, 500 particles and 60 beams, against the same in vectorised numpy."""

from __future__ import annotations

from collections.abc import Callable
from statistics import median
from typing import Any

import numpy as np
from numpy.typing import NDArray
from timing import interleave

from arena_core import OccupancyGrid, Pose
from arena_kernels.distance import grid_distance
from arena_kernels.grids import stack_grids
from arena_kernels.raycast import make_beams, scan_grids
from arena_navigation.amcl.draws import Draw
from arena_navigation.amcl.filter import (
    EndpointModel,
    Recovery,
    Resampling,
    Update,
    draw_particles,
    filter_update,
    make_cloud,
)
from arena_navigation.amcl.laser import KEEP_ALL
from arena_navigation.amcl.localizer import free_space
from arena_navigation.amcl.motion import Alphas, OdometryMotion, odometry_motion
from arena_navigation.amcl.resampling import ParticleLimits
from arena_navigation.amcl.sensor import Distances, LikelihoodField

PARTICLES, BEAMS, CALLS, REPEATS = 500, 60, 200, 9
Floats = NDArray[np.float64]


def make_hall() -> OccupancyGrid:
    """Return a 20 x 20 m hall of 400 x 400 cells with four walls and twelve boxes, none in the middle."""
    data = np.zeros((400, 400), np.int8)
    data[[0, -1]] = data[:, [0, -1]] = 100
    random = np.random.default_rng(7)
    for row, column in random.integers(20, 368, (12, 2)):
        if max(abs(row - 194), abs(column - 194)) < 60:
            continue
        data[row : row + 12, column : column + 12] = 100
    return OccupancyGrid(data, 0.05, Pose(0.0, 0.0))


def round_trip(grid: OccupancyGrid) -> tuple[Floats, OdometryMotion, list[NDArray[np.float32]]]:
    """Return the start of a drive on a circle of 2 m in the middle of the hall, its step, and the beams'
    ends seen after each step.
    """
    angles = 0.1 * np.arange(CALLS + 1)
    poses = np.stack((10.0 + 2.0 * np.sin(angles), 10.0 - 2.0 * np.cos(angles), angles), axis=1)
    rays = make_beams(-np.pi, 2.0 * np.pi / BEAMS, BEAMS, 30.0)
    ranges = np.empty((CALLS + 1, BEAMS), np.float32)
    stack, _ = stack_grids([grid])
    scan_grids(stack, np.zeros(CALLS + 1, np.int64), poses, rays, ranges)
    ranges += 0.01 * np.random.default_rng(3).standard_normal(ranges.shape)
    ends = (ranges[:, None] * np.stack((rays.cosines, rays.sines))).astype(np.float32)
    step = Pose.of(poses[0]).relative(Pose.of(poses[1]))
    return poses[0], odometry_motion(step, "diff-corrected", Alphas(0.05, 0.05, 0.05, 0.05, 0.05)), list(ends[1:])


def our_filter(
    grid: OccupancyGrid, start: Floats, step: OdometryMotion, scans: list[NDArray[np.float32]]
) -> Callable[[], None]:
    """Return CALLS filter updates as arena-navigation makes them: motion, weights, clusters, KLD bound, resampling."""
    particles = make_cloud(PARTICLES, BEAMS)
    key = np.uint64(5)
    field, free = (
        grid.derive(LikelihoodField(True, 0.8, 0.2, 0.05, 2.0, Distances(True, True), 0.3, 30.0)),
        free_space(grid),
    )
    resampling = Resampling(
        True, False, ParticleLimits(PARTICLES, PARTICLES, 0.05, 0.99, False), free, Recovery(0.0, 0.0)
    )

    def run() -> None:
        draw_particles(particles, start, 0.2 * np.eye(3), key)
        for tick, beams in enumerate(scans, 1):
            filter_update(
                particles, Update(step, resampling, Draw(key, tick)), beams, 1.0, EndpointModel(field, KEEP_ALL)
            )

    return run


def numpy_filter(
    grid: OccupancyGrid, start: Floats, step: OdometryMotion, scans: list[NDArray[np.float32]]
) -> Callable[[], None]:
    """Return CALLS updates in vectorised numpy: motion, weights, mean, systematic resampling;
    neither clusters nor KLD bound.
    """
    distance = np.minimum(grid.derive(grid_distance), 2.0)
    field = ((0.95 * np.exp(-0.5 * (distance / 0.2) ** 2) + 0.05 / 30.0) ** 3).astype(np.float32)
    outside = np.float32((0.05 / 30.0) ** 3)

    def run() -> None:
        random = np.random.default_rng(5)
        x, y, theta = start[:, None] + 0.2 * random.standard_normal((3, PARTICLES))
        for beams in scans:
            turn, travel, again = random.standard_normal((3, PARTICLES))
            theta = theta + step.turn + step.turn_std * turn
            travel = step.travel + step.travel_std * travel
            x, y = x + travel * np.cos(theta), y + travel * np.sin(theta)
            theta = theta + step.turn_again + step.turn_again_std * again
            weights = 1.0 + _field_scores(field, outside, grid.resolution, x, y, theta, beams).sum(axis=1)
            weights /= weights.sum()
            _mean_pose(x, y, theta, weights)
            points = (np.arange(PARTICLES) + random.random()) / PARTICLES
            chosen = np.minimum(np.searchsorted(np.cumsum(weights), points), PARTICLES - 1)
            x, y, theta = x[chosen], y[chosen], theta[chosen]

    return run


def _field_scores(
    field: NDArray[np.float32],
    outside: np.float32,
    resolution: float,
    x: Floats,
    y: Floats,
    theta: Floats,
    beams: NDArray[np.float32],
) -> NDArray[np.float32]:
    """Return the field's value at each beam's end, (particles, beams)."""
    c, s = np.cos(theta)[:, None], np.sin(theta)[:, None]
    column = ((x[:, None] + c * beams[0] - s * beams[1]) / resolution).astype(np.int32)
    row = ((y[:, None] + s * beams[0] + c * beams[1]) / resolution).astype(np.int32)
    inside = (row >= 0) & (row < field.shape[0]) & (column >= 0) & (column < field.shape[1])
    values: NDArray[np.float32] = np.where(
        inside, field[np.where(inside, row, 0), np.where(inside, column, 0)], outside
    )
    return values


def _mean_pose(x: Floats, y: Floats, theta: Floats, weights: Floats) -> tuple[float, float, float]:
    heading = np.arctan2(weights @ np.sin(theta), weights @ np.cos(theta))
    return float(weights @ x), float(weights @ y), float(heading)


def measure() -> list[dict[str, Any]]:
    """Return our time, numpy's and their ratio; the median of the repeats."""
    grid = make_hall()
    drive = grid, *round_trip(grid)
    times = interleave({"ours": our_filter(*drive), "numpy": numpy_filter(*drive)}, REPEATS)
    ours_ms, peer_ms = (1e3 * median(times[name]) / CALLS for name in ("ours", "numpy"))
    return [
        {
            "what": f"particle filter update, {PARTICLES} particles x {BEAMS} beams",
            "ours_ms": ours_ms,
            "peer": "vectorised numpy",
            "peer_ms": peer_ms,
            "ratio": ours_ms / peer_ms,
            "goal": 0.25,
            "unit": "x peer",
        }
    ]


if __name__ == "__main__":
    for row in measure():
        print(f"{row['what']}: {row['ours_ms']:.3f} ms, {row['peer']} {row['peer_ms']:.3f} ms")
        print(f"ratio {row['ratio']:.3f} (goal {row['goal']})")
