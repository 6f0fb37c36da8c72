import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import linprog

from arena_kernels.half_planes import line_violation, put_bound
from arena_kernels.linear_program import Wish, nearest_allowed, safest_velocity
from arena_orca.step import best_velocity

SPEED = 1.5
SEEDS = st.integers(0, 2**32 - 1)


def random_lines(seed, count, least=-0.3):
    generator = np.random.default_rng(seed)
    lines = np.empty((count, 4))
    for row, (angle, bound) in enumerate(
        zip(generator.uniform(0.0, 2.0 * math.pi, count), generator.uniform(least, 1.5, count), strict=True)
    ):
        put_bound(lines, row, math.cos(angle), math.sin(angle), bound)
    return lines, tuple(generator.uniform(-2.0, 2.0, 2))


def normals_and_bounds(lines):
    normals = np.column_stack((lines[:, 3], -lines[:, 2]))
    return normals, (normals * lines[:, :2]).sum(axis=1)


def exact_nearest(lines, wish):
    """Return the nearest allowed velocity, found among the wish, its projections and all corners of lines
    and circle; None if none is.
    """
    wish = np.array(wish)
    normals, bounds = normals_and_bounds(lines)
    candidates = [wish, wish * SPEED / max(np.hypot(*wish), 1e-12)]
    for i, (n, b) in enumerate(zip(normals, bounds, strict=True)):
        candidates.append(wish - (n @ wish - b) * n)
        half = SPEED**2 - b * b
        if half >= 0.0:
            candidates += [n * b + sign * math.sqrt(half) * np.array((-n[1], n[0])) for sign in (-1.0, 1.0)]
        for m, c in zip(normals[:i], bounds[:i], strict=True):
            if abs(n[0] * m[1] - n[1] * m[0]) > 1e-12:
                candidates.append(np.linalg.solve(np.array((n, m)), np.array((b, c))))
    possible = [c for c in candidates if (normals @ c <= bounds + 1e-9).all() and np.hypot(*c) <= SPEED + 1e-9]
    return min(possible, key=lambda c: np.hypot(*(c - wish)), default=None)


def least_worst(lines, hard):
    """Return how far every velocity at best lies on the wrong side of some line after the ``hard`` ones, by
    an exact linear programme.
    """
    normals, bounds = normals_and_bounds(lines)
    slack = np.where(np.arange(len(lines)) < hard, 0.0, -1.0)
    solution = linprog((0.0, 0.0, 1.0), np.column_stack((normals, slack)), bounds, bounds=[(None, None)] * 3)
    return solution.fun if solution.status == 0 else None


@settings(derandomize=True, deadline=None, max_examples=150)
@given(SEEDS, st.integers(0, 12))
def test_nearest_allowed_velocity_is_the_exact_one(seed, count):
    lines, wish = random_lines(seed, count)
    kept, x, y = nearest_allowed(lines, count, SPEED, Wish(wish, False))
    exact = exact_nearest(lines, wish)
    assert (kept == count) == (exact is not None)
    if exact is not None:
        assert (x, y) == pytest.approx(tuple(exact), abs=1e-6)


@settings(derandomize=True, deadline=None, max_examples=150)
@given(SEEDS, st.integers(3, 10))
def test_safest_velocity_breaks_people_s_lines_by_the_least_possible(seed, count):
    box = np.empty((4, 4))
    for row, (nx, ny) in enumerate(((1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0))):
        put_bound(box, row, nx, ny, 0.5)
    lines = np.vstack((box, random_lines(seed, count, least=-1.5)[0]))
    kept, x, y = nearest_allowed(lines, len(lines), SPEED, Wish((0.3, 0.0), False))
    if kept == len(lines):
        return
    x, y = safest_velocity(lines, 4, len(lines), kept, SPEED, (x, y), np.empty_like(lines))
    assert max(abs(x), abs(y)) <= 0.5 + 1e-9
    assert max(line_violation(line, x, y) for line in lines[4:]) == pytest.approx(least_worst(lines, 4), abs=1e-6)


@settings(derandomize=True, deadline=None, max_examples=200)
@given(SEEDS)
def test_walls_are_kept_before_people_and_reach_before_walls(seed):
    lines, wish = random_lines(seed, 12, least=-1.5)
    reach, _ = random_lines(seed + 1, 3, least=0.1)
    lines[:3] = reach
    x, y = best_velocity(lines.copy(), 3, 6, 12, SPEED, wish, np.empty_like(lines))
    assert max(line_violation(line, x, y) for line in lines[:3]) <= 1e-6
    with_walls = exact_nearest(lines[:6], wish)
    if with_walls is not None:
        assert max(line_violation(line, x, y) for line in lines[:6]) <= 1e-6
    exact = exact_nearest(lines, wish)
    if exact is not None:
        assert (x, y) == pytest.approx(tuple(exact), abs=1e-6)


def test_parallel_lines_are_no_trouble():
    lines = np.empty((3, 4))
    put_bound(lines, 0, 1.0, 0.0, 0.5)
    put_bound(lines, 1, 1.0, 0.0, 0.2)
    put_bound(lines, 2, -1.0, 0.0, -0.4)
    assert nearest_allowed(lines, 2, SPEED, Wish((1.0, 0.3), False)) == (2, 0.2, 0.3)
    assert nearest_allowed(lines, 3, SPEED, Wish((1.0, 0.3), False))[0] == 2
    x, _ = safest_velocity(lines, 0, 3, 2, SPEED, (0.2, 0.3), np.empty_like(lines))
    assert x == pytest.approx(0.3)
