import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from arena_core import INSCRIBED, LETHAL
from arena_navigation.planning.search import CostToGo, MoveCosts
from arena_navigation.planning.smoothing import line_cost, refine_path

WEIGHTS = 50.0 + 0.8 * np.arange(256.0)
Costs = NDArray[np.uint8]
Points = NDArray[np.float64]


def random_costs(seed: int, share: float = 0.2) -> Costs:
    random = np.random.default_rng(seed)
    costs = np.repeat(np.repeat(random.integers(0, 200, (6, 6)), 5, axis=0), 5, axis=1).astype(np.uint8)
    costs[random.random(costs.shape) < share] = LETHAL
    return costs


def sampled(points: Points, number: int = 400) -> Points:
    share = (np.arange(number) + 0.5)[:, None] / number
    return np.concatenate([a + share * (b - a) for a, b in pairwise(points)])


def cell_costs(costs: Costs, positions: Points) -> Costs:
    cells = np.floor(positions).astype(int)
    return costs[cells[:, 1], cells[:, 0]]


def random_way(costs: Costs, seed: int) -> Points | None:
    free = np.argwhere(costs < INSCRIBED)
    start, goal = (tuple(int(i) for i in free[k]) for k in np.random.default_rng(seed).integers(0, len(free), 2))
    search = CostToGo(costs, MoveCosts(50.0, 0.8), goal, start)
    if not math.isfinite(search(start)):
        return None
    points: Points = search.cells_from(start)[:, ::-1] + 0.5
    return points


@settings(derandomize=True, deadline=None, max_examples=100)
@given(st.integers(0, 10**6), st.lists(st.floats(0.01, 29.99), min_size=4, max_size=4))
def test_a_line_costs_its_length_times_the_weights_of_its_cells(seed: int, ends: list[float]) -> None:
    costs = random_costs(seed, 0.01)
    x0, y0, x1, y1 = ends
    crossed = cell_costs(costs, sampled(np.array(((x0, y0), (x1, y1))), 20000))
    found = line_cost((costs, WEIGHTS), x0, y0, x1, y1)
    if (crossed >= INSCRIBED).any():
        assert found == math.inf
    elif found < math.inf:  # a corner that the samples missed may block
        assert found == pytest.approx(math.hypot(x1 - x0, y1 - y0) * WEIGHTS[crossed].mean(), rel=2e-3, abs=0.2)


def test_a_line_through_a_corner_needs_both_cells_beside_it() -> None:
    costs = np.zeros((2, 2), np.uint8)
    assert line_cost((costs, WEIGHTS), 0.5, 0.5, 1.5, 1.5) == pytest.approx(50.0 * math.sqrt(2.0))
    costs[0, 1] = LETHAL
    assert line_cost((costs, WEIGHTS), 0.5, 0.5, 1.5, 1.5) == math.inf
    assert line_cost((costs, WEIGHTS), 1.5, 1.5, 0.5, 0.5) == math.inf


@pytest.mark.slow
@settings(derandomize=True, deadline=None, max_examples=60)
@given(st.integers(0, 10**6))
def test_a_refined_path_stays_on_free_cells_and_is_evenly_fine(seed: int) -> None:
    costs = random_costs(seed)
    points = random_way(costs, seed)
    if points is None:
        return
    path = refine_path((costs, WEIGHTS), points, 0, 2.0, 20)
    assert (path[0] == points[0]).all()
    assert (path[-1] == points[-1]).all()
    if len(path) > 1:
        assert (cell_costs(costs, sampled(path)) < INSCRIBED).all()
        assert np.hypot(*np.diff(path, axis=0).T).max() <= 2.0 + 1.0  # smoothing moves a point by a cell at most


@settings(derandomize=True, deadline=None, max_examples=40)
@given(st.integers(0, 10**6))
def test_straight_lines_cost_no_more_than_the_cells_they_replace(seed: int) -> None:
    costs = random_costs(seed)
    points = random_way(costs, seed)
    if points is None or len(points) < 2:
        return

    def cost(path: Points) -> float:
        return sum(line_cost((costs, WEIGHTS), *a, *b) for a, b in pairwise(path))

    assert cost(refine_path((costs, WEIGHTS), points, 0, 2.0, 0)) <= cost(points) * (1.0 + 1e-6)


def test_open_ground_is_crossed_in_a_straight_line() -> None:
    costs = np.zeros((40, 40), np.uint8)
    search = CostToGo(costs, MoveCosts(50.0, 0.8), (12, 35), (2, 3))
    search((2, 3))
    path = refine_path((costs, WEIGHTS), search.cells_from((2, 3))[:, ::-1] + 0.5, 0, 2.0, 20)
    headings = np.arctan2(*np.diff(path, axis=0).T[::-1])
    assert headings == pytest.approx(math.atan2(10.0, 32.0), abs=1e-6)


def test_smoothing_rounds_corners_but_keeps_the_ends() -> None:
    costs = np.zeros((40, 40), np.uint8)
    costs[10:, :20] = 250  # costly, not blocked: there is room for a rounder corner
    points = np.array([(x + 0.5, 9.5) for x in range(2, 23)] + [(22.5, y + 0.5) for y in range(10, 38)])
    sharp, smooth = (refine_path((costs, WEIGHTS), points, 0, 2.0, rounds) for rounds in (0, 20))
    turn = [np.abs(np.diff(np.unwrap(np.arctan2(*np.diff(path, axis=0).T[::-1])))).max() for path in (sharp, smooth)]
    assert turn[1] < 0.7 * turn[0]
    assert (smooth[[0, -1]] == points[[0, -1]]).all()


def test_pinned_points_are_kept() -> None:
    costs = np.zeros((20, 20), np.uint8)
    costs[:, :4] = INSCRIBED
    points = np.array([(x + 0.5, 5.5) for x in range(1, 4)] + [(x + 0.5, x + 1.5) for x in range(4, 15)])
    path = refine_path((costs, WEIGHTS), points, 3, 2.0, 20)
    assert (path[:4] == points[:4]).all()
