import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt

from arena_core import LETHAL, Costmap, LaserScan, OccupancyGrid, Pose
from arena_core import Window as ByCosts
from arena_core.testing import component, robot, room, scan
from arena_navigation.local_map.log_odds import LogOddsUpdate
from arena_navigation.local_map.rolling import RollingMap
from arena_navigation.planning.inflation import Inflation

BODY = robot()
RADIUS = BODY.footprint.inscribed_radius


def rolling(**changes: Any) -> RollingMap:
    parameters = {
        "size": 4.0,
        "resolution": 0.05,
        "obstacle_range": 3.0,
        "raytrace_range": 3.5,
        "inflation_radius": 0.6,
        "cost_scaling_factor": 3.0,
        "use_map": True,
        "forget_after": 5.0,
        "mapping_range": 10.0,
        "evidence": LogOddsUpdate(0.85, 0.4, 3.5, 2.0),
    }
    return RollingMap(BODY, **(parameters | changes))


def looking(ranges: NDArray[np.float64] | float, stamp: float = 0.0) -> LaserScan:
    values = np.broadcast_to(np.asarray(ranges, np.float32), 360).copy()
    return LaserScan(stamp, -math.pi, math.pi / 180.0, 0.05, 8.0, values, Pose(0.0, 0.0))


def person_ahead(range_: float, stamp: float = 0.0, otherwise: float = np.inf) -> LaserScan:
    ranges = np.full(360, otherwise)
    ranges[175:186] = range_
    return looking(ranges, stamp)


BLIND = looking(np.nan)


def lethal_places(window: Costmap) -> set[tuple[int, int]]:
    """The lethal cells by their whole-number place in ``map``: column, row."""
    corner = np.round(window.origin_xy / window.resolution).astype(int)
    return {(int(c) + int(corner[0]), int(r) + int(corner[1])) for r, c in np.argwhere(window.costs == LETHAL)}


@settings(derandomize=True, deadline=None, max_examples=25)
@given(st.integers(0, 10**6))
def test_costs_and_distances_follow_from_the_lethal_cells(seed: int) -> None:
    random = np.random.default_rng(seed)
    window = rolling().update(
        looking(random.uniform(0.3, 4.0, 360)), Pose(*random.uniform(-5, 5, 2), random.uniform(-3, 3))
    )
    lethal = window.costs == LETHAL
    distance = distance_transform_edt(~lethal) * 0.05
    assert window.distance == pytest.approx(distance, abs=1e-5)
    assert (window.costs == Inflation(RADIUS, 0.6, 3.0).costs_at(distance)).all()


def test_a_window_with_nothing_in_it_is_free_and_infinitely_far() -> None:
    window = rolling().update(looking(np.inf), Pose(0.0, 0.0))
    assert (window.costs == 0).all()
    assert np.isinf(window.distance).all()


@settings(derandomize=True, deadline=None, max_examples=40)
@given(st.integers(0, 10**6))
def test_cells_that_stay_in_the_window_stay_where_they_are(seed: int) -> None:
    random = np.random.default_rng(seed)
    local_map = rolling(use_map=True)
    local_map.reset(room())
    here = Pose(*random.uniform(-4, 4, 2), random.uniform(-3, 3))
    there = Pose(here.x + random.uniform(-3, 3), here.y + random.uniform(-3, 3), random.uniform(-3, 3))
    before = local_map.update(looking(random.uniform(0.3, 2.5, 360)), here)
    after = local_map.update(BLIND, there)
    for window, pose in ((before, here), (after, there)):
        whole = window.origin_xy / 0.05
        assert whole == pytest.approx(np.round(whole), abs=1e-6)
        centre = window.origin_xy + 0.05 * np.array(window.costs.shape[::-1]) / 2
        assert np.abs(centre - (pose.x, pose.y)).max() <= 0.05 + 1e-9
        assert window.costs.shape == (80, 80)
    low, high = np.round(after.origin_xy / 0.05).astype(int), np.round(after.origin_xy / 0.05).astype(int) + 80

    def beneath(column: int, row: int) -> bool:
        return math.hypot((column + 0.5) * 0.05 - there.x, (row + 0.5) * 0.05 - there.y) < RADIUS

    kept = {(c, r) for c, r in lethal_places(before) if low[0] <= c < high[0] and low[1] <= r < high[1]}
    walls = {(c, r) for c, r in kept if 4.95 < max(abs(c + 0.5), abs(r + 0.5)) * 0.05 < 5.0}
    assert {(c, r) for c, r in kept if not beneath(c, r)} | walls <= lethal_places(after)
    fresh = local_map.update(BLIND, there)
    assert lethal_places(fresh) == lethal_places(after)


