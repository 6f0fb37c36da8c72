import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arena_kernels.grids import stack_grids
from arena_kernels.raycast import cast_disc, cast_grid, cast_segments, make_beams, plain_dda, scan_grids

seeds = st.integers(0, 2**32 - 1)
ROUND = make_beams(-np.pi, 2 * np.pi / 90, 90, 4.0)


def scan_both_ways(stack, g, pose, beams):
    leaping, plain = np.empty(len(beams.cosines), np.float32), np.empty(len(beams.cosines), np.float32)
    cast_grid(stack, g, pose, beams, leaping)
    plain_dda(stack, g, pose, beams, plain)
    return leaping, plain


@given(seeds)
@settings(derandomize=True, deadline=None)
def test_scan_equals_plain_dda_on_any_grid_from_anywhere(random_grid, seed):
    random = np.random.default_rng(seed)
    grid = random_grid(seed)
    stack, _ = stack_grids([random_grid(seed + 1), grid])
    for _ in range(10):
        pose = (*grid.positions(random.uniform(-15.0, 65.0, 2)), random.uniform(-4.0, 4.0))
        leaping, plain = scan_both_ways(stack, 1, pose, ROUND)
        np.testing.assert_array_equal(np.isinf(leaping), np.isinf(plain))
        np.testing.assert_allclose(leaping, plain, atol=1e-3)


@pytest.mark.parametrize("beams", [1, 31, 32, 33, 100])
def test_a_beam_sees_the_same_among_however_many_others(random_grid, beams):
    stack, _ = stack_grids([random_grid(7)])
    pose, step = (5.3, 4.1, 0.4), 2 * np.pi / 100
    every, some = np.empty(100, np.float32), np.empty(beams, np.float32)
    cast_grid(stack, 0, pose, make_beams(0.0, step, 100, 9.0), every)
    cast_grid(stack, 0, pose, make_beams(0.0, step, beams, 9.0), some)
    assert np.array_equal(some, every[:beams])


def test_a_pose_that_is_no_number_sees_nothing(random_grid):
    stack, _ = stack_grids([random_grid(7)])
    for pose in ((np.nan, 4.0, 0.0), (5.0, np.nan, 0.0), (5.0, 4.0, np.nan), (np.inf, 4.0, 0.0)):
        ranges = np.empty(90, np.float32)
        cast_grid(stack, 0, pose, ROUND, ranges)
        assert not np.isfinite(ranges).any()


@given(seeds, st.sampled_from([0.0, np.pi / 4]))
@settings(derandomize=True, deadline=None)
def test_scan_along_cell_borders_and_diagonals_equals_plain_dda(make_grid, seed, yaw):
    random = np.random.default_rng(seed)
    stack, _ = stack_grids([make_grid(random.random((12, 12)) < 0.2, 0.5)])
    x, y = random.integers(0, 24, 2) * 0.25
    beside = 0.1 if yaw else 0.0  # a diagonal through a corner meets whichever cell rounding prefers
    leaping, plain = scan_both_ways(stack, 0, (x + beside, y, yaw), make_beams(0.0, np.pi / 2, 4, 20.0))
    np.testing.assert_allclose(leaping, plain, atol=1e-3)


def test_scan_of_a_large_empty_hall_sees_its_walls(make_grid):
    occupied = np.ones((700, 900))
    occupied[1:-1, 1:-1] = 0
    stack, _ = stack_grids([make_grid(occupied, 0.1)])
    ranges = np.empty(4, np.float32)
    cast_grid(stack, 0, (30.0, 20.0, 0.0), make_beams(0.0, np.pi / 2, 4, 100.0), ranges)
    assert ranges.tolist() == pytest.approx([59.9, 49.9, 29.9, 19.9], abs=1e-4)


def test_beams_that_hit_nothing_read_infinity(make_grid):
    stack, _ = stack_grids([make_grid(np.zeros((10, 10)))])
    leaping, _ = scan_both_ways(stack, 0, (0.2, 0.2, 0.0), ROUND)
    assert np.isinf(leaping).all()


def test_sensor_inside_a_wall_reads_zero(make_grid):
    stack, _ = stack_grids([make_grid(np.ones((3, 3)))])
    leaping, plain = scan_both_ways(stack, 0, (0.07, 0.07, 0.3), ROUND)
    assert not leaping.any()
    assert not plain.any()


