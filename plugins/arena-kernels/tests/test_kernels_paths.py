import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arena_kernels.paths import lengths_left, points_ahead, update_progress

COORDINATES = st.floats(-5.0, 5.0)
PATHS = st.lists(st.tuples(COORDINATES, COORDINATES), min_size=2, max_size=12)


def packed(*paths):
    poses = np.concatenate([np.column_stack((np.array(path, float), np.zeros(len(path)))) for path in paths])
    offsets = np.cumsum([0, *(len(path) for path in paths)])
    left = np.empty(len(poses))
    lengths_left(poses, offsets, left)
    return poses, offsets, left


def followed(paths, positions, reach, places):
    poses, offsets, left = packed(*paths)
    out, places = np.empty((len(paths), 2)), np.array(places)
    update_progress(
        poses, offsets, left, np.column_stack((np.array(positions, float), np.zeros(len(paths)))), reach, places, out
    )
    return places, out


def test_way_left_is_the_length_of_the_rest_of_each_path():
    _, _, left = packed([(0, 0), (3, 0), (3, 4)], [(1, 1), (1, 2)])
    assert left.tolist() == [7.0, 4.0, 0.0, 1.0, 0.0]


def test_robot_beside_a_segment_has_the_way_from_the_nearest_point():
    places, out = followed([[(0, 0), (2, 0), (4, 0), (4, 4)]], [(2.5, 0.3)], 10.0, [0])
    assert places.tolist() == [1]
    assert out[0] == pytest.approx((5.5, 0.3))


def test_place_does_not_leap_to_where_the_path_passes_near_itself():
    hairpin = [(x, 0.0) for x in range(11)] + [(x, 0.4) for x in range(10, -1, -1)]
    places, out = followed([hairpin], [(1.0, 0.35)], 1.0, [1])
    assert places[0] in (0, 1)
    assert out[0] == pytest.approx((19.4, 0.35))
    assert followed([hairpin], [(1.0, 0.35)], 100.0, [1])[1][0, 1] == pytest.approx(0.05)


@settings(derandomize=True, deadline=None)
@given(path=PATHS, x=COORDINATES, y=COORDINATES)
def test_with_unlimited_reach_no_point_of_the_path_is_nearer(path, x, y):
    places, out = followed([path], [(x, y)], 1e3, [0])
    points = np.array(path)
    samples = np.concatenate([a + np.linspace(0, 1, 50)[:, None] * (b - a) for a, b in pairwise(points)])
    assert out[0, 1] <= np.hypot(*(samples - (x, y)).T).min() + 1e-9
    assert 0 <= places[0] < len(path) - 1 or len(path) == 2
    assert -1e-9 <= out[0, 0] <= packed(path)[2][0] + 1e-9


@settings(derandomize=True, deadline=None)
@given(paths=st.lists(PATHS, min_size=2, max_size=4), x=COORDINATES, y=COORDINATES)
def test_robot_among_others_is_where_it_is_alone(paths, x, y):
    places, out = followed(paths, [(x, y)] * len(paths), 2.0, [0] * len(paths))
    for k, path in enumerate(paths):
        alone = followed([path], [(x, y)], 2.0, [0])
        assert places[k] == alone[0][0]
        assert (out[k] == alone[1][0]).all()


def test_points_ahead_are_spaced_along_the_path_and_end_with_it():
    poses, offsets, _ = packed([(0, 0), (1, 0), (2, 0), (2, 2)], [(0, 0), (0.5, 0)])
    points = np.empty((2, 4, 2))
    points_ahead(poses, offsets, np.array([(0.9, 0.5, 0.0), (0.0, 0.0, 0.0)]), 0.75, points)
    assert points[0] == pytest.approx(np.array([(1.75, 0), (2, 0.5), (2, 1.25), (2, 2)]))
    assert points[1] == pytest.approx(np.array([(0.5, 0)] * 4))


@settings(derandomize=True, deadline=None)
@given(path=PATHS, spacing=st.floats(0.05, 3.0), x=COORDINATES, y=COORDINATES)
def test_points_ahead_are_never_farther_apart_than_their_spacing(path, spacing, x, y):
    poses, offsets, _ = packed(path)
    points = np.empty((1, 6, 2))
    points_ahead(poses, offsets, np.array([(x, y, 0.0)]), spacing, points)
    steps = np.hypot(*np.diff(points[0], axis=0).T)
    assert (steps <= spacing + 1e-9).all()
    assert all(math.isfinite(v) for v in points.ravel())
