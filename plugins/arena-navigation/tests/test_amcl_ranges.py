"""The beam model: what it says of one range, and that it expects what the ray caster sees."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arena_core import LaserScan, OccupancyGrid, Pose
from arena_kernels.grids import stack_grids
from arena_kernels.raycast import make_beams, scan_grids
from arena_navigation.amcl.beams import measured_ranges
from arena_navigation.amcl.directions import PlacedParticles
from arena_navigation.amcl.laser import own_frame
from arena_navigation.amcl.ranges import Mixture, View, match_ranges, range_likelihood

ROS = Mixture(0.95, 0.1, 0.05, 0.05, 0.2, 0.1)
BOOK = Mixture(0.6, 0.2, 0.1, 0.1, 0.1, 2.0)
RANGE_MAX = 8.0
MOUNT = Pose(0.15, -0.05, 0.2)
ORIGIN = Pose(-3.0, 5.0, 0.8)


@pytest.fixture(scope="module")
def room():
    data = np.zeros((80, 120), np.int8)
    data[[0, -1]] = data[:, [0, -1]] = 100
    data[1:30, 70:74] = data[60:72, 20:40] = data[35:42, 100:110] = 100
    return OccupancyGrid(data, 0.05, ORIGIN)


RAYS = make_beams(-2.0, 0.1, 41, RANGE_MAX)


def seen(room, pose):
    """Return the ranges (41,) from ``pose`` in the grid's frame."""
    ranges = np.empty((1, 41), np.float32)
    scan_grids(*stack_grids([room]), ORIGIN.compose(pose).compose(MOUNT).array()[None], RAYS, ranges)
    return np.minimum(ranges[0], np.float32(RANGE_MAX))


def scores(room, poses, ranges, mixture=ROS):
    poses = np.array(poses, float).T.copy()
    found, directions = np.empty(poses.shape[1]), np.stack((np.cos(poses[2]), np.sin(poses[2])))
    view = View(own_frame(room), RAYS, (MOUNT.x, MOUNT.y, MOUNT.theta), mixture, np.empty(41, np.float32))
    used = match_ranges(PlacedParticles(poses, directions, poses.shape[1]), np.asarray(ranges, np.float32), view, found)
    return found, used


@pytest.mark.parametrize("mixture", [ROS, BOOK])
@pytest.mark.parametrize("expected", [2.0, 4.0, RANGE_MAX])
def test_parts_of_the_mixture_weigh_what_they_should(mixture, expected):
    ranges = np.linspace(0.0, RANGE_MAX, 40_001)[:-1]
    inside = np.mean([range_likelihood(r, expected, RANGE_MAX, mixture) for r in ranges]) * RANGE_MAX
    hit = mixture.z_hit * mixture.sigma_hit * math.sqrt(2 * math.pi) * (0.5 if expected == RANGE_MAX else 1.0)
    short = mixture.z_short * (1.0 - math.exp(-mixture.lambda_short * expected))
    assert inside == pytest.approx(hit + short + mixture.z_rand, abs=2e-3)
    nothing = range_likelihood(RANGE_MAX, expected, RANGE_MAX, mixture)
    assert nothing == pytest.approx(mixture.z_max + (mixture.z_hit if expected == RANGE_MAX else 0.0), abs=1e-6)


@settings(derandomize=True, deadline=None)
@given(expected=st.floats(0.5, 7.0), off=st.floats(0.0, 0.4), more=st.floats(0.001, 0.5))
def test_the_farther_behind_the_map_the_less_likely(expected, off, more):
    near, far = (range_likelihood(expected + d, expected, RANGE_MAX, BOOK) for d in (off, off + more))
    assert far <= near


def test_in_front_of_the_map_is_likelier_than_behind_it():
    for off in (0.3, 0.8, 1.5):
        front, behind = (range_likelihood(4.0 + d, 4.0, RANGE_MAX, BOOK) for d in (-off, off))
        assert front > behind


@settings(derandomize=True, deadline=None, max_examples=50)
@given(x=st.floats(0.2, 2.8), y=st.floats(0.2, 1.2), theta=st.floats(-3.1, 3.1))
def test_expected_ranges_are_those_of_the_ray_caster(x, y, theta):
    data = np.zeros((80, 120), np.int8)
    data[[0, -1]] = data[:, [0, -1]] = 100
    room = OccupancyGrid(data, 0.05, ORIGIN)
    measured = seen(room, Pose(x, y, theta))
    exact = Mixture(1.0, 0.0, 0.0, 0.0, 0.002, 0.1)
    found, used = scores(room, [(x, y, theta)], measured, exact)
    assert used == 41
    assert found[0] == pytest.approx(41.0, abs=0.01)


def test_score_is_the_sum_of_cubes_over_the_beams(room):
    poses = [(1.0, 1.5, 0.2), (2.0, 2.0, -2.0), (4.2, 2.8, 3.0)]
    measured = seen(room, Pose(1.05, 1.4, 0.25))
    measured[5:9] = np.nan
    found, used = scores(room, poses, measured)
    assert used == 37
    for pose, score in zip(poses, found, strict=True):
        expected = seen(room, Pose(*pose))
        likelihoods = [
            range_likelihood(m, e, RANGE_MAX, ROS) for m, e in zip(measured, expected, strict=True) if not math.isnan(m)
        ]
        assert score == pytest.approx(sum(p**3 for p in likelihoods), rel=1e-4)


def test_the_true_pose_fits_best(room):
    true = (1.2, 1.7, -1.2)
    others = [(1.2 + dx, 1.7 + dy, -1.2 + turn) for dx in (-0.3, 0.3) for dy in (-0.3, 0.3) for turn in (-0.2, 0.2)]
    found, _ = scores(room, [true, *others], seen(room, Pose(*true)))
    assert found[0] > 1.3 * found[1:].max()


def test_a_batch_of_particles_equals_one_at_a_time(room):
    random = np.random.default_rng(3)
    poses, measured = random.uniform((0.3, 0.3, -3.0), (5.5, 3.5, 3.0), (25, 3)), seen(room, Pose(1.0, 1.0, 0.0))
    together, _ = scores(room, poses, measured)
    np.testing.assert_array_equal(together, [scores(room, [pose], measured)[0][0] for pose in poses])


def test_ranges_are_cut_at_the_greatest_and_left_out_where_they_cannot_be_right():
    ranges = np.array([math.inf, math.nan, 0.05, 9.0, 3.0, 1.0], np.float32)
    scan = LaserScan(0.0, 0.0, 0.1, 0.1, 10.0, ranges, MOUNT)
    found, share = measured_ranges(scan, 0.1, 8.0, np.array([0, 0, 0, 9.5, 0, 2.0], np.float32))
    np.testing.assert_array_equal(found, [8.0, math.nan, math.nan, 8.0, 3.0, math.nan])
    assert share == 3 / 4
