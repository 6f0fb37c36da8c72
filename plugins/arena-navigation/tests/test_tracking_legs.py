"""Two legs of one person are one body, two people are two."""

import math

import numpy as np
import pytest

from arena_core import NO_TRACKS, LaserScan, OccupancyGrid, Pose, Tracker, Tracks
from arena_core.testing import component, robot
from arena_kernels.raycast import cast_disc, make_beams

GRID = OccupancyGrid(np.zeros((200, 200), np.int8), 0.05, Pose(0.0, 0.0))
BEAMS = make_beams(-math.pi, math.radians(0.5), 720, 10.0)
HERE = Pose(3.0, 5.0)


def seen(tracker: Tracker, legs: list[tuple[float, float]]) -> Tracks:
    """Return the tracks after five scans of legs that stand at (x, y)."""
    tracker.reset(GRID)
    ranges = np.full(720, np.inf, np.float32)
    for x, y in legs:
        cast_disc((HERE.x, HERE.y, 0.0), BEAMS, (x, y, 0.05), ranges)
    told = NO_TRACKS
    for k in range(5):
        scan = LaserScan(0.1 * k, BEAMS.angle_min, BEAMS.angle_increment, 0.05, 10.0, ranges, Pose(0.0, 0.0))
        told = tracker.update(scan, HERE, 0.1 * k)
    return told


@pytest.mark.parametrize("ahead", [0.0, 0.1, 0.2])
def test_two_legs_are_one_body_between_them(ahead: float) -> None:
    told = seen(component("tracker", "kalman_legs", robot=robot()), [(5.0 + ahead, 5.12), (5.0 - ahead, 4.88)])
    assert len(told.ids) == 1
    assert told.positions[0] == pytest.approx((5.0, 5.0), abs=0.05)
    assert told.radii[0] == pytest.approx(0.3, abs=0.02)


def test_two_people_are_two_bodies() -> None:
    told = seen(component("tracker", "kalman_legs", robot=robot()), [(5.0, 5.5), (5.0, 5.3), (5.0, 4.7), (5.0, 4.5)])
    assert sorted(told.positions[:, 1].tolist()) == pytest.approx([4.6, 5.4], abs=0.05)


def test_legs_are_bodies_of_their_own_to_who_expects_discs() -> None:
    assert len(seen(component("tracker", "kalman", robot=robot()), [(5.0, 5.25), (5.0, 4.75)]).ids) == 2
