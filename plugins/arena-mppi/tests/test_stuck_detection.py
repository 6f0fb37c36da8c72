import math

import pytest

from arena_core import Pose
from arena_mppi.stuck_detection import LEAST, StuckDetector

HERE = Pose(1.0, 2.0)


def test_wish_for_room_falls_while_the_robot_stands():
    patience = StuckDetector(5.0)
    assert patience.clearance_scale(HERE, 3.0) == 1.0
    assert patience.clearance_scale(Pose(1.2, 2.0, 1.0), 8.0) == 1.0
    assert patience.clearance_scale(HERE, 13.0) == pytest.approx(math.exp(-1.0))
    assert patience.clearance_scale(HERE, 1000.0) == LEAST


def test_a_robot_that_drives_on_is_patient_again():
    patience, stamp = StuckDetector(5.0), 20.0
    patience.clearance_scale(HERE, 0.0)
    assert patience.clearance_scale(HERE, stamp) < 0.1
    for k in range(1, 6):
        left = patience.clearance_scale(Pose(1.0 + 0.31 * k, 2.0), stamp + 0.5 * k)
    assert left == 1.0


def test_a_robot_that_shuffles_to_and_fro_goes_on_losing_patience():
    patience = StuckDetector(5.0)
    for k in range(8):
        left = patience.clearance_scale(Pose(1.0 + 0.31 * (k % 2), 2.0), 6.0 * k)
    assert left < 0.4


def test_patience_can_last_for_ever():
    patience = StuckDetector(None)
    patience.clearance_scale(HERE, 0.0)
    assert patience.clearance_scale(HERE, 1e6) == 1.0
