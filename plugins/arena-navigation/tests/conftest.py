"""What a lidar sees of discs, for the tests of the tracker."""

import math

import numpy as np
import pytest
from numpy.typing import NDArray

from arena_core import LaserScan, Pose


def scan_of_discs(
    pose: Pose,
    discs: list[tuple[float, float, float]],
    stamp: float = 0.0,
    beams: int = 360,
    field_of_view: float = 2.0 * math.pi,
    noise: float = 0.0,
    range_max: float = 8.0,
    seed: int = 0,
) -> LaserScan:
    """Return the scan, from a lidar at ``pose``, of discs (x, y, radius) in an endless plane."""
    full = field_of_view > 2.0 * math.pi - 1e-6
    increment = field_of_view / (beams if full else beams - 1)
    angles = pose.theta - field_of_view / 2.0 + increment * np.arange(beams)
    ranges: NDArray[np.float64] = np.full(beams, np.inf)
    for x, y, radius in discs:
        along = (x - pose.x) * np.cos(angles) + (y - pose.y) * np.sin(angles)
        beside = (y - pose.y) * np.cos(angles) - (x - pose.x) * np.sin(angles)
        hit = (np.abs(beside) < radius) & (along > 0.0)
        near = along - np.sqrt(np.maximum(radius**2 - beside**2, 0.0))
        ranges = np.where(hit, np.minimum(ranges, near), ranges)
    ranges = ranges + noise * np.random.default_rng(seed).standard_normal(beams)
    ranges[ranges > range_max] = np.inf
    return LaserScan(stamp, -field_of_view / 2.0, increment, 0.05, range_max, ranges.astype(np.float32), Pose(0.0, 0.0))


@pytest.fixture(name="scan_of_discs", scope="session")
def _scan_of_discs():
    return scan_of_discs
