"""A pack is run as it was packed, or not at all."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from PIL import Image

from arena_core import InputFileError, Pose, World, WorldSource, testing
from arena_core.cli.main import main
from arena_core.hosting import UnknownComponent, compose, load_registry
from arena_tasks.commands.packing import make_pack
from arena_tasks.scenario_files.pack import PACK_FILE, read_pack, verified_pack
from arena_tasks.scenario_files.scenario_task import ScenarioTask

EXACT = settings(derandomize=True, deadline=None, suppress_health_check=list(HealthCheck))
MAP = {
    "image": "room.png",
    "resolution": 0.05,
    "origin": [-5.0, -5.0, 0.0],
    "negate": 0,
    "occupied_thresh": 0.65,
    "free_thresh": 0.196,
}


class Room(WorldSource):
    def world(self, seed: int, index: int) -> World:
        return World("room", testing.room(10.0))


def problem(name: str, **changes: object) -> dict[str, Any]:
    return {"name": name, "start": [-3.0, 0.0], "goal": [3.0, 0.0], **changes}


def scenario_file(**changes: object) -> dict[str, Any]:
    content = {"format": "arena-scenario", "version": 2, "title": "Through a room", "map": "../maps/room.yaml"}
    return {
        **content,
        "scenarios": [problem("there", pedestrians=[{"position": [0, 2]}]), problem("back", goal=[3.0, 1.0])],
        **changes,
    }


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return an unpacked folder in the working directory."""
    monkeypatch.chdir(tmp_path)
    walls = np.zeros((200, 200), np.uint8)
    walls[2:-2, 2:-2] = 255
    for name in ("maps", "scenarios"):
        (tmp_path / "lab" / name).mkdir(parents=True)
    Image.fromarray(walls).save(tmp_path / "lab" / "maps" / "room.png")
    (tmp_path / "lab" / "maps" / "room.yaml").write_text(yaml.safe_dump(MAP))
    for day in ("monday", "tuesday"):
        (tmp_path / "lab" / "scenarios" / f"{day}.json").write_text(json.dumps(scenario_file()))
    return Path("lab")


def pack(*words: str) -> int:
    return main(["scenario", "pack", *words])


def task(path: Path) -> ScenarioTask:
    return ScenarioTask(testing.robot(), Room(), str(path), 0.3, 0.3, 0.3, 120.0)


