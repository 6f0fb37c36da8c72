"""Flatland worlds by any name, and several layers as one map; maps of photographs' formats."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
from numpy.typing import NDArray
from PIL import Image

from arena_core import InputFileError, OccupancyGrid, Pose, tell
from arena_worlds.merged import merged
from arena_worlds.ros_map import load_map
from arena_worlds.site_file import read_site

cells = arrays.arrays(np.int8, st.tuples(st.integers(1, 9), st.integers(1, 9)), elements=st.sampled_from((-1, 0, 50, 100)))
poses = st.builds(Pose, st.floats(-5, 5), st.floats(-5, 5), st.floats(-3, 3))


def layer(folder: Path, name: str, pixels: object, origin: tuple[float, ...] = (0.0, 0.0, 0.0), resolution: float = 0.5) -> None:
    """Write a map: row 0 of ``pixels`` is its top; 0 is a wall, 254 free, 205 unknown."""
    Image.fromarray(np.array(pixels, np.uint8)).save(folder / f"{name}.png")
    (folder / f"{name}.yaml").write_text(
        f"image: {name}.png\nresolution: {resolution}\norigin: {list(origin)}\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"
    )


WORLD = "properties: {}\nlayers:\n- {name: static, map: a.yaml, color: [0, 1, 0, 1]}\n- {name: [upper, other], map: b.yaml}\n"


@pytest.fixture
def two(tmp_path: Path) -> Path:
    layer(tmp_path, "a", [[254, 0, 205], [254, 254, 205]])
    layer(tmp_path, "b", [[254, 254, 254], [0, 254, 205]])
    return tmp_path


@pytest.mark.parametrize("name", ["hall.world.yaml", "hall.yaml", "world.yml", "map.world.yaml"])
def test_a_flatland_world_is_told_by_its_layers_whatever_its_name(two: Path, name: str) -> None:
    (two / name).write_text(WORLD)
    assert load_map(two / name).data.tolist() == [[100, 0, -1], [0, 100, 0]]


def test_a_folder_with_one_world_is_that_world(two: Path) -> None:
    (two / "hall.world.yaml").write_text(WORLD)
    assert load_map(two).data.tolist() == [[100, 0, -1], [0, 100, 0]]
    (two / "yard.world.yaml").write_text(WORLD)
    with pytest.raises(InputFileError, match=r"map\.yaml: cannot be read"):
        load_map(two)


def test_a_wrapped_world_and_a_wrapped_map_are_read(two: Path) -> None:
    text = (two / "a.yaml").read_text()
    (two / "a.yaml").write_text("/**:\n  ros__parameters:\n" + "".join(f"    {line}\n" for line in text.splitlines()))
    (two / "hall.yaml").write_text("/**:\n  ros__parameters:\n" + "".join(f"    {line}\n" for line in WORLD.splitlines()))
    assert load_map(two / "hall.yaml").data.tolist() == [[100, 0, -1], [0, 100, 0]]


def test_models_of_a_world_are_told_to_be_left_out(two: Path, capsys) -> None:
    tell.cache_clear()
    (two / "hall.yaml").write_text(WORLD + "models: [{name: robot, model: robot.model.yaml}]\n")
    load_map(two / "hall.yaml")
    assert "hall.yaml: models are not read, only layers" in capsys.readouterr().err


def test_the_same_layers_give_the_same_grid_until_one_changes(two: Path) -> None:
    (two / "hall.yaml").write_text(WORLD)
    first = load_map(two / "hall.yaml")
    assert load_map(two / "hall.yaml") is first
    layer(two, "b", [[254, 254, 254], [254, 254, 254], [254, 254, 254]])
    assert load_map(two / "hall.yaml").data.shape == (3, 3)


def test_layers_of_other_places_and_cells_are_laid_over_each_other(tmp_path: Path) -> None:
    layer(tmp_path, "a", [[254, 254], [254, 254]], (0.0, 0.0, 0.0), 1.0)
    layer(tmp_path, "b", [[0, 254]], (1.5, 1.5, 0.0), 0.5)
    (tmp_path / "w.yaml").write_text(WORLD)
    grid = load_map(tmp_path / "w.yaml")
    assert (grid.resolution, grid.data.shape, grid.origin) == (0.5, (4, 5), Pose(0.0, 0.0))
    assert np.argwhere(grid.occupied).tolist() == [[3, 3]]
    assert grid.data[3, 4] == 0
    assert (grid.data[:3, 4] == -1).all()


@given(data=cells)
@settings(deadline=None)
def test_a_map_merged_with_itself_is_itself(data: NDArray[np.int8]) -> None:
    grid = OccupancyGrid(data, 0.05, Pose(-1.3, 2.7, 0.4))
    found = merged([grid, grid], "w")
    assert found.data.tolist() == data.tolist()
    assert found.origin.array() == pytest.approx(grid.origin.array(), abs=1e-6)


@given(first=cells, second=cells, pose=poses, resolution=st.sampled_from((0.5, 1.0, 0.3)))
@settings(deadline=None)
def test_no_wall_of_any_layer_is_lost(first: NDArray[np.int8], second: NDArray[np.int8], pose: Pose, resolution: float) -> None:
    grids = [OccupancyGrid(first, 0.5, Pose(0.0, 0.0, 0.2)), OccupancyGrid(second, resolution, pose)]
    found = merged(grids, "w")
    for grid in grids:
        walls = found.cells(grid.positions(np.argwhere(grid.occupied)))
        assert found.contains(walls).all()
        assert found.occupied[tuple(walls.T)].all()
    assert found.occupied.sum() == 0 or any(grid.occupied.any() for grid in grids)


def test_layers_too_far_apart_are_one_line() -> None:
    grids = [OccupancyGrid(np.zeros((2, 2), np.int8), 0.05, Pose(x, 0.0)) for x in (0.0, 1e6)]
    grids.append(OccupancyGrid(np.zeros((2, 2), np.int8), 0.05, Pose(0.0, 1e3)))
    with pytest.raises(InputFileError, match=r"^far: its layers together have 20000002 x 20002 cells; allowed: 50000000 in all$"):
        merged(grids, "far")


@pytest.mark.parametrize("ending", ["jpg", "jpeg", "gif", "tif", "webp", "bmp"])
def test_maps_may_be_in_other_formats_of_pictures(tmp_path: Path, ending: str) -> None:
    pixels = np.full((40, 60), 254, np.uint8)
    pixels[10:30, 20:24] = 0
    Image.fromarray(pixels).save(tmp_path / f"map.{ending}")
    (tmp_path / "map.yaml").write_text(
        f"image: map.{ending}\nresolution: 0.1\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"
    )
    grid = load_map(tmp_path / "map.yaml")
    inside = np.zeros((40, 60), bool)
    inside[11:29, 21:23] = True  # a pixel off the edges, which a lossy format blurs
    assert grid.occupied[inside[::-1]].all()
    assert not grid.occupied[(pixels == 254)[::-1] & ~np.roll(inside, 1, axis=1)[::-1]].sum() > 90
    assert isinstance(read_site(tmp_path / f"map.{ending}", 0.1), OccupancyGrid)


def test_a_picture_of_another_format_is_refused_in_one_line(tmp_path: Path) -> None:
    Image.new("L", (3, 3)).save(tmp_path / "map.ico")
    (tmp_path / "map.yaml").write_text(
        "image: map.ico\nresolution: 0.1\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"
    )
    with pytest.raises(InputFileError, match=r"map\.ico: is no image .*allowed: PGM, PNG, BMP, JPEG, GIF, TIFF or WebP"):
        load_map(tmp_path / "map.yaml")
