import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arena_core import ConfigurationError, LaserScan, OccupancyGrid, Pose
from arena_core.testing import component, robot, room
from arena_core.testing import scan as room_scan

PERSON = 0.3


def open_plane():
    return OccupancyGrid(np.zeros((400, 400), np.int8), 0.1, Pose(-20.0, -20.0))


@pytest.fixture(scope="module")
def built():
    return component("tracker", "kalman", robot=robot())


@pytest.fixture
def tracker(built):
    built.reset(open_plane())
    return built


def follow(tracker, scan_of_discs, bodies, pose=lambda t: Pose(0.0, 0.0), steps=20, period=0.1, noise=0.005, **lidar):
    """Return the tracks after ``steps`` scans; ``bodies`` and ``pose`` are functions of time."""
    for k in range(steps):
        t = k * period
        tracks = tracker.update(scan_of_discs(pose(t), bodies(t), t, noise=noise, seed=k, **lidar), pose(t), t)
    return tracks


@settings(derandomize=True, deadline=None, max_examples=25)
@given(st.floats(0.8, 4.5), st.floats(-math.pi, math.pi), st.floats(0.0, 1.5), st.floats(-math.pi, math.pi))
def test_a_walking_person_is_found_with_place_speed_and_radius(built, scan_of_discs, away, bearing, speed, heading):
    built.reset(open_plane())
    velocity = speed * np.array((math.cos(heading), math.sin(heading)))
    end = away * np.array((math.cos(bearing), math.sin(bearing)))

    def bodies(t):
        return [(*(end + velocity * (t - 1.9)), PERSON)]

    start = end - 1.9 * velocity
    closest = min(np.hypot(*(start + velocity * t)) for t in np.linspace(0.0, 1.9, 40))
    if closest < 0.6 or np.hypot(*start) > 6.5:
        return
    tracks = follow(built, scan_of_discs, bodies, beams=720)
    assert len(tracks.ids) == 1
    np.testing.assert_allclose(tracks.positions[0], end, atol=0.05)
    np.testing.assert_allclose(tracks.velocities[0], velocity, atol=0.15)
    assert tracks.radii[0] == pytest.approx(PERSON, abs=0.06)


@settings(derandomize=True, deadline=None, max_examples=15)
@given(st.floats(-1.5, 1.5), st.floats(-2.0, 2.0))
def test_a_driving_robot_sees_a_standing_person_stand(built, scan_of_discs, speed, turning):
    built.reset(open_plane())
    tracks = follow(
        built, scan_of_discs, lambda t: [(3.0, 2.0, PERSON)], lambda t: Pose(speed * t, 0.0, turning * t), beams=720
    )
    assert np.hypot(*tracks.velocities[0]) < 0.1


def test_tracks_are_told_of_at_the_stamp_that_was_asked_for(tracker, scan_of_discs):
    follow(tracker, scan_of_discs, lambda t: [(2.0 + t, 1.0, PERSON)])
    scan = scan_of_discs(Pose(0.0, 0.0), [(4.0, 1.0, PERSON)], 2.0)
    now, later = (tracker.update(scan, Pose(0.0, 0.0), stamp) for stamp in (2.0, 2.5))
    np.testing.assert_allclose(later.positions, now.positions + 0.5 * now.velocities)
    assert (np.trace(later.covariances[0]) > np.trace(now.covariances[0])).all()


def test_the_same_scan_twice_changes_nothing(tracker, scan_of_discs):
    follow(tracker, scan_of_discs, lambda t: [(2.0 + t, 1.0, PERSON)])
    scan = scan_of_discs(Pose(0.0, 0.0), [(4.0, 1.0, PERSON)], 2.0)
    first = tracker.update(scan, Pose(0.0, 0.0), 2.0)
    again = tracker.update(scan, Pose(0.0, 0.0), 2.0)
    for one, other in zip(
        (first.ids, first.positions, first.covariances), (again.ids, again.positions, again.covariances), strict=True
    ):
        np.testing.assert_array_equal(one, other)


