import gzip
import math
from itertools import pairwise
from pathlib import Path as File

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import dijkstra

from arena_core import INSCRIBED, LETHAL, OccupancyGrid, Pose
from arena_navigation.planning.inflation import InflatedCosts, Inflation
from arena_navigation.planning.search import CostToGo, MoveCosts

MOVING_AI = File(__file__).parents[4] / "shared" / "data" / "movingai"
DRAWN = File(__file__).parents[3] / "tests" / "data" / "movingai"
MOVES = MoveCosts(50.0, 0.8)
PLAIN = MoveCosts(1.0, 0.0)
Costs = NDArray[np.uint8]


def random_costs(seed: int, share: float = 0.3) -> Costs:
    random = np.random.default_rng(seed)
    # where costs hardly differ, many cells are bettered after their expansion
    dearest = random.choice((2, 4, INSCRIBED))
    costs = random.integers(0, dearest, (random.integers(2, 25), random.integers(2, 25))).astype(np.uint8)
    costs[random.random(costs.shape) < share] = random.choice((INSCRIBED, LETHAL, 255))
    return costs


def legal_moves(costs: Costs) -> list[tuple[int, int, int]]:
    """All (from, to, cost in 1/13860 of a free straight move), cells numbered row by row,
    written without the search's tricks.
    """
    rows, columns = costs.shape
    free = costs < INSCRIBED
    moves = []
    for row, column in np.argwhere(free):
        for dr, dc in ((0, 1), (0, -1), (1, 0), (-1, 0), (1, 1), (1, -1), (-1, 1), (-1, -1)):
            r, c = row + dr, column + dc
            if 0 <= r < rows and 0 <= c < columns and free[r, c] and free[row, c] and free[r, column]:
                price = (19601 if dr and dc else 13860) * (1.0 + 0.8 * float(costs[r, c]) / 50.0)
                moves.append((row * columns + column, r * columns + c, round(price)))
    return moves


def dijkstra_to(costs: Costs, goal: int) -> NDArray[np.float64]:
    start, end, weight = zip(*legal_moves(costs), strict=True) if legal_moves(costs) else ((), (), ())
    graph = coo_array((weight, (end, start)), shape=(costs.size, costs.size)).tocsr()
    distances: NDArray[np.float64] = dijkstra(graph, indices=goal)
    return distances


def way_cost(costs: Costs, way: NDArray[np.int64]) -> int:
    """The cost of a way, which must consist of legal moves."""
    allowed = {(a, b): w for a, b, w in legal_moves(costs)}
    numbers = way[:, 0] * costs.shape[1] + way[:, 1]
    return sum(allowed[int(a), int(b)] for a, b in pairwise(numbers))


@pytest.mark.slow
@settings(derandomize=True, deadline=None, max_examples=60)
@given(st.integers(0, 10**6), st.floats(0.0, 0.5))
def test_every_value_is_dijkstras_and_every_way_costs_it(seed: int, share: float) -> None:
    costs = random_costs(seed, share)
    random = np.random.default_rng(seed + 1)
    goal = tuple(random.choice(np.argwhere(costs < INSCRIBED))) if (costs < INSCRIBED).any() else (0, 0)
    if costs[goal] >= INSCRIBED:
        return
    expected = dijkstra_to(costs, goal[0] * costs.shape[1] + goal[1]).reshape(costs.shape)
    search = CostToGo(costs, MOVES, goal, (0, 0))
    for cell in random.permutation(np.argwhere(costs < INSCRIBED))[:12]:
        start = int(cell[0]), int(cell[1])
        assert search(start) * 13860 == pytest.approx(expected[start], abs=1e-3)
        if math.isfinite(expected[start]):
            way = search.cells_from(start)
            assert tuple(way[0]) == start
            assert tuple(way[-1]) == goal
            assert way_cost(costs, way) == expected[start]