def test_scans_of_many_worlds_are_those_of_each(random_grid):
    grids = [random_grid(seed) for seed in range(5)]
    stack, grid_of = stack_grids([*grids, grids[0]])
    sensors = np.array([(*grid.positions(np.array(grid.occupied.shape[::-1]) / 2), 0.4) for grid in [*grids, grids[0]]])
    ranges = np.empty((6, 90), np.float32)
    scan_grids(stack, grid_of, sensors, ROUND, ranges)
    for k in range(6):
        np.testing.assert_array_equal(ranges[k], scan_both_ways(stack, grid_of[k], sensors[k], ROUND)[0])


def nearest_circle_hit(pose, beams, centres, radii):
    angles = pose[2] + beams.angle_min + beams.angle_increment * np.arange(len(beams.cosines))
    rays = np.stack((np.cos(angles), np.sin(angles)), axis=1)
    to_centre = centres[:, None] - np.array(pose[:2])
    along = (to_centre * rays).sum(axis=2)
    chord = radii[:, None] ** 2 - ((to_centre**2).sum(axis=2) - along**2)
    hit = along - np.sqrt(np.where(chord >= 0.0, chord, np.nan))
    hit[~((hit >= 0.0) & (hit < beams.range_max))] = np.inf
    return hit.min(axis=0)


@given(seeds, st.floats(-6.28, 3.14), st.floats(0.2, 1.0))
@settings(derandomize=True, deadline=None)
def test_discs_shorten_exactly_the_beams_that_meet_them(seed, angle_min, field):
    random = np.random.default_rng(seed)
    beams = make_beams(angle_min, field * 2 * np.pi / 120, 120, 5.0)
    pose = tuple(random.uniform(-4.0, 4.0, 3))
    radii = random.uniform(0.05, 0.5, 6)
    centres = random.uniform(-5.0, 5.0, (6, 2))
    outside = np.hypot(*(centres - pose[:2]).T) > radii
    ranges = np.full(120, np.inf, np.float32)
    for (x, y), radius in zip(centres[outside], radii[outside], strict=True):
        cast_disc(pose, beams, (x, y, radius), ranges)
    expected = nearest_circle_hit(pose, beams, centres[outside], radii[outside])
    np.testing.assert_allclose(ranges, expected, atol=2e-4)


def test_sensor_inside_a_disc_reads_zero():
    ranges = np.full(90, np.inf, np.float32)
    cast_disc((0.0, 0.0, 0.0), ROUND, (0.1, 0.0, 0.3), ranges)
    assert not ranges.any()


def test_a_disc_that_is_nowhere_is_not_seen():
    ranges = np.full(90, np.inf, np.float32)
    cast_disc((0.0, 0.0, 0.0), ROUND, (np.nan, np.nan, 0.3), ranges)
    assert np.isinf(ranges).all()


@given(seeds)
@settings(derandomize=True, deadline=None)
def test_segments_shorten_exactly_the_beams_that_cross_them(seed):
    random = np.random.default_rng(seed)
    pose = tuple(random.uniform(-3.0, 3.0, 3))
    segments = random.uniform(-3.0, 3.0, (5, 2, 2))
    ranges = np.full(90, np.inf, np.float32)
    cast_segments(pose, ROUND, segments, ranges)
    angles = pose[2] + ROUND.angle_min + ROUND.angle_increment * np.arange(90)
    for i, angle in enumerate(angles):
        hits = [np.inf]
        for (ax, ay), (bx, by) in segments:
            matrix = np.array([[np.cos(angle), ax - bx], [np.sin(angle), ay - by]])
            t, share = np.linalg.solve(matrix, (ax - pose[0], ay - pose[1]))
            if t >= 0.0 and 0.0 <= share <= 1.0 and t < 4.0:
                hits.append(t)
        assert ranges[i] == pytest.approx(min(hits), abs=1e-4)


def test_no_beam_slips_between_the_sides_of_a_polygon():
    corners = np.array([[1.0, -1.0], [1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0]])
    beams = make_beams(0.0, np.pi / 4, 8, 5.0)
    ranges = np.full(8, np.inf, np.float32)
    cast_segments((0.0, 0.0, 0.0), beams, np.stack((corners, np.roll(corners, -1, axis=0)), axis=1), ranges)
    assert ranges.tolist() == pytest.approx([1.0, 2**0.5] * 4, abs=1e-6)