def test_scans_at_irregular_times_give_the_same_speed(tracker, scan_of_discs):
    stamps = np.cumsum(np.random.default_rng(3).uniform(0.05, 0.4, 20))
    for k, t in enumerate(stamps):
        tracks = tracker.update(
            scan_of_discs(Pose(0.0, 0.0), [(-2.0 + 0.8 * t, 2.0, PERSON)], t, seed=k, noise=0.005), Pose(0.0, 0.0), t
        )
    np.testing.assert_allclose(tracks.velocities, [(0.8, 0.0)], atol=0.1)


def test_two_people_side_by_side_are_two(tracker, scan_of_discs):
    tracks = follow(tracker, scan_of_discs, lambda t: [(3.0 - 0.5 * t, 0.31, PERSON), (3.0 - 0.5 * t, -0.31, PERSON)])
    assert len(tracks.ids) == 2
    np.testing.assert_allclose(np.sort(tracks.positions[:, 1]), (-0.31, 0.31), atol=0.06)


def test_people_keep_their_numbers_when_they_cross_behind_each_other(tracker, scan_of_discs):
    def bodies(t):
        return [(2.0, -1.5 + t, PERSON), (3.5, 1.5 - t, PERSON)]

    before = follow(tracker, scan_of_discs, bodies, steps=8)
    tracker.reset(open_plane())
    after = follow(tracker, scan_of_discs, bodies, steps=30)
    assert sorted(before.ids) == sorted(after.ids)
    near = after.ids[np.argmin(after.positions[:, 0])]
    assert near == before.ids[np.argmin(before.positions[:, 0])]


@pytest.mark.parametrize("bearing", [0.0, 2.0, math.pi, -3.13])
def test_who_is_hidden_is_not_forgotten_and_who_is_gone_is(tracker, scan_of_discs, bearing):
    ahead = np.array((math.cos(bearing), math.sin(bearing)))
    person, screen = (*(4.0 * ahead), PERSON), (*(1.5 * ahead), PERSON)
    follow(tracker, scan_of_discs, lambda t: [person])
    hidden = [
        tracker.update(scan_of_discs(Pose(0.0, 0.0), [screen], 2.0 + 0.1 * k), Pose(0.0, 0.0), 2.0 + 0.1 * k)
        for k in range(8)
    ]
    assert len(hidden[-1].ids) == 2
    gone = [
        tracker.update(scan_of_discs(Pose(0.0, 0.0), [], 3.0 + 0.1 * k), Pose(0.0, 0.0), 3.0 + 0.1 * k)
        for k in range(4)
    ]
    assert len(gone[-1].ids) == 0


def test_who_is_beside_the_field_of_view_is_not_gone(tracker, scan_of_discs):
    def pose(t):
        return Pose(0.0, 0.0, 0.0 if t < 1.95 else math.pi)

    before = follow(tracker, scan_of_discs, lambda t: [(3.0, 0.0, PERSON)], pose, field_of_view=4.0)
    after = follow(tracker, scan_of_discs, lambda t: [(3.0, 0.0, PERSON)], pose, steps=25, field_of_view=4.0)
    np.testing.assert_array_equal(before.ids, after.ids)


def test_walls_of_the_map_are_not_tracked_even_from_a_pose_that_is_a_little_off(tracker):
    tracker.reset(room())
    for k in range(10):
        seen = Pose(0.3 * math.sin(k), 0.2, 0.3 * k)
        believed = Pose(seen.x + 0.05, seen.y - 0.05, seen.theta + 0.01)
        tracks = tracker.update(room_scan(seen, robot(), stamp=0.1 * k), believed, 0.1 * k)
    assert len(tracks.ids) == 0


def test_without_a_map_only_what_moves_is_tracked(tracker, scan_of_discs):
    tracker.reset(None)
    pillars = [(2.0 * math.cos(a), 2.0 * math.sin(a), 0.2) for a in np.arange(1.0, 6.0, 0.7)]
    tracks = follow(tracker, scan_of_discs, lambda t: [*pillars, (2.5 - 0.6 * t, 0.5, PERSON)], steps=25)
    assert len(tracks.ids) == 1
    np.testing.assert_allclose(tracks.velocities, [(-0.6, 0.0)], atol=0.15)


