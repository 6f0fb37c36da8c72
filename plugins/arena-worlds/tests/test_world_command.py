"""``arena world generate`` and ``measure`` write and say what they should, or one line."""

import json
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image

from arena_core.cli.main import main
from arena_core.hosting import compose, load_registry
from arena_worlds.commands.generate import world_parameters
from arena_worlds.commands.portrait import LONG_SIDE, draw_portrait
from arena_worlds.formats.map_writer import write_map
from arena_worlds.formats.ros_map import load_map

KINDS = ("indoor", "outdoor", "rooms", "cellular")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("maps")


@pytest.mark.parametrize("kind", [*KINDS, "warehouse"])
def test_world_is_written_as_map_picture_and_measures(
    kind: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["world", "generate", f"kind={kind}", "seed=3", f"out={tmp_path}", "resolution=0.1"]) == 0
    names = ("map.yaml", "map.pgm", "map.png", "map_measures.json")
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted(names)
    output = capsys.readouterr().out
    assert all(f"written: {tmp_path / name}" in output for name in names)
    assert "mean_clearance " in output
    source = load_registry().build("world", world_parameters(kind, {"resolution": "0.1"}))
    assert (load_map(tmp_path / "map.yaml").data == source.world(3, 0).grid.data).all()


def test_measures_are_written_with_units_and_parameters(tmp_path: Path) -> None:
    assert main(["world", "generate", "kind=indoor", "difficulty=0.8", f"out={tmp_path / 'site.yaml'}"]) == 0
    report = json.loads((tmp_path / "site_measures.json").read_text())
    assert report["world"]["difficulty"] == 0.8
    assert report["measures"]["narrowest_passage"]["unit"] == "m"
    assert report["measures"]["narrowest_passage"]["value"] == pytest.approx(1.5, abs=0.11)


def test_barn_is_drawn_by_its_automaton(tmp_path: Path) -> None:
    assert main(["world", "generate", "kind=barn", f"out={tmp_path}", "width=5", "height=5"]) == 0
    assert json.loads((tmp_path / "map_measures.json").read_text())["world"]["name"] == "cellular"


@pytest.mark.slow
@settings(derandomize=True, deadline=None, max_examples=12)
@given(st.sampled_from(KINDS), st.integers(0, 2**31), st.floats(0.0, 1.0), st.sampled_from((0.05, 0.07, 0.1)))
def test_generated_world_is_read_back_exactly(
    folder: Path, kind: str, seed: int, difficulty: float, resolution: float
) -> None:
    node = world_parameters(
        kind, {"resolution": str(resolution), "difficulty": str(difficulty), "width": "9", "height": "8"}
    )
    grid = load_registry().build("world", node).world(seed, 0).grid
    write_map(folder / "map.yaml", grid)
    again = load_map(folder / "map.yaml")
    assert (again.data == grid.data).all()
    assert (again.resolution, again.origin) == (grid.resolution, grid.origin)


def test_defaults_are_those_of_a_run() -> None:
    assert world_parameters("rooms", {}) == dict(compose(["world=rooms"]).world)


def test_measuring_a_file_gives_what_generating_it_gave(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    main(["world", "generate", "kind=outdoor", f"out={tmp_path}", "resolution=0.1"])
    generated = capsys.readouterr().out
    assert main(["world", "measure", str(tmp_path / "map.yaml")]) == 0
    assert capsys.readouterr().out in generated


def test_picture_is_large_and_its_right_way_up() -> None:
    grid = load_registry().build("world", world_parameters("indoor", {"width": "12", "height": "6"})).world(0, 0).grid
    picture = draw_portrait(grid, "a title")
    assert LONG_SIDE / 2 < picture.width < 2 * LONG_SIDE
    scale = (picture.width - 48) // grid.data.shape[1]
    below = np.asarray(picture.convert("L"))[46::scale, 24::scale][: grid.data.shape[0], : grid.data.shape[1]]
    assert ((below < 128) == grid.occupied[::-1]).all()


def test_large_maps_make_pictures_of_the_same_size() -> None:
    grid = load_registry().build("world", world_parameters("empty", {"width": "100", "height": "50"})).world(0, 0).grid
    assert isinstance(draw_portrait(grid, ""), Image.Image)
    assert draw_portrait(grid, "").width == LONG_SIDE + 48


@pytest.mark.parametrize(
    ("words", "line"),
    [
        (["generate"], "kind is missing; allowed: arena world generate kind=indoor out=DIR|FILE.yaml"),
        (["generate", "kind=indoor"], "out is missing; allowed: arena world generate kind=indoor out=DIR|FILE.yaml"),
        (["generate", "kind=indor", "out=x"], "unknown world 'indor'; did you mean indoor? (possible: "),
        (["generate", "kind=indoor", "out=x", "seed=one"], "seed is 'one'; allowed: a whole number"),
        (["generate", "kind=indoor", "out=x", "difficulty=2"], "world.difficulty is 2; allowed: 0 .. 1"),
        (
            ["generate", "kind=indoor", "out=x", "doors=2"],
            "world has no key doors; did you mean draws? (possible: by_difficulty, ",
        ),
        (
            ["generate", "kind=indoor", "out=x", "robot_radius=9"],
            "world.by_difficulty.corridor_width gives 2: no free space for the robot",
        ),
        (["generate", "kind=outdoor", "out=x", "robot_radius=9"], "world outdoor: no free space for the robot"),
        (["generate", "kind=indoor", "kind=rooms", "out=x"], "kind is given twice; allowed: each key once"),
        (["generate", "indoor"], "arguments are indoor; allowed: arena world generate"),
        (["measure"], "arguments are none; allowed: arena world measure MAP.yaml [robot_radius="),
        (["measure", "none.yaml"], "none.yaml: cannot be read (No such file or directory)"),
        (["measure", "none.yaml", "robot=1"], "there is no key robot; allowed: arena world measure MAP.yaml"),
        (["measure", "none.yaml", "robot_radius=-1"], "robot_radius is -1; allowed: > 0"),
        (["draw"], "arena world has no subcommand 'draw' (possible: convert, generate, measure)"),
    ],
)
def test_slips_are_one_line_and_status_2(
    words: list[str], line: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["world", *words]) == 2
    error = capsys.readouterr().err
    assert error.startswith(f"arena: {line}")
    assert error.count("\n") == 1
    assert list(tmp_path.iterdir()) == []


def test_usage_names_the_subcommands(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["world"]) == 0
    usage = capsys.readouterr().out
    assert all(f"  {name} " in usage for name in ("convert", "generate", "measure"))