def test_packing_writes_the_hash_of_every_file_and_an_option_of_every_scenario(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert pack("lab", "--version", "2.1", "--title", "Our lab", "--licence", "MIT") == 0
    assert capsys.readouterr().out.splitlines() == [
        "lab/pack.yaml: lab 2.1, 4 files",
        "scenario=lab/monday",
        "scenario=lab/tuesday",
    ]
    found = read_pack(folder)
    assert (found.id, found.version, found.title, found.licence) == ("lab", "2.1", "Our lab", "MIT")
    assert list(found.files) == ["maps/room.png", "maps/room.yaml", "scenarios/monday.json", "scenarios/tuesday.json"]


def test_option_chooses_world_and_task_and_the_command_line_wins(folder: Path) -> None:
    pack("lab")
    config = compose(["scenario=lab/monday", "planner=dwa", "pedestrians=social_force", "task.time_limit=60"])
    assert (config.world.name, config.world.path) == ("ros_map", "lab/maps/room.yaml")
    assert (config.task.name, config.task.path, config.task.time_limit) == ("scenario", "lab/scenarios/monday.json", 60)


def test_packing_again_keeps_what_was_said_and_takes_changed_files_over(folder: Path) -> None:
    pack("lab", "--version", "1.4", "--licence", "MIT")
    before = read_pack(folder)
    (folder / "scenarios" / "monday.json").write_text(json.dumps(scenario_file(title="Again")))
    pack("lab")
    after = read_pack(folder)
    assert (after.version, after.licence) == ("1.4", "MIT")
    assert [name for name in after.files if after.files[name] != before.files[name]] == ["scenarios/monday.json"]


def change(path: Path) -> None:
    path.write_bytes(path.read_bytes() + b"\n")


@pytest.mark.slow
@pytest.mark.parametrize(
    "changed", ["maps/room.png", "maps/room.yaml", "scenarios/monday.json", "scenarios/tuesday.json"]
)
def test_changed_file_is_one_line_before_anything_runs(
    folder: Path, changed: str, capsys: pytest.CaptureFixture[str]
) -> None:
    pack("lab")
    expected = read_pack(folder).files[changed]
    change(folder / changed)
    capsys.readouterr()
    assert main(["run", "scenario=lab/monday", "hydra.run.dir=run"]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert f"{changed}: has changed: its SHA-256 is " in line
    assert expected[:12] in line
    assert not Path("run/episodes.csv").exists()


@pytest.mark.parametrize("change", [Path.unlink, lambda path: path.rename(path.with_suffix(".txt"))])
def test_missing_file_is_one_line(folder: Path, change: Callable[[Path], object]) -> None:
    pack("lab")
    change(folder / "scenarios" / "tuesday.json")
    with pytest.raises(
        InputFileError,
        match=r"tuesday\.json: cannot be read \(No such file or directory\); allowed: a file as pack\.yaml lists it",
    ):
        task(folder / "scenarios" / "monday.json")


def test_file_that_the_pack_does_not_list_is_refused(folder: Path) -> None:
    pack("lab")
    (folder / "scenarios" / "new.json").write_text(json.dumps(scenario_file()))
    with pytest.raises(
        InputFileError, match=r"new\.json: is not listed in .*pack\.yaml; `arena scenario pack .*lab` lists it"
    ):
        task(folder / "scenarios" / "new.json")


def test_hash_names_pack_and_version_and_changes_with_file_and_map(folder: Path) -> None:
    plain = task(folder / "scenarios" / "monday.json").scenario(0, 0).content_hash
    pack("lab", "--version", "3.2")
    packed = [task(folder / "scenarios" / "monday.json").scenario(0, index).content_hash for index in (0, 1)]
    assert packed == [f"lab@3.2:{plain}"] * 2
    change(folder / "scenarios" / "monday.json")
    pack("lab")
    assert task(folder / "scenarios" / "monday.json").scenario(0, 0).content_hash not in packed
    world = load_registry().build("world", {"name": "ros_map", "path": "lab/maps/room.yaml", "known": True})
    other = ScenarioTask(testing.robot(), world, "lab/scenarios/monday.json", 0.3, 0.3, 0.3, 120.0)
    assert other.scenario(0, 0).content_hash != task(folder / "scenarios" / "monday.json").scenario(0, 0).content_hash


def test_a_file_beside_no_pack_belongs_to_none(folder: Path) -> None:
    assert verified_pack(folder / "scenarios") is None


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda c: c.update(format="zip"), 'format is "zip"; allowed: arena-pack'),
        (lambda c: c.update(id="../lab"), r'id is "\.\./lab"; allowed: a name of letters'),
        (lambda c: c.update(version=1.0), r"version is 1\.0; allowed: a text"),
        (lambda c: c.pop("licence"), "licence is missing"),
        (lambda c: c.update(author="me"), "author is unknown; allowed: format, id, version"),
        (lambda c: c.update(files=[]), r"files is \[\]; allowed: a mapping"),
        (lambda c: c["files"].update({"../x": "a"}), r"files\.\.\./x lies outside the pack"),
        (lambda c: c["files"].update({"/etc/passwd": "a"}), "files./etc/passwd lies outside the pack"),
        (lambda c: c["files"].update({"x": 3}), r"files\.x is 3; allowed: a text"),
    ],
)
def test_wrong_pack_file_says_key_and_what_is_allowed(
    folder: Path, change: Callable[[dict[str, Any]], object], message: str
) -> None:
    pack("lab")
    content = yaml.safe_load((folder / PACK_FILE).read_text())
    change(content)
    (folder / PACK_FILE).write_text(yaml.safe_dump(content))
    with pytest.raises(InputFileError, match=message) as caught:
        read_pack(folder)
    assert "\n" not in str(caught.value)


