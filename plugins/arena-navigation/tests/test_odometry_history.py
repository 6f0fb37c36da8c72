import math

import pytest

from arena_core import Odometry, Pose, Twist
from arena_navigation.amcl.odometry_history import KEPT, OdometryHistory


def history(*messages):
    kept = OdometryHistory()
    for stamp, pose in messages:
        kept.add(Odometry(stamp, Pose(*pose), Twist(1.0, 0.0, 0.5)))
    return kept


def assert_pose(pose, x, y, theta):
    assert (pose.x, pose.y, pose.theta) == pytest.approx((x, y, theta), abs=1e-9)


def test_between_two_messages_the_pose_is_in_proportion():
    kept = history((1.0, (0.0, 0.0, 0.0)), (1.1, (0.2, 0.1, 0.4)), (1.2, (0.9, 0.9, 0.9)))
    assert_pose(kept.at(1.025), 0.05, 0.025, 0.1)
    assert_pose(kept.at(1.1), 0.2, 0.1, 0.4)


def test_headings_are_interpolated_the_short_way_round():
    kept = history((0.0, (0.0, 0.0, 3.0)), (1.0, (0.0, 0.0, -3.0)), (2.0, (0.0, 0.0, 0.0)))
    assert abs(kept.at(0.5).theta) == pytest.approx(math.pi)


def test_after_the_last_message_its_twist_is_held_along_the_arc():
    pose = history((2.0, (1.0, 1.0, 0.0))).at(2.2)
    assert_pose(pose, 1.0 + 0.2 * math.cos(0.05), 1.0 + 0.2 * math.sin(0.05), 0.1)


def test_before_the_first_message_nothing_is_known_but_that_message():
    assert_pose(history((1.0, (0.3, 0.0, 0.1)), (2.0, (1.0, 0.0, 0.0))).at(0.5), 0.3, 0.0, 0.1)


def test_a_message_that_comes_twice_or_late_is_ignored():
    kept = history((1.0, (0.0, 0.0, 0.0)), (2.0, (1.0, 0.0, 0.0)))
    for stamp in (2.0, 1.5):
        kept.add(Odometry(stamp, Pose(9.0, 9.0), Twist(0.0)))
    assert_pose(kept.at(1.5), 0.5, 0.0, 0.0)
    assert_pose(kept.at(2.0), 1.0, 0.0, 0.0)


def test_only_the_recent_past_is_kept():
    kept = history(*((float(k), (float(k), 0.0, 0.0)) for k in range(KEPT + 10)))
    assert kept.at(0.0).x == 10.0
