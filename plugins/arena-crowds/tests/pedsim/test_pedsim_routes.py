from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.sparse import coo_array
from scipy.sparse.csgraph import dijkstra

from arena_core import Crowd, OccupancyGrid, Pose
from arena_kernels.grids import stack_grids
from arena_kernels.ground import ground_of, layouts_of, wall_clearance
from arena_kernels.route_grid import coarse_grid_of, stack_coarse_grids
from arena_kernels.routes import (
    COST,
    DIAGONAL,
    STRAIGHT,
    RouteSearch,
    _search_route,
    find_corners,
    nearest_room,
    nodes_for,
)
from arena_kernels.slide_along import SIGHT, is_visible


def cheapest(room, radius, start):
    """Return the cost from one cell to all, by scipy."""
    rows, columns = room.shape
    free = room >= radius
    ends = []
    for r, c in np.argwhere(free).tolist():
        for down, right, cost in ((0, 1, STRAIGHT), (1, 0, STRAIGHT), (1, 1, DIAGONAL), (1, -1, DIAGONAL)):
            i, j = r + down, c + right
            if 0 <= i < rows and 0 <= j < columns and free[i, j] and free[i, c] and free[r, j]:
                ends.append((r * columns + c, i * columns + j, cost))
    if not ends:
        return np.where(np.arange(room.size) == start, 0.0, np.inf)
    one, other, cost = np.array(ends).T
    return dijkstra(
        coo_array((cost, (one, other)), shape=(room.size, room.size)).tocsr(), directed=False, indices=start
    )


@settings(max_examples=60)
@given(st.integers(0, 2**32), st.floats(0.0, 0.45))
def test_the_search_finds_the_cheapest_way(seed, clutter):
    random = np.random.default_rng(seed)
    room = np.where(random.random((14, 19)) < clutter, 0.1, 0.5).astype(np.float32)
    start, goal = random.integers(0, room.size, 2)
    room.flat[[start, goal]] = 0.5
    nodes = np.zeros((room.size + 1, 5), np.int32)
    expected = cheapest(room, 0.3, start)[goal]
    for _ in range(2):  # the memory is used again
        found = _search_route(room, int(start), int(goal), 0.3, nodes, np.full(16, -1, np.int32))
        assert found == np.isfinite(expected)
        assert not found or nodes[goal, COST] == expected


def terrain(grid, cell=0.2):
    stack, rooms = stack_grids([grid])[0], stack_coarse_grids([grid], cell)
    return ground_of(stack.distance, layouts_of(stack)[0]), coarse_grid_of(rooms, 0), nodes_for(rooms)


def route(grid, start, goal, radius=0.3):
    ground, rooms, nodes = terrain(grid)
    corners = np.empty((24, 2))
    first, last = nearest_room(ground, rooms, *start, radius)[2], nearest_room(ground, rooms, *goal, radius)[2]
    found = find_corners(ground, RouteSearch(rooms, nodes), (*start, first), (*goal, last), radius, corners)
    return None if found < 0 else np.vstack((start, corners[:found], goal)), ground


def test_a_route_runs_from_corner_to_corner_in_sight(stage):
    way, ground = route(stage.hall(20, 20, stage.racks), (2.0, 6.0), (18.0, 14.0))
    assert len(way) > 2
    for here, there in pairwise(way):
        assert is_visible(ground, (*here, *there), SIGHT * 0.3)
    length = np.hypot(*np.diff(way, axis=0).T).sum()
    assert length < 1.25 * np.hypot(16.0, 8.0)


def test_a_route_on_a_turned_map_leads_through_the_door(stage):
    plain = stage.hall(10, 6, [(5.0, 0.0, 5.2, 4.5)])
    turned = OccupancyGrid(plain.data, 0.05, Pose(3.0, -2.0, 0.8))
    start, goal = turned.positions([(40, 40), (40, 160)])
    way, ground = route(turned, tuple(start), tuple(goal))
    assert all(wall_clearance(ground, x, y) >= 0.27 for x, y in way)
    assert turned.cells(way[1])[0] > 90


def test_no_way_through_a_gap_narrower_than_the_body(stage):
    hall = stage.hall(10, 6, [(5.0, 0.0, 5.2, 5.5)])
    assert route(hall, (2.0, 3.0), (8.0, 3.0), radius=0.2)[0] is not None
    assert route(hall, (2.0, 3.0), (8.0, 3.0), radius=0.3)[0] is None


def test_the_nearest_room_is_never_behind_a_wall(stage):
    ground, rooms, _ = terrain(stage.hall(10, 6, [(5.0, 0.0, 5.05, 6.0)]))
    x, y, cell = nearest_room(ground, rooms, 4.9, 3.0, 0.3)
    assert cell >= 0
    assert x < 5.0
    assert y == pytest.approx(3.0, abs=0.15)


def test_people_walk_round_racks_to_their_waypoints(stage, make_model):
    scenario = stage.scenario(stage.hall(20, 20, stage.racks), [stage.person(0, (2.0, 6.0), (18.0, 6.0), (2.0, 14.0))])
    positions = np.array([crowd.positions[0, 0] for crowd in stage.walk(make_model(), scenario, 60.0)])
    arrival = np.argmax(np.hypot(*(positions - (18.0, 6.0)).T) < 0.5)
    assert 16 / 0.05 < arrival < 30 / 0.05
    assert np.hypot(*(positions[arrival:] - (2.0, 14.0)).T).min() < 0.5


def test_a_waypoint_inside_a_wall_is_approached_as_near_as_there_is_room(stage, make_model):
    wall = (5.0, 2.0, 7.0, 4.0)
    scenario = stage.scenario(stage.hall(10, 6, [wall]), [stage.person(0, (1.0, 3.0), (5.3, 3.0), (1.0, 1.0))])
    positions = np.array([crowd.positions[0, 0] for crowd in stage.walk(make_model(), scenario, 12.0)])
    assert 4.0 < positions[:, 0].max() < 4.71
    assert np.hypot(*(positions - (1.0, 1.0)).T).min() < 0.5  # reached at once, not given up after being stuck


def test_a_waypoint_that_cannot_be_reached_is_given_up(stage, make_model):
    closed = [(6.0, 1.0, 6.1, 5.0), (6.0, 1.0, 9.0, 1.1), (6.0, 4.9, 9.0, 5.0), (8.9, 1.0, 9.0, 5.0)]
    scenario = stage.scenario(stage.hall(10, 6, closed), [stage.person(0, (2.0, 3.0), (7.5, 3.0), (1.0, 1.0))])
    positions = np.array([crowd.positions[0, 0] for crowd in stage.walk(make_model(), scenario, 30.0)])
    assert np.hypot(*(positions - (1.0, 1.0)).T).min() < 0.5


def test_who_is_moved_out_of_sight_of_the_way_finds_another(stage, make_model):
    hall = stage.hall(20, 20, stage.racks)
    model = make_model()
    crowd = list(stage.walk(model, stage.scenario(hall, [stage.person(0, (2.0, 6.0), (18.0, 2.0), (2.0, 6.0))]), 1.0))[
        -1
    ]
    crowd = Crowd(crowd.counts, crowd.ids, np.array([[[9.0, 14.0]]]), crowd.velocities, crowd.radii, crowd.states)
    nearest = np.inf
    for tick in range(500):
        crowd = model.step(crowd, stage.robots(), np.full(1, tick), 0.05)
        nearest = min(nearest, np.hypot(*(crowd.positions[0, 0] - (18.0, 2.0))))
    assert nearest < 0.5
