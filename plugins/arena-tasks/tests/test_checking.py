"""`arena scenario check` lists what is impossible, and a run skips it and tells."""

import json
from pathlib import Path
from typing import Any

import pytest

from arena_core import ImpossibleScenario
from arena_core.cli.main import main
from arena_core.commands import print_notice
from arena_core.testing import component, robot
from arena_tasks.scenario_files.scenario_task import ScenarioTask

WORLD = ["world=empty", "world.width=12", "world.height=12"]


def scene(name: str, start: tuple[float, float] = (1.0, 1.0), **changes: object) -> dict[str, Any]:
    return {"name": name, "start": list(start), "goal": [9.0, 9.0], **changes}


@pytest.fixture
def file(tmp_path: Path):
    def write(*scenes: dict[str, Any]) -> str:
        path = tmp_path / "scenes.json"
        path.write_text(json.dumps({"format": "arena-scenario", "version": 2, "scenarios": scenes}))
        return str(path)

    return write


@pytest.fixture(autouse=True)
def _told_anew() -> None:
    print_notice.cache_clear()


def task(path: str) -> ScenarioTask:
    return ScenarioTask(robot(), component("world", "empty", WORLD[1:]), path, 0.3, 0.3, 0.25, 120.0)


def test_all_possible_is_status_0(file, capsys) -> None:
    assert main(["scenario", "check", file(scene("a"), scene("b")), *WORLD]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split() for line in lines[:2]] == [["a", "possible"], ["b", "possible"]]
    assert lines[2].endswith("2 of 2 problems possible in empty for turtlebot3")


def test_what_is_impossible_is_listed_with_its_reason_and_is_status_1(file, capsys) -> None:
    odd = {"position": [5, 5], "behaviour": {"type": "dragon"}}
    path = file(scene("a"), scene("wall", (-1.0, -1.0)), scene("odd", pedestrians=[odd]))
    assert main(["scenario", "check", path, *WORLD, "robot=jackal"]) == 1
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].split() == ["a", "possible"]
    assert lines[1].split(maxsplit=2) == [
        "wall",
        "impossible",
        "scenarios[1].start (-1.00, -1.00) lies outside the map",
    ]
    assert "type is 'dragon'" in lines[2]
    assert lines[3].endswith("1 of 3 problems possible in empty for jackal")


def test_what_was_read_otherwise_is_said(tmp_path: Path, capsys) -> None:
    path = tmp_path / "rosnav.json"
    path.write_text(json.dumps({"robots": [{"start": [1, 1], "goal": [9, 9]}] * 2, "obstacles": {}}))
    assert main(["scenario", "check", str(path), *WORLD]) == 0
    assert "read otherwise: robots after the first are left out (1)" in capsys.readouterr().out
    assert main(["scenario", "show", str(path)]) == 0
    assert capsys.readouterr().out.endswith(
        "read otherwise: robots after the first are left out (1), for here one robot drives\n"
    )


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["gone.json", *WORLD], "gone.json: cannot be read"),
        (["gone.json"], "gone.json: cannot be read"),
        ([], "arguments are none; allowed: arena scenario check FILE"),
        (
            ["a.json", "planner=dwa"],
            "there is no key planner; allowed: arena scenario check FILE [world=... "
            "robot=... pedestrians=... task.KEY=...]",
        ),
        (["a.json", "robot=tank"], "tank"),
    ],
)
def test_what_cannot_be_checked_is_one_line_and_status_2(
    tmp_path, monkeypatch, capsys, words: list[str], said: str
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "a.json").write_text(json.dumps({"format": "arena-scenario", "version": 2, "scenarios": [scene("a")]}))
    assert main(["scenario", "check", *words]) == 2
    shown = capsys.readouterr().err
    assert said in shown
    assert shown.count("\n") == 1


def test_one_impossible_scene_of_many_is_skipped_and_told_once(file, capsys) -> None:
    path = file(scene("a", repeats=2), scene("wall", (-1.0, -1.0)), scene("b"))
    for _ in range(2):  # a run builds its task more than once
        found = [task(path).scenario(0, index) for index in range(5)]
    assert [scenario.name for scenario in found] == ["a/0000", "a/0001", "b/0000", "a/0002", "a/0003"]
    line = (
        f"arena: wall is skipped, for it is impossible: {path}: scenarios[1].start (-1.00, "
        "-1.00) lies outside the map\n"
    )
    assert capsys.readouterr().err == line


def test_the_names_and_so_the_random_streams_of_the_others_do_not_change(file) -> None:
    whole, less = task(file(scene("a"), scene("b"))), task(file(scene("a"), scene("wall", (-1.0, -1.0)), scene("b")))
    assert [whole.scenario(3, k).name for k in range(6)] == [less.scenario(3, k).name for k in range(6)]


def test_a_file_of_impossible_scenes_is_refused(file, capsys) -> None:
    with pytest.raises(ImpossibleScenario, match=r"scenarios\[0\]\.start"):
        task(file(scene("wall", (-1.0, -1.0)), scene("rock", (-2.0, -1.0))))
    assert capsys.readouterr().err == ""
