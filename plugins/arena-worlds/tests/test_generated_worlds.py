"""Generated worlds let the robot through, depend on parameters and seed alone, and are as hard as asked."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from omegaconf import OmegaConf
from scipy import ndimage

from arena_core import FREE, ConfigurationError, OccupancyGrid
from arena_core.hosting import compose, load_registry
from arena_worlds.generators.cellular import smooth_cells
from arena_worlds.generators.generated import Generated
from arena_worlds.reachable import keep_reachable
from arena_worlds.widths import widths_of

KINDS = ("indoor", "outdoor", "rooms", "cellular")
SEEDS = st.integers(0, 2**31)
EXACT = settings(derandomize=True, deadline=None, max_examples=25)


def make(kind: str, *overrides: str) -> Generated:
    node = OmegaConf.to_container(compose([f"world.{word}" for word in overrides], f"world/{kind}").world, resolve=True)
    return load_registry().build("world", node)  # type: ignore[arg-type, no-any-return]


COARSE: dict[str, Generated] = {}


def coarse(kind: str) -> Generated:
    """Return a source whose worlds are quick to draw."""
    if kind not in COARSE:
        COARSE[kind] = make(kind, "resolution=0.1", "width=12", "height=10")
    return COARSE[kind]


def clearances(free: np.ndarray, resolution: float) -> np.ndarray:
    """Return how far each cell is from the edge of what is blocked, m."""
    return np.asarray(ndimage.distance_transform_edt(np.pad(free, 1))[1:-1, 1:-1] - 0.5) * resolution


def places(grid: OccupancyGrid, radius: float) -> int:
    """Count the connected places that a disc can be in; a hair is left for rounding."""
    return int(ndimage.label(clearances(grid.data == FREE, grid.resolution) >= radius - 1e-6)[1])


def mean_clearance(grid: OccupancyGrid) -> float:
    free = grid.data == FREE
    return float(clearances(free, grid.resolution)[free].mean())


@pytest.mark.parametrize("kind", KINDS)
@EXACT
@given(SEEDS, st.floats(0.0, 1.0), st.sampled_from((0.1, 0.2, 0.35)))
def test_all_places_of_the_robot_are_connected(kind: str, seed: int, difficulty: float, radius: float) -> None:
    source = replace(coarse(kind), difficulty=difficulty, robot_radius=radius)
    grid = source.world(seed, 0).grid
    assert places(grid, radius) == 1
    assert ndimage.label(grid.data == FREE)[1] == 1
    assert (grid.data == FREE)[2:-2, 2:-2].mean() >= source.least_share
    edge = np.ones(grid.data.shape, bool)
    edge[2:-2, 2:-2] = False
    assert grid.occupied[edge].all()


@EXACT
@given(SEEDS, st.floats(0.2, 0.8), st.floats(0.0, 0.6))
def test_what_a_disc_reaches_is_kept_in_any_clutter(seed: int, share: float, radius: float) -> None:
    free = np.random.default_rng(seed).random((40, 30)) < share
    kept = keep_reachable(free, 0.1, radius)
    room = clearances(kept, 0.1) >= radius - 1e-6
    assert ndimage.label(room)[1] <= 1
    assert ndimage.label(kept)[1] == int(room.any())
    largest = np.bincount(ndimage.label(clearances(free, 0.1) >= radius - 1e-6)[0].ravel())[1:].max(initial=0)
    assert room.sum() >= largest


@pytest.mark.parametrize("kind", KINDS)
def test_same_seed_gives_the_same_world_bit_for_bit(kind: str) -> None:
    one, other = (
        make(kind, "width=8", "height=8").world(5, 0).grid,
        make(kind, "width=8", "height=8", "draws=11").world(5, 0).grid,
    )
    assert one is not other
    assert one.data.tobytes() == other.data.tobytes()
    assert (one.data != make(kind, "width=8", "height=8").world(6, 0).grid.data).any()


@pytest.mark.parametrize("kind", KINDS)
def test_same_request_gives_the_same_grid_object(kind: str) -> None:
    assert make(kind).world(5, 2).grid is make(kind, "known=false", "regenerate=0").world(5, 3).grid


@pytest.mark.parametrize("kind", KINDS)
def test_new_world_every_so_many_scenarios(kind: str) -> None:
    every_third, every, fixed = (make(kind, "resolution=0.1", f"regenerate={n}") for n in (3, 1, 0))
    assert every_third.world(0, 2).grid is fixed.world(0, 7).grid is every.world(0, 0).grid
    assert every_third.world(0, 3).grid is every_third.world(0, 5).grid is every.world(0, 1).grid
    assert (every.world(0, 1).grid.data != every.world(0, 0).grid.data).any()


@pytest.mark.parametrize("kind", KINDS)
def test_harder_is_harder(kind: str) -> None:
    means = [
        np.mean([mean_clearance(coarse(kind).at(d).world(seed, 0).grid) for seed in range(12)])
        for d in (0.0, 0.35, 0.7, 1.0)
    ]
    assert np.all(np.diff(means) < 0.0), means


@pytest.mark.parametrize("kind", KINDS)
def test_another_difficulty_is_that_of_its_own_parameter(kind: str) -> None:
    assert (
        coarse(kind).at(0.8).world(1, 0).grid
        is make(kind, "resolution=0.1", "width=12", "height=10", "difficulty=0.8").world(1, 0).grid
    )
    with pytest.raises(ConfigurationError, match=r"difficulty is 1\.5; allowed: 0 \.\. 1"):
        coarse(kind).at(1.5)


@pytest.mark.parametrize(
    ("kind", "given"),
    [
        ("indoor", ("corridor_width=1.5", "iterations=9")),
        ("outdoor", ("obstacles=7", "obstacle_size=1.1")),
        ("rooms", ("rooms=4", "door_width=1.0", "loops=0.3", "furniture=5", "furniture_size=0.9")),
        ("cellular", ("fill=0.1",)),
    ],
)
def test_value_of_its_own_overrides_difficulty(kind: str, given: Sequence[str]) -> None:
    source = make(kind, "resolution=0.1", *given)
    assert (source.at(0.1).world(3, 0).grid.data == source.at(0.9).world(3, 0).grid.data).all()


@EXACT
@given(SEEDS, st.floats(0.9, 4.0), st.integers(1, 30))
def test_corridors_are_as_wide_as_asked(seed: int, width: float, iterations: int) -> None:
    source = replace(
        coarse("indoor"), width=15.0, height=15.0, least_share=0.0, corridor_width=width, iterations=iterations
    )
    room = clearances(source.world(seed, 0).grid.data == FREE, 0.1) >= width / 2 - 0.15
    sizes = np.bincount(ndimage.label(room)[0].ravel())[1:]
    assert sizes.max() >= 0.95 * sizes.sum()  # where corridors touch, a corner can be wide enough by itself


def test_open_ground_without_obstacles_is_all_free() -> None:
    assert (make("outdoor", "resolution=0.1", "obstacles=0").world(0, 0).grid.data == FREE).sum() == 150 * 150


@EXACT
@given(SEEDS, st.integers(1, 9), st.floats(0.9, 1.5))
def test_every_room_can_be_entered(seed: int, rooms: int, door_width: float) -> None:
    source = replace(coarse("rooms"), furniture=0, least_side=2.0, rooms=rooms, door_width=door_width, loops=0.0)
    free = source.world(seed, 0).grid.data == FREE
    assert ndimage.label(clearances(free, 0.1) > door_width / 2 + 0.06)[1] == rooms
    assert free.sum() <= (replace(source, loops=1.0).world(seed, 0).grid.data == FREE).sum()


def test_furniture_leaves_passages_as_wide_as_doors() -> None:
    for seed in range(10):
        grid = make("rooms", "difficulty=1.0", "door_width=1.2", "resolution=0.1").world(seed, 0).grid
        assert places(grid, 0.55) == 1
        assert places(grid, 0.7) > 1


def test_automaton_keeps_clumps_and_clears_single_cells() -> None:
    cells = np.zeros((7, 7), bool)
    cells[1, 1] = True
    cells[3:6, 3:6] = True
    cells[4, 4] = False
    after = smooth_cells(cells)
    assert not after[1, 1]
    assert after[4, 4]
    assert after[3:6, 3:6].all()


@pytest.mark.parametrize(
    ("kind", "words", "message"),
    [
        ("indoor", ("corridor_width=16",), r"world\.corridor_width is 16; allowed: .*15 m"),
        (
            "indoor",
            ("corridor_width=0.6",),
            r"world\.corridor_width is 0\.6: no free space for the robot; allowed: from 0\.8 m on",
        ),
        ("indoor", ("robot_radius=1.2",), r"world\.by_difficulty\.corridor_width gives 2: no free space for the robot"),
        ("outdoor", ("obstacle_size=8",), r"world\.obstacle_size is 8; allowed: .*7\.5 m"),
        (
            "outdoor",
            ("obstacles=300", "obstacle_size=3"),
            r"world outdoor: no free space for the robot \(.*\d% of the hall\); allowed: least_share, 30%, or more",
        ),
        ("rooms", ("door_width=0.5",), r"world\.door_width is 0\.5: no free space for the robot"),
        ("rooms", ("least_side=1",), r"world\.least_side is 1; allowed: from a door and its posts on, 1\.45 m"),
        ("rooms", ("furniture=1000000000",), r"world\.furniture is 1000000000; allowed: .*10000"),
        ("rooms", ("rooms=60",), r"world\.rooms is 60; allowed: as many as fit with least_side 2\.4 m"),
        ("cellular", ("cell=0.01",), r"world\.cell is 0\.01; allowed: "),
        ("cellular", ("fill=0.6",), r"no free space for the robot"),
        ("cellular", ("difficulty=1.5",), r"world\.difficulty is 1\.5; allowed: 0 \.\. 1"),
        ("cellular", ("width=0.4", "height=0.4"), r"no free space for the robot"),
        ("indoor", ("width=1e6", "height=1e6", "iterations=3"), r"world\.width is 1e\+06"),
    ],
)
def test_impossible_worlds_are_refused_before_one_is_asked_for(kind: str, words: Sequence[str], message: str) -> None:
    with pytest.raises(ConfigurationError, match=message) as caught:
        make(kind, *words)
    assert "\n" not in str(caught.value)


def test_parameters_are_listed_with_units() -> None:
    for kind in KINDS:
        node: dict[str, Any] = dict(compose([], f"world/{kind}").world)
        assert node["difficulty"] == 0.5
        assert node["regenerate"] is None


@pytest.mark.parametrize(
    ("preset", "released"),
    [("indoor_as_released", (283.0, 2.8, 2.8, 4.4, 0.51)), ("outdoor_as_released", (477.0, 2.0, 2.6, 8.8, 0.34))],
)
def test_worlds_as_released_have_the_measures_of_the_released_maps(preset: str, released: tuple[float, ...]) -> None:
    source = make(preset)
    found = [widths_of(np.pad(source.world(seed, 0).grid.data == FREE, 1), 0.1) for seed in range(4)]
    assert np.abs(np.array(found) / released - 1.0).max() <= 0.15
    assert source.world(0, 0).grid.resolution == 0.1


@pytest.mark.parametrize("kind", ["indoor", "outdoor"])
def test_worlds_as_in_the_paper_are_fifteen_metres_wide(kind: str) -> None:
    assert make(f"{kind}_as_paper").world(0, 0).grid.data.shape == (304, 304)


def test_squares_keep_the_gaps_that_they_are_given() -> None:
    source = make("outdoor", "resolution=0.1", "obstacles=5", "obstacle_size=2", "gaps={least: 1.0, most: 1.4}")
    for seed in range(5):
        free = source.world(seed, 0).grid.data == FREE
        squares, count = ndimage.label(~free[2:-2, 2:-2])
        assert count == 5
        for number in range(1, 6):
            others = np.pad(squares != number, 2) & np.pad(squares > 0, 2)
            edge = np.pad(np.zeros(squares.shape, bool), 2, constant_values=True)
            away = ndimage.distance_transform_edt(~(others | edge))[2:-2, 2:-2][squares == number].min() * 0.1
            assert 0.9 <= away <= 1.6  # from cell to cell: up to a cell less or more, and one more between centres


def test_worlds_that_are_like_none_drawn_are_refused() -> None:
    like = "like={free: 200, width_p10: 9, width: 9, width_p90: 9, beside_walls: 0.5, within: 0.1}"
    with pytest.raises(
        ConfigurationError, match=r"world outdoor: 10 draws, none like world\.like \(the last: .*width_p10 \d"
    ) as caught:
        make("outdoor", "resolution=0.1", like)
    assert "\n" not in str(caught.value)
    with pytest.raises(ConfigurationError, match=r"world\.gaps\.most is 1; allowed: from world\.gaps\.least on, 2 m"):
        make("outdoor", "gaps={least: 2, most: 1}")
    with pytest.raises(ConfigurationError, match=r"no place for square \d+ within world\.gaps"):
        make("outdoor", "resolution=0.1", "obstacles=60", "gaps={least: 1.9, most: 2.1}")
