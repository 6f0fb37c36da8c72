"""Maps load, drawn ones and real ones, and the same file gives the same grid."""

import os
import shutil
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from arena_core import ConfigurationError, InputFileError, Pose
from arena_worlds.formats.ros_map import RosMap, load_map

MAPS = Path(__file__).parents[3].parent / "shared" / "data" / "maps"
DRAWN = Path(__file__).parents[3] / "tests" / "data" / "maps"
needs_maps = pytest.mark.skipif(not MAPS.is_dir(), reason="the collection of public maps is not at ../shared/data/maps")
LOADABLE = [
    "aws_bookstore/turtlebot3_waffle_pi/map.yaml",
    "aws_small_warehouse/005/map.yaml",
    "arena_bench/map5/arena-tools/map.yaml",
    "arena_bench/map5/arena-tools/map.world.yaml",
    "arena_bench/map5/arena-tools",
    "arena_bench/map5/map.yaml",
    "arena_bench/small_warehouse/map.yaml",
    "arena_bench/small_warehouse/obs_map.yaml",
    "nav2/depot.yaml",
    "nav2/tb3_sandbox.yaml",
    "nav2/testmap.yaml",
    "navrep/asl.yaml",
    "navrep/crowdmove1.yaml",
    "navrep/crowdmove2.yaml",
    "navrep/markclutter.yaml",
    "navrep/markmaze.yaml",
    "turtlebot3/map.yaml",
]
LETTER = """\
.....####.
........#.
.#......#.
.#........
.#........
.#####....
.#........
.#........
.######...
.........."""
# navigation2's nav2_map_server tests: the 10 x 10 map's occupied cells, first row at the bottom
TESTMAP = """\
..........
####..###.
####..###.
#.........
#.........
#.....##..
#.....##..
#.....##..
#.....##..
#........."""


def small_map(folder: Path, origin: str = "[0, 0, 0]") -> Path:
    Image.fromarray(np.array([[0, 254, 205], [254, 254, 254]], np.uint8)).save(folder / "map.pgm")
    path = folder / "site.yaml"
    path.write_text(
        f"image: map.pgm\nresolution: 0.5\norigin: {origin}\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"
    )
    return path


@needs_maps
def test_every_map_of_the_collection_is_tried() -> None:
    offered = {str(path.relative_to(MAPS)) for path in MAPS.rglob("*.yaml")}
    assert offered == {name for name in LOADABLE if name.endswith(".yaml")}


def both(drawn: list[str], real: list[str]) -> list[object]:
    """Return the maps of both collections as parameters."""
    there = [pytest.param(DRAWN / name, id=f"drawn-{name}") for name in drawn]
    return [*there, *(pytest.param(MAPS / name, id=f"real-{name}", marks=needs_maps) for name in real)]


@pytest.mark.parametrize(
    "path", both(["hall/map.yaml", "letter/letter.yaml", "flatland/map.world.yaml", "flatland"], LOADABLE)
)
def test_map_of_a_site_loads(path: Path) -> None:
    grid = load_map(path)
    assert set(np.unique(grid.data).tolist()) <= {-1, 0, 100}
    assert (grid.data == 0).any()
    assert grid.occupied.any() != (path.name == "crowdmove1.yaml")  # that one is a blank sheet
    assert 0.04 <= grid.resolution <= 0.25


@pytest.mark.parametrize(
    ("path", "cells"),
    [
        pytest.param(DRAWN / "letter/letter.yaml", LETTER, id="drawn"),
        pytest.param(MAPS / "nav2/testmap.yaml", TESTMAP, id="real", marks=needs_maps),
    ],
)
def test_known_cells_of_a_map(path: Path, cells: str) -> None:
    grid = load_map(path)
    assert "\n".join("".join("#" if value == 100 else "." for value in row) for row in grid.data.tolist()) == cells
    assert set(np.unique(grid.data).tolist()) == {0, 100}
    assert grid.origin == Pose(2.0, 3.0, 1.0)


@pytest.mark.parametrize("ending", ["pgm", "bmp"])
@pytest.mark.parametrize("path", both(["letter/letter.yaml"], ["nav2/testmap.yaml"]))
def test_png_pgm_and_bmp_give_the_same_map(tmp_path: Path, path: Path, ending: str) -> None:
    shutil.copy(path.with_suffix(f".{ending}"), tmp_path)
    (tmp_path / "map.yaml").write_text(path.read_text().replace(f"{path.stem}.png", f"{path.stem}.{ending}"))
    assert (load_map(tmp_path / "map.yaml").data == load_map(path).data).all()


@pytest.mark.parametrize("folder", both(["flatland"], ["arena_bench/map5/arena-tools"]))
def test_flatland_world_is_the_map_of_its_layers(folder: Path) -> None:
    assert (
        load_map(folder / "map.world.yaml").data.tolist()
        == load_map(folder).data.tolist()
        == load_map(folder / "map.yaml").data.tolist()
    )


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("properties: {}", "layers is None; allowed: layers"),
        ("layers: [static]", "layers is .*; allowed: layers"),
        ("layers: [{name: static}]", r"layers have the maps \[\]; allowed"),
        ("layers: [{map: a.yaml}, {map: b.yaml}]", "a.yaml: cannot be read"),
        ("layers: [{map: 3}]", r"layers have the maps \[3\]"),
        ("layers: [{map: gone.yaml}]", "gone.yaml: cannot be read"),
    ],
)
def test_flatland_world_without_a_map_is_refused(tmp_path: Path, text: str, said: str) -> None:
    (tmp_path / "map.world.yaml").write_text(text)
    with pytest.raises(InputFileError, match=said):
        load_map(tmp_path)


def test_yaml_whose_image_is_missing_is_refused(tmp_path: Path) -> None:
    shutil.copy(DRAWN / "hall/map.yaml", tmp_path)
    with pytest.raises(InputFileError, match=r"map\.yaml: image map\.pgm is not there"):
        load_map(tmp_path / "map.yaml")


def test_cells_lie_where_origin_and_yaw_put_them(tmp_path: Path) -> None:
    grid = load_map(small_map(tmp_path, "[2.0, 3.0, 1.5707963267948966]"))
    assert grid.data.tolist() == [[0, 0, 0], [100, 0, -1]]
    row, column = np.argwhere(grid.data == 100)[0]
    # turned by a quarter: columns run along y, rows along -x
    assert grid.positions((row, column)) == pytest.approx((2.0 - 0.75, 3.0 + 0.25))


def test_same_file_gives_the_same_grid(tmp_path: Path) -> None:
    path = str(small_map(tmp_path))
    first, second = RosMap(path, known=True), RosMap(path, known=False)
    assert first.world(0, 0).grid is second.world(7, 3).grid
    assert first.world(0, 0).known
    assert not second.world(0, 0).known
    assert first.world(0, 0).name == f"{tmp_path.name}/site"


def test_changed_image_is_read_again(tmp_path: Path) -> None:
    path = small_map(tmp_path)
    before = load_map(path)
    Image.fromarray(np.full((2, 3), 254, np.uint8)).save(tmp_path / "map.pgm")
    os.utime(tmp_path / "map.pgm", (1, 1))
    after = load_map(path)
    assert before.occupied.any()
    assert not after.occupied.any()


def test_path_must_be_given() -> None:
    with pytest.raises(ConfigurationError, match=r"world\.path is null; allowed: .*world\.path=site\.yaml"):
        RosMap(None, known=True)
