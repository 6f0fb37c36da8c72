import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from arena_core import LaserScan, Pose
from arena_navigation.local_map.marks import NEVER, MarkedCells, MarkingRange, PlacedScan, update_marks

RESOLUTION = 0.05
SIZE = 60
CORNER = (-30, -30)
REACH = MarkingRange(1.2, 1.3, 0.15, math.inf)
Marks = NDArray[np.float32]


def blank() -> Marks:
    return np.full((SIZE, SIZE), NEVER, np.float32)


def scan_of(
    ranges: NDArray[np.float32], mount: Pose | None = None, angle_min: float = -math.pi, stamp: float = 1.0
) -> LaserScan:
    return LaserScan(
        stamp, angle_min, 2.0 * math.pi / len(ranges), 0.1, 8.0, ranges.astype(np.float32), mount or Pose(0.0, 0.0)
    )


def one_beam(range_: float, beam: int = 180, stamp: float = 1.0) -> LaserScan:
    """A scan of 360 beams that saw nothing at all but along one of them, by default straight ahead."""
    ranges = np.full(360, np.nan, np.float32)
    ranges[beam] = range_
    return scan_of(ranges, stamp=stamp)


def seen(marks: Marks, scan: LaserScan, pose: Pose, reach: MarkingRange = REACH) -> Marks:
    after = marks.copy()
    update_marks(MarkedCells(after, *CORNER, RESOLUTION), PlacedScan.of(scan, pose), reach)
    return after


def centres() -> NDArray[np.float64]:
    index = (np.arange(SIZE) + CORNER[0] + 0.5) * RESOLUTION
    return np.stack(np.meshgrid(index, index), axis=-1)


@settings(derandomize=True, deadline=None, max_examples=15)
@given(st.integers(0, 10**6))
def test_marks_are_cleared_exactly_where_a_beam_passes_the_middle_of_their_cell(seed: int) -> None:
    random = np.random.default_rng(seed)
    marks = np.where(random.random((SIZE, SIZE)) < 0.2, 0.5, NEVER).astype(np.float32)
    ranges = random.choice((0.05, 0.4, 0.9, 1.25, 5.0, np.inf, np.nan), random.integers(20, 200)).astype(np.float32)
    pose = Pose(*random.uniform(-0.3, 0.3, 2), random.uniform(-4.0, 4.0))
    mount = Pose(*random.uniform(-0.1, 0.1, 2), random.uniform(-3.0, 3.0))
    scan = scan_of(ranges, mount, random.uniform(-3.2, 0.5))
    sensor = pose.compose(mount)
    away = centres() - (sensor.x, sensor.y)
    directions = sensor.theta + scan.angle_min + scan.angle_increment * np.arange(len(ranges))
    units = np.stack((np.cos(directions), np.sin(directions)))
    along, beside = away @ units, np.abs(away @ np.stack((-units[1], units[0])))
    behind = (np.hypot(*away.transpose(2, 0, 1)) + RESOLUTION / 2)[..., None]
    passed = ((along > 0.0) & (beside <= RESOLUTION / 2) & (np.minimum(ranges, 1.3) >= behind)).any(axis=-1)
    beneath = np.hypot(*(centres() - (pose.x, pose.y)).transpose(2, 0, 1)) < REACH.body
    on_sensor = np.hypot(*away.transpose(2, 0, 1)) <= RESOLUTION / 2
    close = np.abs(beside - RESOLUTION / 2).min(axis=-1) < 1e-9
    after = seen(marks, scan, pose)
    expected = (marks > NEVER) & ~(passed & ~on_sensor) & ~beneath
    assert ((after > NEVER) == (expected | (after == 1.0)))[~close].all()


