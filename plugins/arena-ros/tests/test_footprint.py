from __future__ import annotations

import numpy as np
import pytest

from arena_core import Footprint, LaserScan, Pose
from arena_ros.bags.footprint import nearest_return, point_clearances

DISC = Footprint(0.2, np.empty((0, 2)))
BOX = Footprint(0.33, np.array([(0.25, 0.2), (-0.25, 0.2), (-0.25, -0.2), (0.25, -0.2)]))


@pytest.mark.parametrize("footprint", [DISC, BOX])
def test_beams_that_are_left_out_change_nothing(footprint: Footprint) -> None:
    random = np.random.default_rng(0)
    for _ in range(200):
        ranges = random.uniform(0.2, 4.0, 90).astype(np.float32)
        ranges[random.random(90) < 0.3] = np.inf
        scan = LaserScan(
            0.0, -np.pi, np.pi / 45, 0.1, 30.0, ranges, Pose(*random.uniform(-0.3, 0.3, 2), random.uniform(-3.0, 3.0))
        )
        beams = np.flatnonzero(np.isfinite(ranges))
        angles = scan.angle_min + scan.angle_increment * beams + scan.mount.theta
        reach = ranges[beams].astype(np.float64)
        points = np.stack((scan.mount.x + reach * np.cos(angles), scan.mount.y + reach * np.sin(angles)), axis=1)
        assert nearest_return(footprint, scan) == (ranges.min(), point_clearances(footprint, points).min())


def test_nothing_is_near_where_nothing_was_hit() -> None:
    scan = LaserScan(0.0, 0.0, 0.1, 0.1, 30.0, np.full(5, np.inf, np.float32), Pose(0.0, 0.0))
    assert nearest_return(DISC, scan) == (np.inf, np.inf)
