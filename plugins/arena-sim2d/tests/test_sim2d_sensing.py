from dataclasses import replace

import numpy as np
import pytest

from arena_core import Obstacle, OdometryModel, Pose, Robot, stream_key
from arena_core.testing import robot, scan, scenario
from arena_core.testing.samples import person
from arena_kernels.random import normal


def stand(simulate, body: Robot, problem):
    simulator = simulate(body)
    return simulator, simulator.reset([problem])


def test_first_scan_sees_the_room_from_the_mount(simulate, alter):
    body = alter(robot(), "lidar", mount=Pose(0.1, -0.05, 0.4), range_max=20.0)
    start = Pose(-1.0, 2.0, 0.7)
    _, snapshot = stand(simulate, body, scenario(start=start))
    np.testing.assert_allclose(snapshot.sensors(0).scan.ranges, scan(start, body).ranges, atol=1e-4)


def test_scan_sees_people_and_obstacles(simulate):
    problem = scenario(start=Pose(0.0, 0.0, 0.0), people=[person(1, 2.0, 0.0)])
    disc, box = (
        Obstacle(np.array([[0.0, 2.0]]), 0.5),
        Obstacle(np.array([[-2.0, -1.0], [-1.0, -1.0], [-1.0, 1.0], [-2.0, 1.0]])),
    )
    _, snapshot = stand(simulate, robot(), replace(problem, obstacles=(disc, box)))
    back, _, ahead, left = snapshot.ranges[0][[0, 45, 90, 135]]
    assert (ahead, left, back) == pytest.approx((1.7, 1.5, 1.0), abs=1e-5)


def test_beam_that_meets_nothing_in_range_reads_infinity(simulate, alter):
    _, snapshot = stand(simulate, alter(robot(), "lidar", range_max=1.0), scenario(start=Pose(0.0, 0.0, 0.0)))
    assert np.isinf(snapshot.ranges).all()


def test_what_is_too_near_reads_the_minimum_range(simulate, alter):
    _, snapshot = stand(simulate, alter(robot(), "lidar", range_min=0.9), scenario(start=Pose(4.5, 0.0, 0.0)))
    assert snapshot.ranges[0, 90] == pytest.approx(0.9)


def test_noise_is_gaussian_and_keyed_by_scenario_tick_and_beam(simulate, alter):
    body = alter(robot(), "lidar", noise_std=0.05)
    simulator, snapshot = stand(simulate, body, scenario(start=Pose(0.0, 0.0, 0.0)))
    exact = scan(Pose(0.0, 0.0, 0.0), body).ranges
    scans = [snapshot.ranges[0]] + [simulator.advance(np.zeros((1, 3)), 10).ranges[0] for _ in range(100)]
    errors = np.array(scans) - exact
    assert abs(errors.mean()) < 0.002
    assert errors.std() == pytest.approx(0.05, rel=0.03)
    key = stream_key(0, "sample/0", "lidar")
    assert errors[3, 5] == pytest.approx(0.05 * normal(key, 30, 5), abs=1e-5)
    again = simulator.reset([scenario(start=Pose(0.0, 0.0, 0.0))])
    assert again.ranges[0].tolist() == scans[0].tolist()
    other = simulator.reset([scenario(start=Pose(0.0, 0.0, 0.0), name="sample/1")])
    assert other.ranges[0].tolist() != scans[0].tolist()


def test_scan_keeps_its_own_stamp_and_is_the_newest_that_was_due(simulate, alter):
    body = alter(robot(), "lidar", period=0.15)
    simulator, _ = stand(simulate, body, scenario(start=Pose(-1.5, 0.0, 0.0)))
    stamps, ahead = [], []
    for _ in range(6):
        snapshot = simulator.advance(np.array([[0.5, 0.0, 0.0]]), 10)
        stamps.append(snapshot.scan_stamps[0])
        ahead.append(snapshot.ranges[0, 90])
    assert stamps == pytest.approx([0.0, 0.15, 0.3, 0.3, 0.45, 0.6])
    assert ahead[2] == ahead[3]
    assert ahead[1] > ahead[2] > ahead[4]


def drive_odometry(simulate, model, command, steps, kinematics="differential"):
    body = replace(robot(kinematics), odometry=model)
    simulator = simulate(body)
    simulator.reset([scenario(start=Pose(0.0, 0.0, 0.0), name=f"drive/{k}") for k in range(200)])
    for _ in range(steps):
        snapshot = simulator.advance(np.tile(command, (200, 1)), 10)
    return snapshot


@pytest.mark.parametrize("kinematics", ["differential", "omnidirectional", "ackermann"])
def test_odometry_without_noise_is_the_truth(simulate, kinematics):
    snapshot = drive_odometry(simulate, OdometryModel(0.02, 0.0, 0.0, 0.0, 0.0), (0.6, 0.3, 0.8), 12, kinematics)
    np.testing.assert_allclose(snapshot.odometry_poses, snapshot.poses, atol=1e-9)
    np.testing.assert_allclose(snapshot.odometry_twists, snapshot.twists, atol=1e-3)
    assert snapshot.odometry_stamps == pytest.approx(snapshot.stamps)


def test_odometry_backwards_is_not_a_turn(simulate):
    snapshot = drive_odometry(simulate, OdometryModel(0.02, 0.5, 0.0, 0.0, 0.0), (-0.5, 0.0, 0.0), 5)
    np.testing.assert_allclose(snapshot.odometry_poses, snapshot.poses, atol=1e-9)


def test_odometry_of_a_standing_robot_does_not_drift(simulate):
    snapshot = drive_odometry(simulate, OdometryModel(0.02, 1.0, 1.0, 1.0, 1.0), (0.0, 0.0, 0.0), 3)
    assert not snapshot.odometry_poses.any()
    assert not snapshot.odometry_twists.any()


@pytest.mark.parametrize("kinematics", ["differential", "omnidirectional"])
def test_odometry_noise_has_the_spread_of_the_model(simulate, kinematics):
    """One period of 0.1 s straight ahead: translation spreads by sqrt(alpha3) of it, heading by
    sqrt(alpha2) of it, per rotation.
    """
    body = replace(robot(kinematics), odometry=OdometryModel(0.1, 0.0, 0.02, 0.04, 0.0))
    simulator = simulate(body)
    simulator.reset([scenario(start=Pose(0.0, 0.0, 0.0), name=f"drive/{k}") for k in range(400)])
    simulator.advance(np.tile((0.5, 0.0, 0.0), (400, 1)), 30)
    before = simulator.advance(np.tile((0.5, 0.0, 0.0), (400, 1)), 10)
    after = simulator.advance(np.tile((0.5, 0.0, 0.0), (400, 1)), 10)
    moved = np.hypot(*(after.odometry_poses - before.odometry_poses)[:, :2].T)
    turned = (after.odometry_poses - before.odometry_poses)[:, 2]
    assert moved.mean() == pytest.approx(0.05, abs=0.002)
    assert moved.std() == pytest.approx(0.05 * 0.2, rel=0.15)
    rotations = 2 if kinematics == "differential" else 1
    assert turned.std() == pytest.approx(0.05 * (0.02 * rotations) ** 0.5, rel=0.15)