@settings(derandomize=True, deadline=None, max_examples=40)
@given(st.integers(0, 10**6))
def test_every_hit_within_range_is_marked_and_nothing_else(seed: int) -> None:
    random = np.random.default_rng(seed)
    ranges = random.uniform(0.0, 2.0, 90).astype(np.float32)
    pose = Pose(*random.uniform(-0.2, 0.2, 2), random.uniform(-4.0, 4.0))
    directions = pose.theta - math.pi + 2.0 * math.pi / 90 * np.arange(90)
    ends = np.array((pose.x, pose.y)) + (ranges[:, None] + RESOLUTION / 2) * np.stack(
        (np.cos(directions), np.sin(directions)), axis=1
    )
    counts = (ranges >= 0.15) & (ranges <= 1.2)
    cells = np.floor(ends[counts] / RESOLUTION).astype(int)[:, ::-1] - CORNER
    expected = np.zeros((SIZE, SIZE), bool)
    expected[cells[:, 0], cells[:, 1]] = True
    assert ((seen(blank(), scan_of(ranges), pose) == 1.0) == expected).all()


def test_a_mark_behind_what_is_hit_now_stays() -> None:
    marks = seen(blank(), one_beam(1.0), Pose(0.0, 0.0))
    assert (marks > NEVER).sum() == 1
    assert (seen(marks, one_beam(0.5), Pose(0.0, 0.0)) > NEVER).sum() == 2


def test_a_mark_is_cleared_once_the_beam_goes_on_behind_it() -> None:
    marks = seen(blank(), one_beam(0.5), Pose(0.0, 0.0))
    assert (seen(marks, one_beam(np.inf), Pose(0.0, 0.0)) == NEVER).all()
    after = seen(marks, one_beam(1.0), Pose(0.0, 0.0))
    assert np.argwhere(after > NEVER).tolist() == [[30, 50]]


def test_noise_of_a_centimetre_neither_clears_nor_thickens_a_wall_that_begins_with_a_cell() -> None:
    marks = blank()
    for k in range(20):
        marks = seen(marks, one_beam(0.5 + 0.01 * (-1) ** k), Pose(0.0, 0.0))
        assert np.argwhere(marks > NEVER).tolist() == [[30, 40]]


def test_returns_of_the_robot_itself_do_not_count() -> None:
    assert (seen(blank(), one_beam(0.14), Pose(0.0, 0.0)) == NEVER).all()


def test_marks_beneath_the_robot_go() -> None:
    marks = seen(blank(), one_beam(0.5), Pose(0.0, 0.0))
    assert (seen(marks, one_beam(np.nan), Pose(0.45, 0.0)) == NEVER).all()


def test_an_old_mark_is_forgotten_and_a_fresh_one_is_not() -> None:
    reach = REACH._replace(forget_after=2.0)
    marks = seen(blank(), one_beam(0.5, 180, 1.0), Pose(0.0, 0.0), reach)
    marks = seen(marks, one_beam(0.5, 90, 2.5), Pose(0.0, 0.0), reach)
    assert (marks > NEVER).sum() == 2
    assert np.argwhere(seen(marks, one_beam(np.nan, stamp=3.1), Pose(0.0, 0.0), reach) > NEVER).tolist() == [[19, 30]]


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf, 0.0, 0.05, 9.0])
def test_ranges_that_are_none_mark_nothing(value: float) -> None:
    assert (seen(blank(), scan_of(np.full(360, value, np.float32)), Pose(0.0, 0.0)) == NEVER).all()


def test_the_sensor_may_sit_anywhere_on_the_robot() -> None:
    mount = Pose(0.2, -0.1, math.pi / 2)
    ranges = np.full(4, np.nan, np.float32)
    ranges[2] = 0.5  # straight ahead of the sensor
    marks = seen(blank(), scan_of(ranges, mount), Pose(0.1, 0.31, -math.pi / 2))
    # sensor at (0.1, 0.31) + (-0.1, -0.2) = (0.0, 0.11), looking along x
    assert np.argwhere(marks > NEVER).tolist() == [[32, 40]]
