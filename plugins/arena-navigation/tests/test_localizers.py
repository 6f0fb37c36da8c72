import math
from dataclasses import replace

import numpy as np
import pytest

from arena_core import (
    ArenaError,
    Footprint,
    LaserScan,
    Lidar,
    Odometry,
    OdometryModel,
    Pose,
    Robot,
    Sensors,
    Twist,
    VelocityLimits,
    random_generator,
)
from arena_navigation.localizers import GroundTruthLocalizer, OdometryLocalizer

ROBOT = Robot(
    "cart",
    "differential",
    Footprint.circle(0.2),
    VelocityLimits(-0.5, 0.5, 0.0, 1.0, 1.0, 0.0, 2.0),
    Lidar(4, 0.0, 1.0, 0.1, 5.0, 0.1, 0.01, Pose(0.0, 0.0)),
    OdometryModel(0.02, 0.1, 0.02, 0.03, 0.001),
    0.1,
)
SCAN = LaserScan(0.0, 0.0, 1.0, 0.1, 5.0, np.ones(4, np.float32), Pose(0.0, 0.0))
START = Pose(3.0, -1.0, 0.7)


def sensors(stamp, pose, reference=None):
    return Sensors(stamp, SCAN, Odometry(stamp, pose, Twist(0.0)), reference)


def begun(localizer, start=START):
    localizer.reset(None, start, random_generator(0, "test", "localizer"))
    return localizer


def assert_same(pose, expected):
    assert (pose.x, pose.y, pose.theta) == pytest.approx((expected.x, expected.y, expected.theta))


def test_ground_truth_is_the_reference_without_any_doubt():
    estimate = begun(GroundTruthLocalizer()).update(sensors(0.0, Pose(9.0, 9.0), Pose(1.0, 2.0, 0.5)))
    assert estimate.pose == Pose(1.0, 2.0, 0.5)
    assert not estimate.covariance.any()


def test_ground_truth_needs_a_reference():
    with pytest.raises(ArenaError, match=r"localizer=amcl"):
        begun(GroundTruthLocalizer()).update(sensors(0.0, Pose(0.0, 0.0)))


def test_dead_reckoning_adds_odometry_to_the_start():
    localizer = begun(OdometryLocalizer(robot=ROBOT))
    first, second = Pose(5.0, 5.0, 1.0), Pose(5.6, 5.9, -0.4)
    assert_same(localizer.update(sensors(0.0, first)).pose, START)
    assert_same(localizer.update(sensors(0.1, second)).pose, START.compose(first.relative(second)))


def test_dead_reckoning_forgets_the_episode_before():
    localizer = begun(OdometryLocalizer(robot=ROBOT))
    for k in range(5):
        localizer.update(sensors(0.1 * k, Pose(k, k, k)))
    estimate = begun(localizer).update(sensors(0.0, Pose(7.0, 7.0, 0.3)))
    assert_same(estimate.pose, START)
    assert not estimate.covariance.any()


def noisy(random, step, poses):
    """Move odometers by a step, each with the noise of table 5.6."""
    model = ROBOT.odometry
    turn, travel = math.atan2(step.y, step.x), math.hypot(step.x, step.y)
    again = step.theta - turn
    draws = random.standard_normal((3, len(poses)))
    first = turn + math.sqrt(model.alpha1 * turn**2 + model.alpha2 * travel**2) * draws[0]
    moved = travel + math.sqrt(model.alpha3 * travel**2 + model.alpha4 * (turn**2 + again**2)) * draws[1]
    second = again + math.sqrt(model.alpha1 * again**2 + model.alpha2 * travel**2) * draws[2]
    poses[:, 0] += moved * np.cos(poses[:, 2] + first)
    poses[:, 1] += moved * np.sin(poses[:, 2] + first)
    poses[:, 2] += first + second


def test_dead_reckoning_knows_how_far_it_may_be_off():
    random, step, steps = np.random.default_rng(2), Pose(0.01, 0.00001, 0.002), 1000
    odometers = np.zeros((3000, 3))
    localizer, true = begun(OdometryLocalizer(robot=ROBOT), Pose(0.0, 0.0, 0.0)), Pose(0.0, 0.0)
    estimate = localizer.update(sensors(0.0, true))
    for k in range(1, steps + 1):
        noisy(random, step, odometers)
        true = true.compose(step)
        if k % 5 == 0:  # a control step is five messages long
            estimate = localizer.update(sensors(0.02 * k, true))
    spread = np.sqrt(np.diag(np.cov(odometers.T)))
    np.testing.assert_allclose(np.sqrt(np.diag(estimate.covariance)), spread, rtol=0.15)
    np.testing.assert_allclose(estimate.covariance, estimate.covariance.T)


def test_standing_still_makes_dead_reckoning_no_worse():
    localizer = begun(OdometryLocalizer(robot=ROBOT))
    localizer.update(sensors(0.0, Pose(0.0, 0.0)))
    moved = localizer.update(sensors(0.1, Pose(0.05, 0.0, 0.1)))
    still = localizer.update(replace(sensors(0.2, Pose(0.05, 0.0, 0.1)), stamp=0.2))
    np.testing.assert_allclose(still.covariance, moved.covariance, atol=1e-12)
