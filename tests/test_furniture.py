"""Furniture: what of it is met at which height, and what records keep of it."""

import numpy as np
import pytest
import yaml
from shapely import Polygon, unary_union

from arena_core import ConfigurationError, OccupancyGrid, Pose, World
from arena_core.files import option_files
from arena_core.hosting import load_registry
from arena_core.scenes import (
    FurnitureKind,
    add_furniture,
    furniture_kind,
    furniture_of,
    furniture_outlines,
    furniture_scene,
    furniture_shapes,
    scene_of,
)
from arena_core.testing import furniture, room
from arena_core.values.furniture import furniture_meta

KINDS = list(option_files("furniture", load_registry().manager))
LIDARS = (0.18, 0.2, 0.25)  # m; heights of the suite's lidars, and that of sim2d


def area(shapes):
    polygons = [Polygon(s.vertices_xy) for s in shapes if len(s.vertices_xy) > 1]
    return unary_union(polygons).area + sum(np.pi * s.radius**2 for s in shapes if len(s.vertices_xy) == 1)


@pytest.mark.parametrize("kind", KINDS)
def test_lidars_see_legs_where_bodies_meet_tops(kind):
    piece = furniture(kind, 1.0, 2.0, 0.3)
    slices = [area(furniture_outlines([piece], height, height)) for height in LIDARS]
    assert slices[0] > 0.0
    assert slices == pytest.approx([slices[0]] * len(LIDARS), abs=1e-12)  # both simulators see the same
    assert area(furniture_outlines([piece], 0.0, 2.0)) > 10.0 * slices[0]


def test_low_robot_meets_the_legs_of_a_table_and_a_high_one_its_top():
    table = furniture("table", 0.0, 0.0)
    assert len(furniture_outlines([table], 0.0, 0.3)) == 4
    assert area(furniture_outlines([table], 0.0, 0.8)) > 1.28


def test_outlines_are_turned_and_moved_with_the_piece():
    top = furniture_outlines([furniture("table", 1.0, 2.0, 0.5 * np.pi)], 0.72, 0.72)[0].vertices_xy
    assert top.min(axis=0) == pytest.approx((0.6, 1.2))
    assert top.max(axis=0) == pytest.approx((1.4, 2.8))


def test_scene_has_the_solids_in_the_frame_of_the_map():
    origin = Pose(-3.0, 1.0, 0.4)
    grid = OccupancyGrid(np.zeros((40, 40), np.int8), 0.1, origin)
    pieces = (furniture("chair", -2.0, 2.0, 0.7), furniture("table", 0.0, 2.0))
    scene = scene_of(grid, (), 2.0, pieces)
    assert len(scene.boxes) == 7
    assert len(scene.cylinders) == 4
    seat = origin.compose(Pose(*scene.boxes[0, :3]))
    assert (seat.x, seat.y, seat.theta) == pytest.approx((-2.0, 2.0, 0.7))
    assert furniture_scene(pieces, origin).boxes.tolist() == scene.boxes.tolist()


def test_nobody_stands_where_furniture_is():
    world = World("room", room(), furniture=(furniture("table", 1.0, 0.0),))
    standing = add_furniture(world)
    assert standing.occupied[tuple(standing.cells((1.0, 0.0)))]
    assert not world.grid.occupied[tuple(world.grid.cells((1.0, 0.0)))]
    assert add_furniture(world) is standing
    assert add_furniture(World("room", world.grid)) is world.grid


def test_record_gives_furniture_back():
    pieces = (furniture("shelf", 1.0, 2.0, 0.3), furniture("table", 0.0, 0.0))
    again = furniture_of({"furniture": list(map(furniture_meta, pieces))})
    assert [piece.kind for piece in again] == ["shelf", "table"]
    assert [piece.pose for piece in again] == [piece.pose for piece in pieces]
    assert again[0].boxes.tolist() == pieces[0].boxes.tolist()
    assert furniture_of({}) == ()


def test_pictures_show_tops_before_legs():
    shapes = furniture_shapes([furniture("table", 0.0, 0.0)])
    assert [bool(shape.get("overhang")) for shape in shapes] == [True] * 5 + [False] * 4


@pytest.mark.parametrize(
    ("boxes", "said"),
    [
        ({}, "has no solids"),
        ({"top": [0.0, 0.0, 1.0, 1.0, 0.7]}, "boxes.top is"),
        ({"top": [0.0, 0.0, 1.0, 0.0, 0.7, 0.8]}, "extents > 0"),
        ({"top": [0.0, 0.0, 1.0, 1.0, 0.8, 0.8]}, "bottom < top"),
    ],
)
def test_solid_without_an_extent_is_refused(boxes, said):
    with pytest.raises(ConfigurationError, match=said):
        FurnitureKind(boxes, {}).at("desk", Pose(0.0, 0.0))


def test_kind_of_ones_own_is_found_in_the_working_directory(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(ConfigurationError, match=r"furniture is 'stool'; allowed: chair, shelf, table"):
        furniture_kind("stool")
    (tmp_path / "conf" / "furniture").mkdir(parents=True)
    (tmp_path / "conf" / "furniture" / "stool.yaml").write_text(
        yaml.safe_dump({"boxes": {}, "cylinders": {"it": [0, 0, 0.2, 0.0, 0.4]}})
    )
    furniture_kind.__globals__["_read_kind"].cache_clear()
    assert furniture_kind("stool").cylinders == {"it": [0.0, 0.0, 0.2, 0.0, 0.4]}