@pytest.mark.parametrize("value", [math.nan, math.inf, 0.0, -1.0])
def test_a_scan_without_any_return_is_no_trouble(tracker, scan_of_discs, value):
    follow(tracker, scan_of_discs, lambda t: [(2.0, 0.0, PERSON)])
    empty = LaserScan(2.0, -math.pi, 2 * math.pi / 360, 0.05, 8.0, np.full(360, value, np.float32), Pose(0.0, 0.0))
    tracks = tracker.update(empty, Pose(0.0, 0.0), 2.0)
    assert len(tracks.ids) == 1
    assert np.isfinite(tracks.covariances).all()


def test_two_hundred_bodies_are_tracked(tracker, scan_of_discs):
    bodies = [
        (away * math.cos(a), away * math.sin(a), 0.05)
        for a, away in zip(np.linspace(0, 6.25, 200), np.tile((4.0, 6.0), 100), strict=True)
    ]
    tracks = follow(tracker, scan_of_discs, lambda t: bodies, steps=4, beams=3600)
    assert len(tracks.ids) == 200


def test_nothing_survives_a_reset(tracker, scan_of_discs):
    def bodies(t):
        return [(2.0 + t, 1.0, PERSON)]

    first = follow(tracker, scan_of_discs, bodies)
    tracker.reset(open_plane())
    again = follow(tracker, scan_of_discs, bodies)
    np.testing.assert_array_equal(first.ids, again.ids)
    np.testing.assert_array_equal(first.covariances, again.covariances)


def test_impossible_radii_are_refused():
    with pytest.raises(ConfigurationError, match=r"shape\.radius is 0\.05; allowed: from radius_min"):
        component("tracker", "kalman", ["tracker.shape.radius=0.05"], robot=robot())


def box_scan(pose, low, high, stamp):
    """Return what a lidar at ``pose`` sees of a box that lies along the axes, from corner
    ``low`` to corner ``high``.
    """
    angles = pose.theta - math.pi + np.arange(720) * (2.0 * math.pi / 720)
    with np.errstate(divide="ignore"):
        sides = [
            ((np.array((a, b)) - p) / d)
            for a, b, p, d in zip(
                low, high, (pose.x, pose.y), (np.cos(angles)[:, None], np.sin(angles)[:, None]), strict=True
            )
        ]
    enter = np.maximum(*(side.min(axis=1) for side in sides))
    leave = np.minimum(*(side.max(axis=1) for side in sides))
    ranges = np.where((enter < leave) & (enter > 0.0), enter, np.inf) + 0.005 * np.random.default_rng(
        int(10 * stamp)
    ).standard_normal(720)
    return LaserScan(stamp, -math.pi, 2.0 * math.pi / 720, 0.05, 8.0, ranges.astype(np.float32), Pose(0.0, 0.0))


@pytest.mark.parametrize("speed", [0.5, 1.5])
def test_a_box_that_no_map_shows_stands_while_the_robot_drives_round_it(tracker, speed):
    speeds = []
    for k in range(40):
        angle = speed * 0.1 * k / 2.0
        pose = Pose(2.0 * math.cos(angle), 2.0 * math.sin(angle), angle + math.pi / 2)
        tracks = tracker.update(box_scan(pose, (-0.6, -0.3), (0.6, 0.3), 0.1 * k), pose, 0.1 * k)
        speeds.append(np.hypot(*tracks.velocities.T).max() if len(tracks.ids) else 0.0)
    assert len(tracks.ids) >= 1
    assert max(speeds[15:]) < 0.15


def test_a_person_close_by_whose_middle_is_nearer_than_the_lidar_can_see_is_one(tracker, scan_of_discs):
    def seen(t):
        scan = scan_of_discs(Pose(0.0, 0.0), [(0.55, 0.0, PERSON)], t, noise=0.003, seed=round(10 * t))
        scan.ranges[scan.ranges < 0.27] = 0.0
        return scan

    tracks = [tracker.update(seen(0.1 * k), Pose(0.0, 0.0), 0.1 * k) for k in range(10)]
    assert [len(t.ids) for t in tracks[3:]] == [1] * 7


def test_a_person_alone_in_an_unknown_world_is_not_taken_for_it(tracker, scan_of_discs):
    tracker.reset(None)
    tracks = follow(tracker, scan_of_discs, lambda t: [(3.0 - 0.8 * t, 0.2, PERSON)], steps=25, beams=720)
    assert len(tracks.ids) == 1
    np.testing.assert_allclose(tracks.velocities, [(-0.8, 0.0)], atol=0.15)