def test_a_mark_that_leaves_the_window_is_forgotten() -> None:
    local_map = rolling()
    assert local_map.update(person_ahead(1.0), Pose(0.0, 0.0)).costs.max() == LETHAL
    assert local_map.update(BLIND, Pose(-3.0, 0.0)).costs.max() == 0
    assert local_map.update(BLIND, Pose(0.0, 0.0)).costs.max() == 0


def test_who_walks_away_is_cleared_and_who_is_out_of_sight_is_forgotten() -> None:
    local_map = rolling()
    pose = Pose(0.0, 0.0)
    local_map.update(person_ahead(1.8), pose)
    assert not lethal_places(local_map.update(looking(np.inf, 0.1), pose))
    local_map.update(person_ahead(1.8, 0.2), pose)
    hidden = lethal_places(local_map.update(person_ahead(1.0, 0.3), pose))
    assert len({c for c, _ in hidden}) > 1
    left = lethal_places(local_map.update(person_ahead(1.0, 5.25), pose))
    assert {c for c, _ in left} <= {19, 20}


def test_a_null_forgets_nothing() -> None:
    local_map = rolling(forget_after=None)
    local_map.update(person_ahead(1.8), Pose(0.0, 0.0))
    assert local_map.update(looking(np.nan, 1000.0), Pose(0.0, 0.0)).costs.max() == LETHAL


def test_the_robots_own_cell_is_never_lethal_by_its_own_returns() -> None:
    window = rolling().update(looking(0.1), Pose(0.0, 0.0))
    assert window.costs.max() == 0


def test_the_map_is_beneath_unless_it_is_not_used() -> None:
    pose = Pose(4.0, 0.0)
    for use_map in (True, False):
        local_map = rolling(use_map=use_map)
        local_map.reset(room())
        assert (local_map.update(BLIND, pose).costs.max() == LETHAL) == use_map
    seen = local_map.update(scan(pose, BODY), pose)
    assert {c for c, r in lethal_places(seen) if abs(r) < 10} == {99}


def test_beams_do_not_clear_the_map() -> None:
    local_map = rolling()
    local_map.reset(room())
    assert local_map.update(looking(np.inf), Pose(4.0, 0.0)).costs.max() == LETHAL


@pytest.mark.parametrize("theta", [0.0, 0.7, -2.0])
@pytest.mark.parametrize("resolution", [0.02, 0.05, 0.15])
def test_the_window_shows_maps_of_any_resolution_and_rotation(theta: float, resolution: float) -> None:
    data = np.zeros((60, 60), np.int8)
    data[20, 25:40] = data[30:34, 10:14] = 100
    grid = OccupancyGrid(data, resolution, Pose(0.3, -0.4, theta))
    places = grid.positions(np.argwhere(grid.occupied))
    centre = places.mean(axis=0)
    local_map = rolling(size=12.0)
    local_map.reset(grid)
    window = local_map.update(BLIND, Pose(float(centre[0]), float(centre[1])))
    cells = np.floor((places - window.origin_xy) / 0.05).astype(int)
    near = [window.costs[r - 1 : r + 2, c - 1 : c + 2].max() == LETHAL for c, r in cells]
    assert all(near)
    lethal = (np.argwhere(window.costs == LETHAL)[:, ::-1] + 0.5) * 0.05 + window.origin_xy
    assert (
        np.abs(lethal[:, None] - places[None]).max(axis=2).min(axis=1).max()
        <= 0.025 * math.sqrt(2) + resolution * math.sqrt(0.5) + 1e-9
    )


