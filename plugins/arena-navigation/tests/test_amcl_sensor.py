import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arena_core import LaserScan, OccupancyGrid, Pose
from arena_kernels.distance import grid_distance
from arena_kernels.grids import stack_grids
from arena_navigation.amcl.beams import ExpectedWalls, predict_ranges, scan_layout, thin_scan, write_ends, write_least
from arena_navigation.amcl.directions import PlacedParticles
from arena_navigation.amcl.sensor import (
    BeamCount,
    Distances,
    EndpointLookup,
    LikelihoodField,
    match_endpoints,
    shell_distance,
    surface_distance,
    update_weights,
)

SURFACE, CELLS = Distances(True, True), Distances(False, False)
PROB = LikelihoodField(True, 0.8, 0.2, 0.1, 2.0, SURFACE, 0.5, 10.0)
ADDED = LikelihoodField(False, 0.95, 0.05, 0.2, 2.0, CELLS, 0.5, 10.0)


@pytest.fixture(scope="module")
def grid():
    data = np.zeros((40, 60), np.int8)
    data[[0, -1]] = data[:, [0, -1]] = 100
    data[10:15, 20:30] = 100
    return OccupancyGrid(data, 0.1, Pose(-1.0, 2.0, 0.4))


def scan(ranges, **fields):
    given = {
        "stamp": 0.0,
        "angle_min": -1.0,
        "angle_increment": 0.1,
        "range_min": 0.2,
        "range_max": 5.0,
        "mount": Pose(0.0, 0.0, 0.0),
    }
    return LaserScan(**{**given, **fields}, ranges=np.array(ranges, np.float32))


def beam_ends(seen, min_range, max_range, least=0.0):
    """Return where the beams of a scan end, (2, K), and the share that is left."""
    look = scan_layout(seen)
    look.least[:] = least
    kept, share = write_ends(seen.ranges, min_range, max_range, look)
    return look.ends[: 2 * kept].reshape(2, kept), share


def scores(grid, model, poses, ends):
    field = grid.derive(model)
    poses, ends = np.array(poses, float).T.copy(), np.array(ends, np.float32).reshape(2, -1)
    found, directions = np.empty(poses.shape[1]), np.stack((np.cos(poses[2]), np.sin(poses[2])))
    match_endpoints(
        PlacedParticles(poses, directions, poses.shape[1]),
        EndpointLookup(ends, field, np.empty(ends.shape[1], np.int32)),
        ends.shape[1],
        found,
    )
    return found


def likelihood(model, distance):
    return (
        model.z_hit * np.exp(-(np.minimum(distance, model.max_dist) ** 2) / (2 * model.sigma_hit**2))
        + model.z_rand / model.max_range
    )


@pytest.mark.parametrize("model", [PROB, ADDED])
def test_score_is_the_sum_over_the_beams_of_table_6_3(grid, model):
    random = np.random.default_rng(3)
    poses = random.uniform((1.0, 0.5, -3.0), (5.0, 3.5, 3.0), (20, 3))
    ends = random.uniform(-4.0, 4.0, (2, 13)).astype(np.float32)
    distance = grid.derive(surface_distance if model.distances.surface else grid_distance)
    for pose, found in zip(poses, scores(grid, model, poses, ends), strict=True):
        at = [Pose.of(pose).compose(Pose(*end)) for end in ends.T.tolist()]
        cells = [(math.floor(p.y / 0.1), math.floor(p.x / 0.1)) for p in at]
        away = np.array([distance[r, c] if 0 <= r < 40 and 0 <= c < 60 else 2.0 for r, c in cells])
        values = 0.5 * np.log(likelihood(model, away)) if model is PROB else likelihood(model, away) ** 3
        assert found == pytest.approx(values.sum(), rel=1e-5)