@settings(derandomize=True, deadline=None, max_examples=40)
@given(st.integers(0, 10**6))
def test_answers_do_not_depend_on_earlier_queries(seed: int) -> None:
    costs = random_costs(seed, 0.2)
    random = np.random.default_rng(seed)
    costs = (costs // 64 * 64).astype(np.uint8)  # many ways of equal cost
    free = [(int(r), int(c)) for r, c in np.argwhere(costs < INSCRIBED)]
    if not free:
        return
    goal, *cells = [free[i] for i in random.integers(0, len(free), 8)]
    kept = CostToGo(costs, MOVES, goal, cells[0])
    for cell in cells:
        fresh = CostToGo(costs, MOVES, goal, cell)
        assert kept(cell) == fresh(cell)
        if math.isfinite(kept(cell)):
            assert (kept.cells_from(cell) == fresh.cells_from(cell)).all()


def test_a_long_search_outgrows_its_first_queue() -> None:
    costs = np.zeros((300, 300), np.uint8)
    costs[:, 150] = LETHAL
    costs[299, 150] = 0
    across = 149 * math.sqrt(2.0) + 150  # from a corner to beside the gap at the other end of the wall
    assert CostToGo(costs, PLAIN, (0, 299), (0, 0))((0, 0)) == pytest.approx(
        across + 2 + across - math.sqrt(2.0) + 1, abs=1e-3
    )


def test_walls_and_blocked_cells_cost_infinitely_much() -> None:
    costs = np.zeros((5, 5), np.uint8)
    costs[:, 2] = INSCRIBED
    search = CostToGo(costs, PLAIN, (2, 4), (2, 0))
    assert search((2, 0)) == math.inf
    assert search((2, 2)) == math.inf
    assert search((0, 3)) == pytest.approx(1.0 + math.sqrt(2.0))
    assert CostToGo(costs, PLAIN, (2, 2), (2, 0))((2, 0)) == math.inf


def test_corners_are_not_cut() -> None:
    costs = np.array(((0, 0), (LETHAL, 0)), np.uint8)
    assert CostToGo(costs, PLAIN, (1, 1), (0, 0))((0, 0)) == pytest.approx(2.0)


def read_map(file: File) -> NDArray[np.bool_]:
    text = gzip.decompress(file.read_bytes()).decode() if file.suffix == ".gz" else file.read_text()
    rows = text.split("map\n", 1)[1].splitlines()
    return np.array([[cell in ".G" for cell in row] for row in rows])


def read_queries(file: File) -> list[tuple[tuple[int, int], tuple[int, int], float]]:
    fields = [line.split() for line in file.read_text().splitlines()[1:] if line.strip()]
    return [((int(f[5]), int(f[4])), (int(f[7]), int(f[6])), float(f[8])) for f in fields]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("place", "scenario"),
    [
        (DRAWN / "rooms.map", DRAWN / "rooms.map.scen"),
        ("dao/arena.map", "dao/arena.map.scen"),
        ("dao/arena2.map", "dao/arena2.map.scen"),
        ("mapf/random-32-32-20.map", "mapf/scen-even/random-32-32-20-even-1.scen"),
        ("mapf/room-64-64-8.map", "mapf/scen-even/room-64-64-8-even-1.scen"),
        ("rooms/32room_000.map.gz", "rooms/32room_000.map.scen"),
    ],
)
def test_plain_mode_finds_the_listed_optima(place: str | File, scenario: str | File) -> None:
    file = MOVING_AI / "maps" / place  # a drawn one is where it is
    if not file.is_file():
        pytest.skip("the MovingAI maps are not beside the repository")
    free = read_map(file)
    grid = OccupancyGrid(np.where(free, 0, 100).astype(np.int8), 1.0, Pose(0.0, 0.0))
    costs = grid.derive(InflatedCosts(Inflation(0.2, 0.0, 3.0), False))
    for start, goal, optimum in read_queries(MOVING_AI / "scenarios" / scenario):
        search = CostToGo(costs, PLAIN, goal, start)
        assert search(start) == pytest.approx(optimum, abs=1e-3)
        steps = np.abs(np.diff(search.cells_from(start), axis=0))
        diagonal = int((steps.sum(axis=1) == 2).sum())
        assert len(steps) - diagonal + diagonal * math.sqrt(2.0) == pytest.approx(optimum, abs=1e-3)
        assert steps.size == 0 or steps.max() == 1
