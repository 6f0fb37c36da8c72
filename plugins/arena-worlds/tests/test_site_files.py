"""Worlds go from file to file by their endings, plain pictures among them, and a scenario's map
is found by its folder's name.
"""

import io
import itertools
import json
import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image

from arena_core import ConfigurationError, InputFileError, OccupancyGrid, Pose
from arena_core.cli.main import main
from arena_core.files import LIMITS
from arena_core.hosting import compose
from arena_worlds.formats.file_world import FileWorld
from arena_worlds.formats.map_writer import write_map
from arena_worlds.formats.picture import read_picture, write_picture
from arena_worlds.formats.ros_map import load_map
from arena_worlds.formats.scenario_map import ScenarioMap, find_map
from arena_worlds.formats.site_file import site_grid
from arena_worlds.generators.warehouse import Warehouse, WarehousePlan

DATA = Path(__file__).parents[3].parent / "shared" / "data"
DRAWN = Path(__file__).parents[3] / "tests" / "data"
needs_data = pytest.mark.skipif(
    not DATA.is_dir(), reason="the collection of public maps and scenarios is not at ../shared/data"
)
PICTURES = sorted(
    path for ending in ("png", "pgm", "bmp") for data in (DRAWN, DATA) for path in (data / "maps").rglob(f"*.{ending}")
)
CELLS = np.array([[0, 100, -1, 0], [0, 0, 100, 100]], np.int8)


def refusal(read: Callable[[Path], object], path: Path) -> str | None:
    try:
        read(path)
    except InputFileError as error:
        return str(error)
    return None


def warehouse() -> OccupancyGrid:
    return Warehouse(WarehousePlan(20.0, 20.0, 0.05, 3.3, 1.0, 2.5, 1.1, 0.15, 2), known=True).world(0, 0).grid


@pytest.mark.parametrize("ending", ["png", "pgm"])
def test_a_picture_keeps_free_occupied_and_unknown_cells(tmp_path: Path, ending: str) -> None:
    write_picture(tmp_path / f"w.{ending}", OccupancyGrid(CELLS, 0.1, Pose(1.0, 2.0, 3.0)))
    found = read_picture(tmp_path / f"w.{ending}", 0.2)
    assert found.data.tolist() == CELLS.tolist()
    assert (found.resolution, found.origin) == (0.2, Pose(0.0, 0.0))
    with Image.open(tmp_path / f"w.{ending}") as image:
        assert np.asarray(image).tolist() == [[254, 254, 0, 0], [254, 0, 205, 254]]


def test_shares_of_occupancy_become_walls_from_65_on(tmp_path: Path) -> None:
    write_picture(tmp_path / "w.png", OccupancyGrid(np.array([[1, 64, 65, 99]], np.int8), 0.1, Pose(0.0, 0.0)))
    assert read_picture(tmp_path / "w.png", 0.1).data.tolist() == [[0, 0, 100, 100]]


@pytest.mark.parametrize("path", PICTURES, ids=lambda path: "/".join(path.parts[-3:]))
def test_every_picture_of_the_collection_is_a_world(path: Path) -> None:
    found = FileWorld(str(path), 0.05, 1.0, known=True).world(0, 0).grid
    with Image.open(path) as image:
        assert found.data.shape == image.size[::-1]
    assert (found.data == 0).any()


def test_a_warehouse_goes_through_every_format_and_comes_back(tmp_path: Path) -> None:
    given_grid = warehouse()
    write_map(tmp_path / "a.yaml", given_grid)
    chain = [tmp_path / name for name in ("a.yaml", "b.sdf", "c.xml", "d.world", "e.yaml", "f.sdf", "g.yaml")]
    for source, target in itertools.pairwise(chain):
        assert main(["world", "convert", str(source), str(target), "height=2.5"]) == 0
    found = load_map(chain[-1])
    assert found.data.tolist() == given_grid.data.tolist()
    assert found.origin.array() == pytest.approx(given_grid.origin.array())
    assert chain[1].read_text().count("<collision") == 42  # 41 walls and the ground
    assert main(["world", "convert", str(chain[1]), str(tmp_path / "h.png")]) == 0
    assert np.array_equal(site_grid(tmp_path / "h.png", 0.05, 1.0).data, given_grid.data)