def test_distance_to_the_surface_is_signed_and_nought_on_it(grid):
    signed = surface_distance(grid)
    np.testing.assert_allclose(
        signed[12, 14:25], [0.55, 0.45, 0.35, 0.25, 0.15, 0.05, -0.05, -0.15, -0.25, -0.25, -0.25], atol=1e-6
    )
    assert (signed < 0.0).sum() == grid.occupied.sum()


def test_hollow_obstacles_are_those_cells_that_a_scan_can_have_seen(grid):
    distance = shell_distance(grid)
    outside = ~grid.occupied
    np.testing.assert_array_equal(distance[outside], grid.derive(grid_distance)[outside])
    assert distance[10, 25] == distance[14, 20] == 0.0
    assert distance[12, 25] == pytest.approx(0.2)  # the box is 5 cells deep
    assert (distance[1:-1, 1:-1] > 0.0).sum() == (~grid.occupied[1:-1, 1:-1]).sum() + 3 * 8


def test_deep_inside_a_hollow_obstacle_fits_no_beam(grid):
    hollow = LikelihoodField(False, 0.95, 0.05, 0.05, 2.0, Distances(False, True), 1.0, 10.0)
    solid = LikelihoodField(False, 0.95, 0.05, 0.05, 2.0, Distances(False, False), 1.0, 10.0)
    poses = [(1.05, 1.25, 0.0), (1.25, 1.25, 0.0)]  # the second one's beam ends 0.25 m inside
    outer, inner = scores(grid, hollow, poses, [[1.0], [0.0]])
    assert outer > 10.0 * inner
    outer, inner = scores(grid, solid, poses, [[1.0], [0.0]])
    assert outer == inner


def test_with_surfaces_the_best_fit_is_where_the_wall_begins(grid):
    offsets = np.linspace(-0.2, 0.2, 41)
    poses = np.stack((1.0 + offsets, np.full(41, 1.25), np.zeros(41)), axis=1)
    ends = [[1.0], [0.0]]  # the box begins at x = 2.0
    found = scores(grid, PROB, poses, ends)
    assert np.abs(np.average(offsets, weights=found == found.max())) < 0.011
    centred = scores(grid, ADDED, poses, ends)
    assert np.average(offsets, weights=centred == centred.max()) > 0.05


def test_beams_that_end_outside_the_map_count_as_far_from_everything(grid):
    outside = scores(grid, PROB, [(3.0, 2.0, 0.0)], [[50.0], [0.0]])
    assert outside[0] == pytest.approx(0.5 * math.log(likelihood(PROB, 2.0)))
    np.testing.assert_array_equal(scores(grid, PROB, [(3.0, 2.0, 0.0)] * 3, [[-50.0], [3.0]]), outside.repeat(3))


def test_products_are_normalised_without_running_out_of_small_numbers():
    weights, values = np.full(3, 1 / 3), np.array([-2000.0, -2001.0, -2003.0])
    update_weights(weights, 3, values, BeamCount(60, True))
    np.testing.assert_allclose(weights, np.exp((0.0, -1.0, -3.0)) / np.exp((0.0, -1.0, -3.0)).sum())


def test_added_cubes_weigh_as_one_plus_their_sum():
    weights = np.array([0.5, 0.25, 0.25])
    mean = update_weights(weights, 3, np.array([0.0, 1.0, 3.0]), BeamCount(10, False))
    np.testing.assert_allclose(weights, np.array([0.5, 0.5, 1.0]) / 2.0)
    assert mean == pytest.approx(0.1)


@settings(derandomize=True, deadline=None)
@given(st.lists(st.floats(0.0, 1.0), min_size=2, max_size=50), st.booleans(), st.integers(0, 100))
def test_weights_sum_to_one_and_keep_the_order_of_the_scores(values, product, beams):
    weights, values = np.full(len(values), 1 / len(values)), np.array(values)
    update_weights(weights, len(values), values, BeamCount(beams, product))
    assert weights.sum() == pytest.approx(1.0)
    assert (np.diff(weights[np.argsort(values, kind="stable")]) >= -1e-12).all()


