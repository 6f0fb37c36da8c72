"""Paths against paths and ends against ends: by hand, and against the recursion as it was published."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arena_metrics.pooling.path_similarity import discrete_frechet, mean_frechet, standard_distance


def recursive(first, second):
    """The coupling measure of Eiter and Mannila, entry by entry."""
    table = np.full((len(first), len(second)), math.inf)
    for i, p in enumerate(first):
        for j, q in enumerate(second):
            before = [
                table[i - 1, j] if i else math.inf,
                table[i, j - 1] if j else math.inf,
                table[i - 1, j - 1] if i and j else math.inf,
            ]
            table[i, j] = max(math.dist(p, q), min(before) if i or j else 0.0)
    return table[-1, -1]


def line(*points):
    return np.array(points, dtype=float)


def test_paths_side_by_side_are_as_far_apart_as_they_lie():
    x = np.linspace(0.0, 5.0, 51)
    assert discrete_frechet(np.column_stack((x, 0 * x)), np.column_stack((x, 0 * x + 0.75))) == pytest.approx(0.75)


def test_a_path_is_no_distance_from_itself_and_of_its_length_from_its_begin():
    path = line((0, 0), (1, 0), (2, 1))
    assert discrete_frechet(path, path) == 0.0
    assert discrete_frechet(path, path[:1]) == pytest.approx(math.hypot(2.0, 1.0))


def test_a_way_there_and_back_is_not_the_way_there():
    """The leash must reach back: Hausdorff's distance of these two would be 0.5."""
    there = line((0, 0), (1, 0), (2, 0), (3, 0))
    swerving = line((0, 0), (1, 0), (2, 0), (1, 0), (0, 0), (1, 0), (2, 0), (3, 0))
    assert discrete_frechet(there, swerving) == pytest.approx(1.0)


def test_a_detour_counts_at_its_furthest():
    straight = line(*[(x, 0) for x in range(9)])
    assert discrete_frechet(straight, line((0, 0), (2, 0), (4, 3), (6, 0), (8, 0))) == pytest.approx(3.0)


paths = st.lists(st.tuples(*[st.floats(-5, 5)] * 2), min_size=1, max_size=14).map(lambda points: np.array(points))


@settings(derandomize=True, deadline=None, max_examples=200)
@given(paths, paths)
def test_distance_is_that_of_the_recursion_symmetric_and_bounded(first, second):
    found = discrete_frechet(first, second)
    assert found == pytest.approx(recursive(first, second))
    assert found == pytest.approx(discrete_frechet(second, first))
    assert found == pytest.approx(discrete_frechet(first[::-1], second[::-1]))
    assert found >= max(math.dist(first[0], second[0]), math.dist(first[-1], second[-1])) - 1e-12


@settings(derandomize=True, deadline=None, max_examples=100)
@given(paths, paths, paths)
def test_distance_holds_the_triangle_inequality(first, second, third):
    assert discrete_frechet(first, third) <= discrete_frechet(first, second) + discrete_frechet(second, third) + 1e-9


def test_mean_over_pairs_and_none_for_a_single_path():
    paths = [line((0, y), (1, y)) for y in (0.0, 1.0, 3.0)]
    assert mean_frechet(paths) == pytest.approx((1.0 + 3.0 + 2.0) / 3)
    assert math.isnan(mean_frechet(paths[:1]))


def test_scatter_is_the_standard_distance():
    assert standard_distance(line((1, 1), (1, 1))) == 0.0
    assert standard_distance(line((0, 0), (2, 0))) == pytest.approx(math.sqrt(2.0))
    assert standard_distance(line((0, 0), (2, 0), (0, 2), (2, 2))) == pytest.approx(math.sqrt(2 * 4 / 3))
    assert math.isnan(standard_distance(line((1, 1))))


def test_scatter_of_a_normal_cloud_is_its_spread():
    cloud = np.random.default_rng(0).normal(0.0, 0.3, (20000, 2))
    assert standard_distance(cloud) == pytest.approx(0.3 * math.sqrt(2.0), rel=0.02)
