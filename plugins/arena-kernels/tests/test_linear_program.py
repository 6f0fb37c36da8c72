"""Best velocities under half-planes, worked out by hand: on a line, in a corner, at full speed, and the safest."""

import math

import numpy as np
import pytest

from arena_kernels.half_planes import put_bound
from arena_kernels.linear_program import Wish, nearest_allowed, nearest_on_line, safest_velocity, write_bisectors


def lines_of(*bounds):
    """Return half-planes of velocities whose part along a direction (rad) is at most so much."""
    lines = np.zeros((len(bounds), 4))
    for row, (angle, bound) in enumerate(bounds):
        put_bound(lines, row, math.cos(angle), math.sin(angle), bound)
    return lines


UP, LEFT, DOWN = 0.5 * math.pi, math.pi, -0.5 * math.pi


def nearest(x, y, *bounds, speed=1.0, by_direction=False):
    kept, vx, vy = nearest_allowed(lines_of(*bounds), len(bounds), speed, Wish((x, y), by_direction))
    return kept, pytest.approx(vx, abs=1e-9), pytest.approx(vy, abs=1e-9)


def test_a_wish_that_is_allowed_is_kept():
    assert nearest(0.3, 0.2, (0.0, 0.5), (UP, 0.5)) == (2, 0.3, 0.2)


def test_a_wish_too_fast_is_cut_and_one_by_direction_is_as_fast_as_may_be():
    assert nearest(3.0, 4.0) == (0, 0.6, 0.8)
    assert nearest(3.0, 4.0, speed=2.0) == (0, 1.2, 1.6)
    assert nearest(0.6, 0.8, speed=2.0, by_direction=True) == (0, 1.2, 1.6)


def test_a_forbidden_wish_becomes_the_nearest_one_on_the_line():
    assert nearest(0.9, 0.2, (0.0, 0.5)) == (1, 0.5, 0.2)
    assert nearest(0.9, -0.2, (0.0, 0.5)) == (1, 0.5, -0.2)
    assert nearest(0.6, 0.6, (0.25 * math.pi, 0.5)) == (1, math.sqrt(0.125), math.sqrt(0.125))


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_on_a_line_the_circle_of_speed_ends_it(side):
    assert nearest(0.99, side * 0.14, (0.0, 0.8), (-side * UP, -0.5)) == (2, 0.8, side * 0.5)
    _, _, y = nearest_on_line(lines_of((0.0, 0.8)), 0, 1.0, Wish((0.0, side), True))
    assert y == pytest.approx(side * 0.6)
    _, x, y = nearest_on_line(lines_of((0.0, 0.8)), 0, 1.0, Wish((9.0, side * 9.0), False))
    assert (x, y) == pytest.approx((0.8, side * 0.6))


def test_two_lines_leave_their_corner():
    assert nearest(0.7, 0.7, (0.0, 0.5), (UP, 0.25)) == (2, 0.5, 0.25)
    assert nearest(0.7, 0.7, (UP, 0.25), (0.0, 0.5)) == (2, 0.5, 0.25)
    assert nearest(0.7, -0.7, (0.0, 0.5), (DOWN, 0.25)) == (2, 0.5, -0.25)


def test_a_line_beyond_the_circle_cannot_be_kept():
    assert nearest(0.5, 0.0, (LEFT, -1.01))[0] == 0
    assert nearest(0.5, 0.0, (LEFT, -0.99))[0] == 1
    assert nearest(0.5, 0.2, (0.0, 0.9), (LEFT, -1.01)) == (1, 0.5, 0.2), "the best of those before"


def test_of_parallel_lines_the_narrower_counts_and_opposite_ones_may_leave_nothing():
    assert nearest(0.9, 0.1, (0.0, 0.6), (0.0, 0.4)) == (2, 0.4, 0.1)
    assert nearest(0.9, 0.1, (LEFT, -0.2), (0.0, 0.4)) == (2, 0.4, 0.1)
    assert nearest(0.1, 0.1, (0.0, 0.2), (LEFT, -0.4))[0] == 1


def test_three_lines_that_leave_no_place_fail_at_the_third():
    assert nearest(0.0, 0.0, (UP, -0.3), (UP + 2.1, -0.3), (UP - 2.1, -0.3))[0] == 2


def safest(*bounds, hard=0, failed=1, best=(0.0, 0.0)):
    lines = lines_of(*bounds)
    found = safest_velocity(lines, hard, len(bounds), failed, 1.0, best, np.zeros((len(bounds) + 1, 4)))
    return pytest.approx(found[0], abs=1e-9), pytest.approx(found[1], abs=1e-9)


def test_between_opposite_lines_both_are_broken_alike():
    x, _ = safest((0.0, -0.3), (LEFT, -0.5), best=(-0.3, 0.0))
    assert x == 0.1, "0.4 m/s beyond each"


def test_between_three_lines_all_are_broken_alike():
    found = safest((UP, -0.3), (UP + 2.0 * math.pi / 3.0, -0.3), (UP - 2.0 * math.pi / 3.0, -0.3), failed=1)
    assert found == (0.0, 0.0)


def test_hard_lines_are_kept_while_the_others_are_broken():
    x, _ = safest((0.0, -0.3), (LEFT, -0.5), hard=1, best=(-0.3, 0.0))
    assert x == -0.3


def test_bisectors_are_where_two_lines_are_broken_alike():
    lines, scratch = lines_of((0.0, 0.5), (UP, 0.25), (0.0, 0.1), (LEFT, -0.3)), np.zeros((5, 4))
    assert write_bisectors(lines, 0, 1, scratch) == 1
    assert scratch[0, :2] == pytest.approx((0.5, 0.25)), "through the corner"
    assert abs(scratch[0, 2:]) == pytest.approx((math.sqrt(0.5), math.sqrt(0.5)))
    assert write_bisectors(lines, 1, 2, scratch) == 2, "the hard one, and one with the line across"
    assert scratch[0] == pytest.approx(lines[0])
    assert write_bisectors(lines, 0, 2, scratch) == 1, "none between lines that face one way"
    assert write_bisectors(lines, 2, 3, scratch) == 3
    assert scratch[2, 0] == pytest.approx(0.2), "half way between lines that face each other"


@pytest.mark.parametrize("seed", range(12))
def test_no_velocity_on_a_fine_grid_is_nearer_or_safer(seed):
    random = np.random.default_rng(seed)
    bounds = list(zip(random.uniform(-3.0, 3.0, 4), random.uniform(-0.3, 0.6, 4), strict=True))
    wish, lines = random.uniform(-0.7, 0.7, 2), lines_of(*bounds)
    kept, x, y = nearest_allowed(lines, 4, 1.0, Wish((wish[0], wish[1]), False))
    vx, vy = np.meshgrid(np.linspace(-1.0, 1.0, 201), np.linspace(-1.0, 1.0, 201))
    broken = np.max([math.cos(a) * vx + math.sin(a) * vy - b for a, b in bounds], axis=0)
    broken[np.hypot(vx, vy) > 1.0] = np.inf
    if kept == 4:
        allowed = broken <= 0.0
        least = np.hypot(vx - wish[0], vy - wish[1])[allowed].min() if allowed.any() else np.inf
        assert np.hypot(x - wish[0], y - wish[1]) <= least + 1e-9
        assert max(math.cos(a) * x + math.sin(a) * y - b for a, b in bounds) < 1e-9
    else:
        x, y = safest_velocity(lines, 0, 4, kept, 1.0, (x, y), np.zeros((5, 4)))
        assert max(math.cos(a) * x + math.sin(a) * y - b for a, b in bounds) <= broken.min() + 1e-6