def test_what_came_as_cylinders_stays_cylinders(tmp_path: Path) -> None:
    geometry = "<geometry><cylinder><radius>0.2</radius></cylinder></geometry>"
    body = f"<static>1</static><link name='l'><collision name='c'>{geometry}</collision></link>"
    (tmp_path / "a.world").write_text(
        f"<sdf version='1.6'><world name='w'><model name='m'>{body}</model></world></sdf>"
    )
    for target in ("b.world", "c.xml"):
        assert main(["world", "convert", str(tmp_path / "a.world"), str(tmp_path / target)]) == 0
        text = (tmp_path / target).read_text()
        assert "cylinder_0" in text
        assert "box" not in text
    assert (
        site_grid(tmp_path / "c.xml", 0.05, 1.0).occupied.sum()
        == site_grid(tmp_path / "a.world", 0.05, 1.0).occupied.sum()
        > 0
    )


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["a.yaml"], "arguments are a.yaml; allowed: arena world convert IN out=FILE"),
        (["a.yaml", "b.sdf", "c.sdf"], "arguments are a.yaml b.sdf c.sdf"),
        (["a.yaml", "b.stl"], "ends in '.stl'; allowed: a file that ends in .yaml, .png"),
        (["a.stl", "b.sdf"], "ends in '.stl'; allowed: a folder with a map"),
        (["a.yaml", "b.sdf", "hight=3"], "there is no key hight; did you mean height? allowed: "),
        (["a.yaml", "b.sdf", "height=0"], "height is 0; allowed: > 0"),
        (["a.yaml", "b.sdf", "height=high"], "height is 'high'; allowed: a number"),
        (["gone.yaml", "b.sdf"], "gone.yaml: cannot be read"),
        (["gone.png", "b.sdf"], "gone.png: cannot be read"),
        (["b.sdf", "c.yaml"], "b.sdf: cannot be read"),
        (
            ["w.sdf", "c.yaml", "resolution=0.2"],
            "resolution is 0.2; allowed: up to the smallest radius or side of a solid, 0.1 m",
        ),
    ],
)
def test_what_cannot_be_converted_is_said_in_one_line(
    tmp_path, monkeypatch, capsys, words: list[str], said: str
) -> None:
    monkeypatch.chdir(tmp_path)
    write_map(Path("a.yaml"), warehouse())
    assert main(["world", "convert", "a.yaml", "w.sdf"]) == 0
    capsys.readouterr()
    assert main(["world", "convert", *words]) == 2
    shown = capsys.readouterr().err
    assert said in shown
    assert shown.count("\n") == 1


@pytest.mark.parametrize("name", ["convert", "generate"])
def test_a_subcommand_tells_how_it_is_used(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["world", name, "--help"]) == 0
    assert f"arena world {name}" in capsys.readouterr().out


@given(
    cuts=st.lists(st.tuples(st.integers(0, 200), st.integers(0, 8), st.binary(max_size=4)), min_size=1, max_size=3),
    ending=st.sampled_from(["PNG", "BMP", "PPM", "GIF"]),
)
@settings(deadline=None)
def test_a_spoilt_picture_is_read_or_refused_in_one_line(
    tmp_path_factory: pytest.TempPathFactory, cuts, ending: str
) -> None:
    buffer = io.BytesIO()
    Image.fromarray(np.arange(60, dtype=np.uint8).reshape(6, 10)).save(buffer, ending)
    content = buffer.getvalue()
    for place, length, other in cuts:
        place %= len(content)
        content = content[:place] + other + content[place + length :]
    path = tmp_path_factory.getbasetemp() / "spoilt.png"
    path.write_bytes(content)
    said = refusal(lambda file: read_picture(file, 0.1), path)
    assert said is None or (str(path) in said and "\n" not in said)


def test_world_file_needs_a_path() -> None:
    with pytest.raises(ConfigurationError, match=r"world\.path is null"):
        FileWorld(None, 0.05, 1.0, known=True)


def test_a_picture_of_too_many_pixels_is_refused_before_it_is_unpacked(tmp_path: Path, monkeypatch) -> None:
    monkeypatch.setattr("arena_worlds.formats.map_image.LIMITS", replace(LIMITS, cells=7))
    write_picture(tmp_path / "w.png", OccupancyGrid(CELLS, 0.1, Pose(0.0, 0.0)))
    with pytest.raises(InputFileError, match=r"w\.png: has 4 x 2 pixels; allowed: 7 in all"):
        read_picture(tmp_path / "w.png", 0.05)


