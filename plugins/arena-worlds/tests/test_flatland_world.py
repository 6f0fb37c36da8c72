"""Flatland worlds by any name, and several layers as one map; maps of photographs' formats."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
from numpy.typing import NDArray
from PIL import Image

from arena_core import InputFileError, OccupancyGrid, Pose
from arena_core.commands import print_notice
from arena_worlds.formats.map_merge import merge_maps
from arena_worlds.formats.ros_map import load_map
from arena_worlds.formats.site_file import read_site

cells = arrays.arrays(
    np.int8, st.tuples(st.integers(1, 9), st.integers(1, 9)), elements=st.sampled_from((-1, 0, 50, 100))
)
poses = st.builds(Pose, st.floats(-5, 5), st.floats(-5, 5), st.floats(-3, 3))


def layer(
    folder: Path, name: str, pixels: object, origin: tuple[float, ...] = (0.0, 0.0, 0.0), resolution: float = 0.5
) -> None:
    """Write a map: row 0 of ``pixels`` is its top; 0 is a wall, 254 free, 205 unknown."""
    Image.fromarray(np.array(pixels, np.uint8)).save(folder / f"{name}.png")
    (folder / f"{name}.yaml").write_text(
        f"image: {name}.png\nresolution: {resolution}\norigin: {list(origin)}\nnegate: 0\noccupied_thresh: "
        "0.65\nfree_thresh: 0.196\n"
    )


WORLD = (
    "properties: {}\nlayers:\n- {name: static, map: a.yaml, color: [0, 1, 0, 1]}\n- "
    "{name: [upper, other], map: b.yaml}\n"
)


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
    (two / "hall.yaml").write_text(
        "/**:\n  ros__parameters:\n" + "".join(f"    {line}\n" for line in WORLD.splitlines())
    )
    assert load_map(two / "hall.yaml").data.tolist() == [[100, 0, -1], [0, 100, 0]]


def test_models_of_a_world_are_told_to_be_left_out(two: Path, capsys) -> None:
    print_notice.cache_clear()
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
    found = merge_maps([grid, grid], "w")
    assert found.data.tolist() == data.tolist()
    assert found.origin.array() == pytest.approx(grid.origin.array(), abs=1e-6)


@given(first=cells, second=cells, pose=poses, resolution=st.sampled_from((0.5, 1.0, 0.3)))
@settings(deadline=None)
def test_no_wall_of_any_layer_is_lost(
    first: NDArray[np.int8], second: NDArray[np.int8], pose: Pose, resolution: float
) -> None:
    grids = [OccupancyGrid(first, 0.5, Pose(0.0, 0.0, 0.2)), OccupancyGrid(second, resolution, pose)]
    found = merge_maps(grids, "w")
    for grid in grids:
        walls = found.cells(grid.positions(np.argwhere(grid.occupied)))
        assert found.contains(walls).all()
        assert found.occupied[tuple(walls.T)].all()
    assert found.occupied.sum() == 0 or any(grid.occupied.any() for grid in grids)


def test_layers_too_far_apart_are_one_line() -> None:
    grids = [OccupancyGrid(np.zeros((2, 2), np.int8), 0.05, Pose(x, 0.0)) for x in (0.0, 1e6)]
    grids.append(OccupancyGrid(np.zeros((2, 2), np.int8), 0.05, Pose(0.0, 1e3)))
    with pytest.raises(
        InputFileError, match=r"^far: its layers together have 20000002 x 20002 cells; allowed: 50000000 in all$"
    ):
        merge_maps(grids, "far")


@pytest.mark.parametrize("ending", ["jpg", "jpeg", "gif", "tif", "webp", "bmp"])
def test_maps_may_be_in_other_formats_of_pictures(tmp_path: Path, ending: str) -> None:
    pixels = np.full((40, 60), 254, np.uint8)
    pixels[10:30, 20:24] = 0
    Image.fromarray(pixels).save(tmp_path / f"map.{ending}")
    (tmp_path / "map.yaml").write_text(
        f"image: map.{ending}\nresolution: 0.1\norigin: [0, 0, 0]\nnegate: "
        "0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"
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
    with pytest.raises(
        InputFileError, match=r"map\.ico: is no image .*allowed: PGM, PNG, BMP, JPEG, GIF, TIFF or WebP"
    ):
        load_map(tmp_path / "map.yaml")


def lines(folder: Path, rows: str, **changes: object) -> Path:
    keys = {"type": "line_segments", "data": "walls.dat", "scale": 0.5, "origin": [1.0, 2.0, 0.0], **changes}
    (folder / "lines.yaml").write_text("".join(f"{key}: {value}\n" for key, value in keys.items()))
    (folder / "walls.dat").write_text(rows)
    (folder / "w.yaml").write_text("layers:\n- {name: lines, map: lines.yaml}\n")
    return folder / "w.yaml"


def test_a_layer_of_lines_is_walls_where_they_run(tmp_path: Path) -> None:
    grid = load_map(lines(tmp_path, "0 0.05 4.05 0.05\n\n4.05 0.05 4.05 2.05\n", origin=[1.02, 2.0, 0.0]))
    on = np.array([(x, 2.025) for x in np.linspace(1.03, 3.04, 50)] + [(3.045, y) for y in np.linspace(2.03, 3.01, 50)])
    assert grid.occupied[tuple(grid.cells(on).T)].all()
    off = np.array([(1.5, 2.1), (2.9, 2.9), (1.0, 2.9)])
    assert (grid.data[tuple(grid.cells(off).T)] == 0).all()
    assert grid.occupied.sum() == 61


def test_a_slanting_wall_has_no_gaps_at_corners(tmp_path: Path) -> None:
    grid = load_map(lines(tmp_path, "0 0 4 4\n0 4 4 1\n"))
    block = (
        grid.occupied[:-1, :-1].astype(int) * 8
        + grid.occupied[:-1, 1:] * 4
        + grid.occupied[1:, :-1] * 2
        + grid.occupied[1:, 1:]
    )
    assert not np.isin(block, (0b1001, 0b0110)).any()


@given(
    ends=arrays.arrays(float, (5, 4), elements=st.floats(-8, 8)),
    origin=st.tuples(st.floats(-3, 3), st.floats(-3, 3), st.floats(-3, 3)),
)
@settings(deadline=None, max_examples=40)
def test_every_wall_of_lines_is_closed(
    tmp_path_factory: pytest.TempPathFactory, ends: NDArray[np.float64], origin: tuple[float, ...]
) -> None:
    folder = tmp_path_factory.mktemp("lines")
    grid = load_map(
        lines(folder, "".join(" ".join(map(str, row)) + "\n" for row in ends), origin=list(origin), scale=1.0)
    )
    place = Pose(*origin)
    for x1, y1, x2, y2 in ends:
        for share in np.linspace(0.0, 1.0, 30):
            at = place.compose(Pose(x1 + share * (x2 - x1), y1 + share * (y2 - y1)))
            row, column = grid.cells((at.x, at.y))
            assert grid.occupied[max(row - 1, 0) : row + 2, max(column - 1, 0) : column + 2].any()


@pytest.mark.parametrize(
    ("rows", "changes", "said"),
    [
        ("0 0 1\n", {}, r"walls\.dat: has no walls, or rows of other than 4 finite numbers"),
        ("", {}, r"walls\.dat: has no walls"),
        ("0 0 nan 1\n", {}, r"walls\.dat: has no walls, or rows of other than 4 finite"),
        ("0 0 a 1\n", {}, r"walls\.dat: cannot be read"),
        ("0 0 1 1\n", {"scale": 0}, r"lines\.yaml: scale is 0; allowed: > 0"),
        ("0 0 1 1\n", {"data": "gone.dat"}, r"lines\.yaml: data is 'gone\.dat'; allowed: a file with rows"),
        ("0 0 1 1\n", {"origin": [1]}, r"lines\.yaml: origin is \[1\]; allowed"),
        ("0 0 1e6 1e6\n", {}, r"walls\.dat: its walls span 10000002 x 10000002 cells"),
    ],
)
def test_lines_that_cannot_be_read_are_one_line(
    tmp_path: Path, rows: str, changes: dict[str, object], said: str
) -> None:
    with pytest.raises(InputFileError, match=said) as error:
        load_map(lines(tmp_path, rows, **changes))
    assert "\n" not in str(error.value)
