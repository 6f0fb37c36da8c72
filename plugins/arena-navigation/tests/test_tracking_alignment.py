import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arena_core import Pose
from arena_core.testing import component, robot, room
from arena_core.testing import scan as room_scan
from arena_navigation.local_map.marks import PlacedScan
from arena_navigation.tracking.alignment import Alignment, Points, estimate_slip, move_states
from arena_navigation.tracking.returns import KnownPlane, PastScans, Returns, place_returns

LOOSE = Alignment(1.0, 1.0, 0.01, 0.2, 0.05, 180)
NOBODY = np.empty((0, 3))


def moved_back(point, moved, sensor):
    c, s = math.cos(moved[2]), math.sin(moved[2])
    return np.array(((c, -s), (s, c))) @ (np.asarray(point) - sensor[:2]) + sensor[:2] + moved[:2]


def found(past_pose, true_pose, believed, grid=None, tracks=NOBODY, change=lambda ranges: ranges, rules=LOOSE):
    past = PastScans.none(1, 180)
    past.ranges[0], past.sensors[0] = room_scan(past_pose, robot()).ranges, past_pose.array()
    scan = room_scan(true_pose, robot())
    scan.ranges[:] = change(scan.ranges)
    moved = np.zeros(3)
    beams = PlacedScan.of(scan, believed)
    returns = Returns.room(180)
    place_returns(beams, KnownPlane.of(grid), np.inf, 1, returns)
    estimate_slip(beams, returns, past, 0, tracks, rules, Points.room(180), moved)
    return beams, moved


@settings(derandomize=True, deadline=None, max_examples=40)
@given(*[st.floats(-1.0, 1.0)] * 7)
def test_the_error_of_a_pose_is_found(x, y, turn, ahead, aside, error, heading_error):
    past_pose, true_pose = (
        Pose(x, y, 3.0 * turn),
        Pose(x + 0.3 * ahead, y + 0.3 * aside, 3.0 * turn + 0.3 * heading_error),
    )
    believed = Pose(true_pose.x + 0.05 * error, true_pose.y - 0.05 * error, true_pose.theta + 0.05 * heading_error)
    _, moved = found(past_pose, true_pose, believed)
    np.testing.assert_allclose(moved[:2], (true_pose.x - believed.x, true_pose.y - believed.y), atol=0.01)
    assert moved[2] == pytest.approx(true_pose.theta - believed.theta, abs=0.005)


@settings(derandomize=True, deadline=None, max_examples=30)
@given(st.integers(0, 10**6))
def test_what_is_carried_lies_where_the_new_pose_sees_it(seed):
    random = np.random.default_rng(seed)
    beams = PlacedScan.of(room_scan(Pose(*random.uniform(-1.0, 1.0, 3)), robot()), Pose(*random.uniform(-1.0, 1.0, 3)))
    moved, states = random.uniform(-0.3, 0.3, 3), random.normal(size=(3, 4))
    a = random.normal(size=(3, 4, 4))
    covariances = a @ a.transpose(0, 2, 1)
    sensors = random.normal(size=(2, 3))
    before, sure, scanners = states.copy(), covariances.copy(), sensors.copy()
    move_states(beams, moved, states, covariances, sensors)
    c, s = math.cos(moved[2]), math.sin(moved[2])
    turn = np.kron(np.eye(2), ((c, -s), (s, c)))
    for k in range(3):
        np.testing.assert_allclose(moved_back(states[k, :2], moved, np.array(beams.sensor)), before[k, :2], atol=1e-12)
        np.testing.assert_allclose(turn[:2, :2] @ states[k, 2:], before[k, 2:], atol=1e-12)
        np.testing.assert_allclose(turn @ covariances[k] @ turn.T, sure[k], atol=1e-12)
    for k in range(2):
        np.testing.assert_allclose(
            moved_back(sensors[k, :2], moved, np.array(beams.sensor)), scanners[k, :2], atol=1e-12
        )
    np.testing.assert_allclose(sensors[:, 2] + moved[2], scanners[:, 2])


def test_a_crowd_is_not_taken_for_the_room():
    def crowd(ranges):
        ranges = ranges.copy()
        ranges[:100] = 1.5
        return ranges

    stands = Pose(0.0, 0.0)
    _, moved = found(stands, stands, stands, grid=room(), change=crowd, rules=Alignment(1.0, 1.0, 0.01, 0.2, 0.05, 180))
    np.testing.assert_allclose(moved, 0.0, atol=1e-3)


@pytest.mark.parametrize("value", [math.nan, math.inf, 0.0])
def test_a_scan_without_returns_moves_nothing(value):
    _, moved = found(Pose(0.0, 0.0), Pose(0.0, 0.0), Pose(0.1, 0.0), change=lambda ranges: np.full_like(ranges, value))
    np.testing.assert_array_equal(moved, 0.0)


@pytest.mark.parametrize("grid", [None, room()])
def test_a_pose_that_jitters_makes_nothing_move(grid):
    tracker = component("tracker", "kalman", robot=robot())
    tracker.reset(grid)
    random = np.random.default_rng(0)
    for k in range(40):
        t = 0.1 * k
        true = Pose(-1.0 + 0.5 * t, 0.3, 0.5 * t)
        believed = Pose(*(true.array() + random.normal(size=3) * (0.02, 0.02, 0.02)))
        scan = room_scan(true, robot(), stamp=t)
        person = np.array((2.0 - 0.5 * t, -2.0)) - (true.x, true.y)
        angles = true.theta + scan.angle_min + scan.angle_increment * np.arange(180)
        along, beside = (
            person[0] * np.cos(angles) + person[1] * np.sin(angles),
            person[1] * np.cos(angles) - person[0] * np.sin(angles),
        )
        near = along - np.sqrt(np.maximum(0.09 - beside**2, 0.0))
        scan.ranges[:] = np.where((np.abs(beside) < 0.3) & (along > 0.0), np.minimum(scan.ranges, near), scan.ranges)
        tracks = tracker.update(scan, believed, t)
    assert len(tracks.ids) == 1
    np.testing.assert_allclose(tracks.velocities[0], (-0.5, 0.0), atol=0.2)