def scenario(folder: Path, map_path: Any = "/home/somebody/maps/site/map.yaml") -> Path:
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / "scenario.json"
    path.write_text(json.dumps({"pedsim_agents": [], "map_path": map_path}))
    return path


def site(folder: Path) -> Path:
    folder.mkdir(parents=True)
    write_map(folder / "map.yaml", OccupancyGrid(CELLS, 0.1, Pose(0.0, 0.0)))
    return folder / "map.yaml"


@pytest.mark.parametrize("place", ["all/site", "all/b/site", "all/b/c/site"])
def test_a_foreign_map_is_found_by_its_folder_below_the_maps(tmp_path: Path, place: str) -> None:
    wanted = site(tmp_path / place)
    site(tmp_path / "all" / "other")
    file = scenario(tmp_path, "C:\\maps\\site\\map.yaml")
    assert find_map(file, tmp_path / "all") == wanted
    assert ScenarioMap(str(file), str(tmp_path / "all"), known=True).world(0, 0).name == "site/map"


def test_without_maps_the_stated_path_counts_and_then_the_folders_beside(tmp_path: Path) -> None:
    beside = site(tmp_path / "maps" / "site")
    assert find_map(scenario(tmp_path / "scenarios"), None).resolve() == beside.resolve()
    assert find_map(scenario(tmp_path), None) == beside
    stated = site(tmp_path / "elsewhere" / "site")
    assert find_map(scenario(tmp_path, str(stated)), None) == stated


def test_the_map_of_our_own_format_lies_where_the_file_says(tmp_path: Path) -> None:
    wanted = site(tmp_path / "maps" / "site")
    file = tmp_path / "maps" / "scenario.json"
    file.write_text(json.dumps({"format": "arena-scenario", "map": "site/map.yaml"}))
    assert find_map(file, None) == wanted
    file.write_text(json.dumps({"format": "arena-scenario"}))
    with pytest.raises(InputFileError, match="map_path is None; allowed"):
        find_map(file, None)


FORMATS = {
    "arena-rosnav": {"robots": [{"start": [1, 1], "goal": [2, 2]}], "obstacles": {}},
    "arena-tools": {"pedsim_agents": [], "map_path": "/home/somebody/maps/hall/map.yaml"},
    "arena-tools in a world": {"pedsim_agents": [], "map_path": "/home/somebody/worlds/hall/map/map.yaml"},
    "arena-tools without a map": {"pedsim_agents": []},
    "flatland": {"scenarios": [{"scene_name": "s"}]},
    "ours": {"format": "arena-scenario", "version": 2, "scenarios": []},
}


@pytest.mark.parametrize("written", FORMATS.values(), ids=FORMATS)
@pytest.mark.parametrize("place", ["hall/map", "hall"])
@pytest.mark.parametrize("folder", ["scenarios", "scenarios/easy"])
def test_a_scenario_of_any_format_finds_the_map_of_the_world_it_lies_in(
    tmp_path: Path, written: Any, place: str, folder: str
) -> None:
    worlds = tmp_path / "worlds"
    wanted = site(worlds / place)
    site(worlds / "other" / "map")
    file = worlds / "hall" / folder / "s.json"
    file.parent.mkdir(parents=True)
    file.write_text(json.dumps(written))
    assert find_map(file, None).resolve() == wanted.resolve()
    assert find_map(file, worlds).resolve() == wanted.resolve()


@pytest.mark.parametrize(
    ("map_path", "said"),
    [
        ("/a/gone/map.yaml", r"map_path: no gone/map\.yaml below .*all; allowed: world\.maps=FOLDER .*world=ros_map"),
        ("/a/twice/map.yaml", r"twice/map\.yaml is there 2 times \(.*\); allowed: once, .*world=ros_map"),
        ("", "map_path is ''; allowed"),
        ("map.yaml", "map_path is 'map.yaml'; allowed"),
        ("../map.yaml", "map_path is '../map.yaml'; allowed"),
        ("site/..", "map_path is 'site/..'; allowed"),
        ("/a/*/map.yaml", r"no \*/map\.yaml below"),
        (None, "map_path is None; allowed"),
        ("a\0/map.yaml", "map_path is .*; allowed"),
    ],
)
def test_a_map_that_is_not_found_once_is_said_in_one_line(tmp_path: Path, map_path: Any, said: str) -> None:
    for place in ("all/twice", "all/b/twice", "all/site"):
        site(tmp_path / place)
    with pytest.raises(InputFileError, match=said) as error:
        find_map(scenario(tmp_path, map_path), tmp_path / "all")
    assert "\n" not in str(error.value)


