"""Built-in halls are closed, connected and wide enough."""

from importlib.resources import files
from typing import Any

import numpy as np
import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import ndimage

from arena_core import FREE, ConfigurationError, OccupancyGrid, WorldSource
from arena_core.hosting import load_registry
from arena_worlds import config_package, register_worlds

EXACT = settings(derandomize=True, deadline=None, max_examples=25)
SOURCES = ("empty", "warehouse", "lab")


def figures(name: str) -> dict[str, Any]:
    return dict(yaml.safe_load((files(config_package()) / "world" / f"{name}.yaml").read_text()))


def make(name: str, **changes: object) -> WorldSource:
    built: WorldSource = load_registry().build("world", {**figures(name), **changes})
    return built


def free_places(grid: OccupancyGrid, clearance: float = 0.0) -> int:
    """Count the connected places that a disc of radius ``clearance`` m can be in."""
    away = ndimage.distance_transform_edt(~grid.occupied) * grid.resolution
    return int(ndimage.label(away > clearance + grid.resolution / 2)[1])


def is_closed(grid: OccupancyGrid) -> bool:
    edge = np.ones(grid.data.shape, bool)
    edge[2:-2, 2:-2] = False
    return bool(grid.occupied[edge].all())


def test_hooks_offer_every_yaml_file() -> None:
    registered: list[str] = []
    register_worlds(lambda name, factory: registered.append(name))
    named = {yaml.safe_load(file.read_text())["name"] for file in (files(config_package()) / "world").iterdir()}
    assert sorted(registered) == sorted(named)


@pytest.mark.parametrize("name", SOURCES)
def test_world_is_closed_and_all_its_free_space_connected(name: str) -> None:
    world = make(name).world(seed=3, index=0)
    assert world.name == name
    assert is_closed(world.grid)
    assert free_places(world.grid) == 1


@pytest.mark.parametrize("name", SOURCES)
def test_same_request_gives_the_same_grid_object(name: str) -> None:
    assert make(name).world(5, 2).grid is make(name, known=False).world(5, 2).grid


@pytest.mark.parametrize("name", SOURCES)
def test_fixed_world_does_not_depend_on_seed_or_index(name: str) -> None:
    source = make(name)
    assert source.world(0, 0) is source.world(1, 9)


def test_inner_corner_is_the_origin_of_the_map() -> None:
    grid = make("empty", width=4.0, height=3.0, resolution=0.1).world(0, 0).grid
    free = grid.positions(np.argwhere(grid.data == FREE))
    assert free.min(axis=0) == pytest.approx((0.05, 0.05))
    assert free.max(axis=0) == pytest.approx((3.95, 2.95))


def test_warehouse_has_twenty_metres_and_racks() -> None:
    grid = make("warehouse").world(0, 0).grid
    inside = grid.occupied[2:-2, 2:-2]
    assert inside.shape == (400, 400)
    count = ndimage.label(inside)[1]
    assert count == 15 - 2
    assert 0.08 < inside.mean() < 0.2


def test_robot_passes_a_person_in_every_aisle_of_the_warehouse() -> None:
    grid = make("warehouse").world(0, 0).grid
    # side by side they need 2 * 0.27 + 2 * 0.3 m, so half of that on either side of their middle, all around every rack
    assert free_places(grid, 0.57) == 1
    assert free_places(grid, 1.2) == 1
    blocked = ~(ndimage.distance_transform_edt(~grid.occupied) * grid.resolution > 1.2)
    assert ndimage.label(blocked[10:-10, 10:-10])[1] >= 13, "a rack is joined to another or to the wall"


def test_racks_differ_so_that_aisles_can_be_told_apart() -> None:
    inside = make("warehouse").world(0, 0).grid.occupied
    racks, count = ndimage.label(inside[2:-2, 2:-2])
    outlines = {inside[2:-2, 2:-2][place].tobytes() for place in ndimage.find_objects(racks)}
    assert len(outlines) == count


@EXACT
@given(st.floats(6.6, 30.0), st.floats(8.4, 30.0), st.floats(1.0, 2.5), st.floats(0.5, 1.5))
def test_aisles_are_never_narrower_than_asked(width: float, height: float, aisle: float, depth: float) -> None:
    bay = min(0.15, depth / 3)
    grid = make(
        "warehouse",
        width=width,
        height=height,
        aisle_width=aisle,
        rack_depth=depth,
        bay_recess=bay,
        open_places=0,
        resolution=0.1,
    )
    room = grid.world(0, 0).grid
    assert is_closed(room)
    assert free_places(room, aisle / 2 - 0.2) == 1  # a cell and a half is lost to rounding


@pytest.mark.parametrize(
    ("name", "changes", "message"),
    [
        ("empty", {"width": 1e6, "height": 1e6}, r"world\.width is 1e\+06"),
        ("empty", {"width": 0.01}, r"world\.width is 0\.01"),
        ("warehouse", {"width": 5.0}, r"world\.width is 5; allowed: .*6 m"),
        ("warehouse", {"height": 8.0}, r"world\.height is 8; allowed: .*8\.3 m"),
        ("warehouse", {"bay_recess": 0.5}, r"world\.bay_recess is 0\.5; allowed: below"),
        ("warehouse", {"open_places": 15}, r"world\.open_places is 15; allowed: below the number of racks, 15"),
    ],
)
def test_impossible_measures_are_one_line(name: str, changes: dict[str, float], message: str) -> None:
    with pytest.raises(ConfigurationError, match=message):
        make(name, **changes).world(0, 0)
