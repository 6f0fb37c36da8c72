"""Measures of difficulty are what they are called, on maps where one can tell, and against slow and simple searches."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import ndimage, sparse
from scipy.sparse import csgraph

from arena_core import ConfigurationError, OccupancyGrid, Pose
from arena_worlds.commands.grid_paths import DIAGONAL, STRAIGHT, UNREACHED, climb_clearance, join_levels, path_lengths
from arena_worlds.commands.measures import SIGHT, measures_of

EXACT = settings(derandomize=True, deadline=None, max_examples=40)
SEEDS = st.integers(0, 2**31)


def hall(rows: int, columns: int) -> np.ndarray:
    data = np.zeros((rows, columns), np.int8)
    data[[0, -1], :] = data[:, [0, -1]] = 100
    return data


def grid_of(data: np.ndarray, resolution: float = 0.1) -> OccupancyGrid:
    return OccupancyGrid(data, resolution, Pose(-3.0, 2.0, 0.4))


def two_rooms(door: int) -> OccupancyGrid:
    """Return 4 x 8 m in two, joined by a door of so many cells of 0.1 m."""
    data = hall(42, 83)
    data[:, 40:42] = 100
    data[20 : 20 + door, 40:42] = 0
    return grid_of(data)


def test_empty_room_is_straight_and_as_wide_as_it_is() -> None:
    found = measures_of(grid_of(hall(43, 63)), 0.25)
    assert found.room == pytest.approx((41 - 4) * (61 - 4) * 0.01)
    assert found.tortuosity == 1.0
    assert found.narrowest_passage == found.passage == pytest.approx(4.1)
    assert 0.25 < found.mean_clearance < 2.05
    assert found.visibility < SIGHT


@pytest.mark.parametrize("door", [7, 11, 15])
def test_door_is_the_narrowest_passage(door: int) -> None:
    found = measures_of(two_rooms(door), 0.3)
    assert found.narrowest_passage == pytest.approx(0.1 * door)
    assert found.narrowest_passage < found.passage < 4.0


def test_place_behind_a_door_that_is_too_narrow_does_not_count() -> None:
    assert measures_of(two_rooms(5), 0.3).room < 0.6 * measures_of(two_rooms(7), 0.3).room


def test_way_round_a_wall_is_longer_than_straight() -> None:
    data = hall(62, 62)
    data[1:50, 30:32] = 100
    assert measures_of(grid_of(data), 0.2).tortuosity > 1.2


def test_corridor_is_seen_along_but_not_across() -> None:
    found = measures_of(grid_of(hall(13, 200)), 0.3)
    assert found.characteristic_dimension == pytest.approx(1.1, abs=0.03)
    assert 1.1 < found.visibility < 4.0


def test_unknown_cells_are_no_place_to_be() -> None:
    data = hall(43, 63)
    data[:, 31:] = -1
    assert measures_of(grid_of(data), 0.25).room < 0.5 * measures_of(grid_of(hall(43, 63)), 0.25).room


@EXACT
@given(SEEDS)
def test_twice_as_large_is_twice_as_wide_and_as_winding(seed: int) -> None:
    data = hall(30, 40)
    data[1:-1, 1:-1] = np.where(
        ndimage.gaussian_filter(np.random.default_rng(seed).random((28, 38)), 1.5) > 0.53, 100, 0
    )
    small, large = measures_of(grid_of(data, 0.05), 0.05), measures_of(grid_of(data, 0.1), 0.1)
    assert large.room == pytest.approx(4.0 * small.room)
    for name in ("mean_clearance", "narrowest_passage", "passage"):
        assert getattr(large, name) == pytest.approx(2.0 * getattr(small, name))


@pytest.mark.parametrize(("data", "most"), [(hall(20, 20), "0\\.85"), (np.full((5, 5), 100, np.int8), "0")])
def test_robot_that_fits_nowhere_is_one_line(data: np.ndarray, most: str) -> None:
    with pytest.raises(
        ConfigurationError,
        match=rf"robot_radius is 3: no free space for the robot; allowed: up to {most} m in this map$",
    ):
        measures_of(grid_of(data), 3.0)


def steps_of(room: np.ndarray) -> sparse.csr_matrix:
    """Return the graph of all steps between neighbouring cells of a room."""
    number = np.arange(room.size).reshape(room.shape)
    edges = []
    for dr, dc, cost in ((0, 1, STRAIGHT), (1, 0, STRAIGHT), (1, 1, DIAGONAL), (1, -1, DIAGONAL)):
        a = (slice(0, room.shape[0] - dr), slice(max(-dc, 0), room.shape[1] - max(dc, 0)))
        b = (slice(dr, room.shape[0]), slice(max(dc, 0), room.shape[1] + min(dc, 0)))
        both = room[a] & room[b]
        edges.append(np.stack((number[a][both], number[b][both], np.full(both.sum(), cost))))
    first, second, cost = np.concatenate(edges, axis=1)
    return sparse.csr_matrix((cost, (first, second)), shape=(room.size, room.size))


@EXACT
@given(SEEDS, st.floats(0.5, 0.95))
def test_ways_are_the_shortest(seed: int, share: float) -> None:
    room = np.pad(np.random.default_rng(seed).random((12, 15)) < share, 1)
    room[1, 1] = True
    exact = csgraph.dijkstra(steps_of(room), directed=False, indices=room.shape[1] + 1)
    found = path_lengths(room.view(np.uint8), 1, 1).ravel().astype(float)
    assert (np.where(found >= UNREACHED, np.inf, found) == exact).all()


@EXACT
@given(SEEDS, st.integers(2, 8))
def test_roomiest_ways_are_those_of_a_search_by_threshold(seed: int, count: int) -> None:
    random = np.random.default_rng(seed)
    clearance = np.pad(random.integers(1, 9, (6, 7)).astype(np.float32), 1, constant_values=-1.0)
    cells = np.flatnonzero(clearance > 0)
    marked = random.choice(cells, count, replace=False)
    order = cells[np.argsort(-clearance.ravel()[cells], kind="stable")]
    found = join_levels(clearance, order, np.bincount(marked, minlength=clearance.size))
    levels = []
    for k, a in enumerate(marked):
        for b in marked[:k]:
            joined = [t for t in range(1, 9) if (label := ndimage.label(clearance >= t)[0].ravel())[a] == label[b] > 0]
            levels.append(max(joined))
    assert found == (min(levels), pytest.approx(np.mean(levels)))


def test_one_place_has_no_ways() -> None:
    clearance = np.pad(np.ones((3, 3), np.float32), 1, constant_values=-1.0)
    assert np.isnan(join_levels(clearance, np.flatnonzero(clearance > 0), np.zeros(25, np.int64))).all()


def test_climbing_ends_in_the_middle() -> None:
    rows, columns = np.mgrid[-4:5, -4:5]
    clearance = (5.0 - np.hypot(rows, columns)).astype(np.float32)
    assert set(climb_clearance(clearance, np.flatnonzero(np.maximum(abs(rows), abs(columns)) < 4)).tolist()) == {40}


def test_widths_are_those_of_a_corridor_and_a_square() -> None:
    data = np.full((64, 204), 100, np.int8)
    data[20:44, 2:142] = 0
    data[2:62, 142:202] = 0
    found = measures_of(grid_of(data), 0.25)
    assert found.free == pytest.approx(2.4 * 14.0 + 6.0 * 6.0)
    assert found.width_p10 == found.width == pytest.approx(2.4)
    assert 2.4 <= found.width_p90 <= 6.0
    assert measures_of(grid_of(data), 0.9).width == found.width
    corridor = hall(26, 204)
    assert measures_of(grid_of(corridor), 0.25).beside_walls == pytest.approx(1.0 - (6 * 184) / (24 * 202))