def test_weights_count_from_one_update_to_the_next():
    weights = np.array([0.9, 0.1])
    update_weights(weights, 2, np.array([-1.0, -1.0]), BeamCount(5, True))
    np.testing.assert_allclose(weights, (0.9, 0.1))


def test_a_scan_without_hits_leaves_the_weights_alone(grid):
    weights = np.array([0.7, 0.3])
    found = scores(grid, PROB, [(1.0, 1.0, 0.0), (2.0, 2.0, 0.0)], np.empty((2, 0)))
    update_weights(weights, 2, found, BeamCount(0, True))
    np.testing.assert_allclose(weights, (0.7, 0.3))


@settings(derandomize=True, deadline=None)
@given(count=st.integers(1, 800), at_most=st.integers(1, 100))
def test_thinned_scan_has_evenly_spaced_beams_at_their_own_angles(count, at_most):
    whole = scan(np.arange(count))
    thin = thin_scan(whole, at_most)
    step = max(1, -(-count // at_most))
    assert 1 <= len(thin.ranges) <= at_most
    np.testing.assert_array_equal(thin.ranges, np.arange(0, count, step))
    assert thin.angle_increment == pytest.approx(step * whole.angle_increment)


def test_beams_end_where_range_angle_and_mount_say():
    mount = Pose(0.3, -0.1, 0.5)
    ends, _ = beam_ends(scan([1.0, 2.0, 3.0], angle_min=0.2, angle_increment=0.7, mount=mount), 0.2, 5.0)
    expected = [mount.compose(Pose(r * math.cos(a), r * math.sin(a))) for r, a in ((1.0, 0.2), (2.0, 0.9), (3.0, 1.6))]
    np.testing.assert_allclose(ends, [[p.x for p in expected], [p.y for p in expected]], rtol=1e-6)


def test_beams_that_hit_nothing_or_cannot_be_right_are_left_out():
    ends, share = beam_ends(scan([math.inf, math.nan, 0.1, 5.0, 4.9]), 0.2, 5.0)
    assert ends.shape == (2, 1)
    assert share == 1.0
    assert np.hypot(*ends[:, 0]) == pytest.approx(4.9)


def test_beams_that_end_in_front_of_the_map_are_left_out(grid):
    stack, _ = stack_grids([grid])
    pose = grid.origin.compose(Pose(1.0, 2.5, -0.5))
    whole = scan(np.ones(20), mount=Pose(0.1, 0.0, 0.3), range_max=20.0)
    sensor = pose.compose(whole.mount)
    walls = ExpectedWalls(stack, (sensor.x, sensor.y, sensor.theta), 0.5)
    expected = predict_ranges(whole, walls)
    assert np.isfinite(expected).all()
    write_least(walls, scan_layout(whole))
    np.testing.assert_array_equal(scan_layout(whole).least, expected - 0.5)
    seen = expected + 0.01
    seen[4:9] -= 0.6  # a person stands there
    seen[12] += 3.0  # a longer range is no sign of people
    ends, share = beam_ends(scan(seen, mount=whole.mount, range_max=20.0), 0.2, 20.0, expected - 0.5)
    assert share == 15 / 20
    kept = np.hypot(ends[0] - 0.1, ends[1])
    np.testing.assert_allclose(kept, np.delete(seen, slice(4, 9)), rtol=1e-5)


def test_predicted_ranges_are_where_the_map_is(grid):
    stack, _ = stack_grids([grid])
    sensor = grid.origin.compose(Pose(0.55, 1.25, 0.0))
    ranges = predict_ranges(
        scan(np.ones(1), angle_min=0.0), ExpectedWalls(stack, (sensor.x, sensor.y, sensor.theta), 0.5)
    )
    assert ranges[0] == pytest.approx(2.0 - 0.55, abs=1e-6)