@EXACT
@given(st.text(max_size=30) | st.binary(max_size=30))
def test_any_pack_file_is_refused_in_one_line(tmp_path_factory: pytest.TempPathFactory, content: str | bytes) -> None:
    place = tmp_path_factory.mktemp("any")
    (place / PACK_FILE).write_bytes(content if isinstance(content, bytes) else content.encode())
    with pytest.raises(InputFileError) as caught:
        read_pack(place)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (
            scenario_file(map="../maps/gone.yaml"),
            r"monday\.json: map is '\.\./maps/gone\.yaml'; allowed: a YAML file of this pack",
        ),
        (scenario_file(map="../../lab.yaml"), r"map is '\.\./\.\./lab\.yaml'; allowed: a YAML file of this pack"),
        ({k: v for k, v in scenario_file().items() if k != "map"}, r"monday\.json: map is missing"),
        (scenario_file(scenarios=[]), r"scenarios is \[\]; allowed: at least one"),
    ],
)
def test_what_cannot_be_run_cannot_be_packed(folder: Path, content: dict[str, Any], message: str) -> None:
    (folder / "scenarios" / "monday.json").write_text(json.dumps(content))
    with pytest.raises(InputFileError, match=message):
        make_pack(folder, {})
    assert not (folder / PACK_FILE).exists()


def test_packing_no_folder_or_an_empty_one_is_one_line(tmp_path: Path) -> None:
    with pytest.raises(InputFileError, match="gone: is no folder"):
        make_pack(tmp_path / "gone", {})
    with pytest.raises(InputFileError, match="holds no scenario file"):
        make_pack(tmp_path, {})


def test_unknown_subcommand_says_what_there_is() -> None:
    with pytest.raises(UnknownComponent, match=r"'scenario unpack' \(possible: .*pack"):
        load_registry().component("command", "scenario").resolve()().run(["unpack"])


def test_listing_says_what_each_scenario_is(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    pack("lab")
    capsys.readouterr()
    main(["list", "scenarios"])
    line = next(line for line in capsys.readouterr().out.splitlines() if "lab/monday" in line)
    world = load_registry().build("world", {"name": "ros_map", "path": "lab/maps/room.yaml", "known": True})
    run = ScenarioTask(testing.robot(), world, "lab/scenarios/monday.json", 0.3, 0.3, 0.3, 120.0).scenario(0, 0)
    assert line.split() == [
        "lab/monday",
        "2",
        "6.0-6.1",
        "m",
        "0-1",
        "room",
        run.content_hash,
        *["Through", "a", "room"],
    ]
    assert run.start == Pose(-3.0, 0.0)


def test_listing_shows_a_changed_pack_and_goes_on(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    pack("lab")
    change(folder / "maps" / "room.png")
    capsys.readouterr()
    assert main(["list", "scenarios"]) == 0
    assert sum("room.png: has changed" in line for line in capsys.readouterr().out.splitlines()) == 2


def test_listing_shows_an_option_without_a_file_and_goes_on(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    pack("lab")
    Path("conf/scenario/odd.yaml").write_text("# @package _global_\nepisodes: 3\n")
    capsys.readouterr()
    assert main(["list", "scenarios"]) == 0
    assert "odd.yaml: task.path is missing" in capsys.readouterr().out


def test_names_alone_and_summary_count_the_scenarios(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    pack("lab")
    capsys.readouterr()
    main(["list", "scenarios", "--names"])
    assert {"lab/monday", "lab/tuesday"} <= set(capsys.readouterr().out.split())
    main(["list"])
    assert "  lab                    2, such as scenario=lab/monday\n" in capsys.readouterr().out