@settings(derandomize=True, deadline=None, max_examples=20)
@given(st.integers(0, 10**6))
def test_no_cell_of_a_finer_map_is_missed(seed: int) -> None:
    row, column = np.random.default_rng(seed).integers(0, 200, 2)
    data = np.zeros((200, 200), np.int8)
    data[row, column] = 100
    local_map = rolling()
    local_map.reset(OccupancyGrid(data, 0.01, Pose(0.0, 0.0)))
    window = local_map.update(BLIND, Pose(1.0, 1.0))
    assert lethal_places(window) == {(int(column) // 5, int(row) // 5)}


def test_reset_forgets_marks_and_map() -> None:
    local_map = rolling()
    local_map.reset(room())
    local_map.update(person_ahead(1.0), Pose(4.0, 0.0))
    local_map.reset(None)
    assert local_map.update(BLIND, Pose(4.0, 0.0)).costs.max() == 0
    assert (local_map.planning_grid(Pose(0.0, 0.0), all_marks=True).data == 0).all()


def test_a_returned_window_is_not_changed_by_the_next_update() -> None:
    local_map = rolling()
    first = local_map.update(person_ahead(1.0), Pose(0.0, 0.0))
    copy = first.costs.copy()
    local_map.update(looking(np.inf), Pose(1.0, 0.0))
    assert (first.costs == copy).all()


def test_the_preset_builds_the_map() -> None:
    built = component("local_map", "rolling", robot=BODY)
    assert isinstance(built, RollingMap)
    assert built.update(BLIND, Pose(0.0, 0.0)).costs.shape == (120, 120)


@settings(derandomize=True, deadline=None, max_examples=40)
@given(st.integers(0, 10**6))
def test_a_path_is_blocked_where_the_costs_say_so(seed: int) -> None:
    random = np.random.default_rng(seed)
    local_map = rolling(inflation_radius=random.choice((0.0, 0.6)))
    local_map.reset(room())
    pose = Pose(*random.uniform(-1.5, 1.5, 2), random.uniform(-3.0, 3.0))
    for step in range(3):
        ranges = np.where(random.random(360) < 0.05, random.uniform(0.3, 3.0, 360), np.inf)
        window = local_map.take_in(
            looking(ranges, 0.1 * step), Pose(pose.x + 0.2 * step, pose.y - 0.1 * step, pose.theta)
        )
    plain = ByCosts(window.costmap)
    found = set()
    for _ in range(30):
        ends = random.uniform(-3.0, 3.0, (2, 2))
        x, y = (np.linspace(*ends[:, axis], 40) for axis in (0, 1))
        robot = Pose(*random.uniform(-2.0, 2.0, 2))
        found.add(window.is_blocked(x, y, robot))
        assert window.is_blocked(x, y, robot) == plain.is_blocked(x, y, robot)
    assert found


def test_window_moves_as_if_it_were_laid_out_anew() -> None:
    """Marks stay where they are in ``map`` while they are inside, whichever way the window goes;
    what comes in is the map's.
    """
    moves = [(0.0, 0.0), (0.3, 0.0), (0.3, -0.4), (-0.2, -0.4), (-0.2, 0.6), (5.0, 0.0), (1.0, 0.1)]
    local_map, marks = rolling(forget_after=None), set[tuple[int, int]]()
    local_map.reset(room())
    for k, (x, y) in enumerate(moves):
        local_map.take_in(person_ahead(0.8, float(k)) if k == 0 else BLIND, Pose(x, y))
        corner = local_map._corner
        inside = {(int(r) + corner[0], int(c) + corner[1]) for r, c in np.argwhere(local_map._hit_at > -np.inf)}
        span = range(corner[0], corner[0] + local_map._cells), range(corner[1], corner[1] + local_map._cells)
        marks = inside if k == 0 else {(r, c) for r, c in marks if r in span[0] and c in span[1]}
        assert inside == marks
        fresh = rolling()
        fresh.reset(room())
        fresh.take_in(BLIND, Pose(x, y))
        assert (local_map._static == fresh._static).all()
    assert not marks
