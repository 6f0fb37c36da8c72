"""Speed of one step of the moving-obstacle tracker with ten tracks, and of its filters against filterpy's."""

from __future__ import annotations

import math
from functools import partial
from typing import Any

import numpy as np
from filterpy.common import Q_continuous_white_noise
from filterpy.kalman import KalmanFilter
from timing import interleave

from arena_core import LaserScan, OccupancyGrid, Pose, Tracker
from arena_core.testing import component
from arena_kernels.distance import grid_distance
from arena_navigation.tracking.filter import POSITION, correct_tracks, predict_tracks

PEOPLE = 10
STEPS = 40  # a timing
PERIOD = 0.1  # s
DENSITY = 0.5  # m^2/s^3
NOISE = 1e-4  # m^2


def make_hall(known: bool) -> OccupancyGrid | None:
    """Return a hall of 16 x 16 m with walls, or no map."""
    data = np.zeros((320, 320), np.int8)
    data[[0, -1], :] = data[:, [0, -1]] = 100
    grid = OccupancyGrid(data, 0.05, Pose(-8.0, -8.0))
    grid.derive(grid_distance)
    return grid if known else None


def make_scans() -> list[LaserScan]:
    """Return what a lidar of 720 beams all round, in the middle of the hall, sees of ten people
    on circles of 3 to 6 m about it.
    """
    increment = 2.0 * math.pi / 720
    angles = -math.pi + increment * np.arange(720)
    walls = 7.95 / np.maximum(np.abs(np.cos(angles)), np.abs(np.sin(angles)))
    random = np.random.default_rng(0)
    found = []
    for k in range(STEPS):
        ranges = walls.copy()
        for person in range(PEOPLE):
            away, bearing = 3.0 + person / 3.0, 0.628 * person + 0.2 * k * PERIOD
            x, y = away * math.cos(bearing), away * math.sin(bearing)
            along, beside = x * np.cos(angles) + y * np.sin(angles), y * np.cos(angles) - x * np.sin(angles)
            near = along - np.sqrt(np.maximum(0.09 - beside**2, 0.0))
            ranges = np.where((np.abs(beside) < 0.3) & (along > 0.0), np.minimum(ranges, near), ranges)
        ranges += 0.01 * random.standard_normal(720)
        found.append(LaserScan(k * PERIOD, -math.pi, increment, 0.1, 30.0, ranges.astype(np.float32), Pose(0.0, 0.0)))
    return found


def track_people(tracker: Tracker, grid: OccupancyGrid | None, seen: list[LaserScan]) -> int:
    """Follow people through all scans and return how many are told of at the end."""
    tracker.reset(grid)
    for scan in seen:
        tracks = tracker.update(scan, Pose(0.0, 0.0), scan.stamp)
    return len(tracks.ids)


def batched_filters(positions: np.ndarray) -> np.ndarray:
    """Filter (STEPS, PEOPLE, 2) positions with the tracker's own kernels."""
    states, covariances = np.zeros((PEOPLE, 4)), np.tile(np.eye(4), (PEOPLE, 1, 1))
    noises, matches = np.tile(NOISE * np.eye(2), (PEOPLE, 1, 1)), np.arange(PEOPLE)
    for measured in positions:
        predict_tracks(states, covariances, PERIOD, DENSITY)
        correct_tracks(states, covariances, matches, measured, noises, POSITION)
    return states


def filterpy_filters(positions: np.ndarray) -> np.ndarray:
    """Filter them with one filterpy object a person."""
    filters = []
    for _ in range(PEOPLE):
        one = KalmanFilter(dim_x=4, dim_z=2)
        one.x, one.P, one.H, one.R = np.zeros(4), np.eye(4), np.eye(2, 4), NOISE * np.eye(2)
        one.F = np.eye(4) + PERIOD * np.eye(4, k=2)
        one.Q = np.kron(Q_continuous_white_noise(2, PERIOD, DENSITY), np.eye(2))
        filters.append(one)
    for measured in positions:
        for one, position in zip(filters, measured, strict=True):
            one.predict()
            one.update(position)
    return np.array([one.x for one in filters])


def measure() -> list[dict[str, Any]]:
    """Return the median user CPU time of a step with and without a map, and of its filters beside filterpy's."""
    seen, tracker = make_scans(), component("tracker", "kalman", robot_preset="jackal", robot=_jackal_robot())
    positions = np.random.default_rng(1).normal(size=(STEPS, PEOPLE, 2))
    np.testing.assert_allclose(batched_filters(positions), filterpy_filters(positions), atol=1e-9)
    assert track_people(tracker, make_hall(known=True), seen) == PEOPLE
    functions = {
        "known": partial(_repeat_calls, partial(track_people, tracker, make_hall(known=True), seen)),
        "unknown": partial(_repeat_calls, partial(track_people, tracker, None, seen)),
        "ours": partial(_repeat_calls, partial(batched_filters, positions)),
        "filterpy": partial(_repeat_calls, partial(filterpy_filters, positions)),
    }
    ms = {
        name: float(np.median(seconds)) / (5 * STEPS) * 1e3
        for name, seconds in interleave(functions, repeats=11).items()
    }
    return [
        _make_row("tracker step, 10 tracks, 720 beams, with a map, at most", ms["known"]),
        _make_row("tracker step, 10 tracks, 720 beams, without a map, at most", ms["unknown"]),
        {
            "what": "Kalman filters of 10 tracks, one step",
            "ours_ms": ms["ours"],
            "peer": "filterpy",
            "peer_ms": ms["filterpy"],
            "ratio": ms["ours"] / ms["filterpy"],
            "goal": 0.1,
            "unit": "x peer",
        },
    ]


def _jackal_robot() -> Any:
    return component("robot", "jackal")


def _make_row(what: str, ms: float) -> dict[str, Any]:
    return {"what": what, "ours_ms": ms, "peer": None, "peer_ms": None, "ratio": None, "goal": 0.3, "unit": "ms"}


def _repeat_calls(work: Any) -> None:
    for _ in range(5):
        work()


if __name__ == "__main__":
    for row in measure():
        peer = f"{row['peer']} {row['peer_ms']:.3f} ms, ratio {row['ratio']:.3f}" if row["peer"] else ""
        print(f"{row['what']:62} {row['ours_ms']:.3f} ms  {peer:45} goal {row['goal']:.3f} {row['unit']}")