def test_the_scenario_is_the_tasks_own_unless_said() -> None:
    composed = compose(["world=scenario_map", "task=scenario", "task.path=a.json"])
    assert composed.world.scenario == "a.json"
    assert compose(["world=scenario_map", "task=random"]).world.scenario is None
    with pytest.raises(ConfigurationError, match=r"world\.scenario is null, and so is task\.path"):
        ScenarioMap(None, None, known=True)


@given(
    content=st.binary(max_size=60)
    | st.recursive(st.none() | st.text() | st.integers(), st.lists).map(lambda v: json.dumps({"map_path": v}).encode())
)
@settings(deadline=None)
def test_a_spoilt_scenario_is_refused_in_one_line(tmp_path_factory: pytest.TempPathFactory, content: bytes) -> None:
    path = tmp_path_factory.getbasetemp() / "spoilt.json"
    path.write_bytes(content)
    with pytest.raises(InputFileError) as error:
        find_map(path, path.parent / "none")
    assert str(path) in str(error.value)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("data", "name", "place"),
    [
        pytest.param(DRAWN, "hall_obs03", "hall", id="drawn"),
        pytest.param(DATA, "map5_obs05", "arena_bench/map5", id="map5", marks=needs_data),
        pytest.param(
            DATA, "small_warehouse_obs05", "arena_bench/small_warehouse", id="small_warehouse", marks=needs_data
        ),
    ],
)
def test_maps_of_published_scenarios_are_found_in_the_collection(data: Path, name: str, place: str) -> None:
    assert find_map(data / "scenarios" / f"{name}.json", data / "maps") == data / "maps" / place / "map.yaml"


KEYS = ["image", "resolution", "origin", "negate", "occupied_thresh", "free_thresh", "mode", "layers"]
yaml_values = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=5),
    lambda v: st.lists(v, max_size=3),
    max_leaves=4,
)


@given(changes=st.dictionaries(st.sampled_from(KEYS), yaml_values, min_size=1), text=st.none() | st.binary(max_size=40))
@settings(deadline=None)
def test_a_spoilt_map_yaml_is_read_or_refused_in_one_line(
    tmp_path_factory: pytest.TempPathFactory, changes, text
) -> None:
    folder = tmp_path_factory.getbasetemp() / "spoilt_map"
    if not folder.exists():
        site(folder)
        shutil.copy(folder / "map.pgm", folder / "site.pgm")
    keys = {
        "image": "site.pgm",
        "resolution": 0.1,
        "origin": [0, 0, 0],
        "negate": 0,
        "occupied_thresh": 0.65,
        "free_thresh": 0.2,
    } | changes
    for name in ("spoilt.yaml", "spoilt.world.yaml"):
        (folder / name).write_bytes(json.dumps(keys).encode() if text is None else text)
        said = refusal(load_map, folder / name)
        assert said is None or (str(folder) in said and "\n" not in said)


def test_a_yaml_of_endless_aliases_is_refused_at_once(tmp_path: Path) -> None:
    lines = [
        "a: &a [x, x]",
        *(
            f"{new}: &{new} [*{old}, *{old}]"
            for old, new in zip("abcdefghijklmnopqrst", "bcdefghijklmnopqrstu", strict=True)
        ),
    ]
    (tmp_path / "map.yaml").write_text("\n".join([*lines, "image: *u", "resolution: *u", ""]))
    with pytest.raises(InputFileError, match="it has aliases"):
        load_map(tmp_path / "map.yaml")
    (tmp_path / "map.yaml").write_text("#" * (LIMITS.yaml_bytes + 1))
    with pytest.raises(InputFileError, match="larger than"):
        load_map(tmp_path / "map.yaml")
