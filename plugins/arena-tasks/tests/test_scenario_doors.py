"""Doors of scenario files: read, written back, checked, shown, drawn, and handed to the simulator."""

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from arena_core import InputFileError
from arena_core.cli.main import main
from arena_core.records import find_runs, read_record
from arena_tasks.scenario_files.problem import PersonDefaults
from arena_tasks.scenario_files.scenario_file import read_scenarios, save_scenarios

LEAF = [[4.9, 6.0], [6.1, 6.0], [6.1, 6.1], [4.9, 6.1]]
DOOR = (0x6D, 0x4C, 0x41)


def write(folder: Path, *doors: dict[str, Any]) -> Path:
    path = folder / "lift.json"
    problem = {"name": "lift", "start": [1, 1], "goal": [9, 6], "doors": list(doors)}
    path.write_text(json.dumps({"format": "arena-scenario", "version": 2, "scenarios": [problem]}))
    return path


def read(path: Path) -> Any:
    (problem,) = read_scenarios(path, PersonDefaults(0.3, 0.25))
    return problem


def test_doors_are_read_and_written_back(tmp_path: Path) -> None:
    doors = [{"vertices": LEAF, "open": [[5.0, 12.0], [14.0, 15.0]], "period": 24.0}, {"vertices": LEAF, "open": [[7]]}]
    problem = read(write(tmp_path, *doors))
    first, second = problem.doors
    assert (first.vertices_xy.tolist(), first.open.tolist(), first.period) == (LEAF, [[5, 12], [14, 15]], 24.0)
    assert (second.open.tolist(), second.period) == ([[7.0, math.inf]], None)
    save_scenarios(tmp_path / "again.json", [problem])
    assert json.loads((tmp_path / "again.json").read_text())["scenarios"][0]["doors"] == doors


@pytest.mark.parametrize(
    ("door", "said"),
    [
        ({"vertices": LEAF}, r"doors\[0\]\.open is missing"),
        ({"open": [[1, 2]]}, r"doors\[0\]\.vertices is missing"),
        (
            {"vertices": LEAF, "open": []},
            r"doors\[0\]\.open is \[\]; allowed: one or more \[from, to\] or \[from\] \(s",
        ),
        ({"vertices": LEAF, "open": [[1, 2, 3]]}, r"open\[0\] is \[1, 2, 3\]; allowed: \[from, to\] or \[from\]"),
        ({"vertices": LEAF, "open": [[-1, 2]]}, r"open\[0\]\[0\] is -1; allowed: a number >= 0"),
        ({"vertices": LEAF, "open": [[3, 2]]}, r"doors\[0\]\.open is \[\[3\.0, 2\.0\]\]; allowed: .*0 <= from < to"),
        ({"vertices": LEAF, "open": [[3, 5], [4, 6]]}, r"doors\[0\]\.open is .*in their order"),
        ({"vertices": LEAF, "open": [[3, 5]], "period": 4}, r"doors\[0\]\.open is .*to <= period, 4"),
        ({"vertices": LEAF, "open": [[3]], "period": 4}, r"doors\[0\]\.open is .*to <= period, 4"),
        ({"vertices": LEAF, "open": [[3, 5]], "period": 0}, r"doors\[0\]\.period is 0; allowed: a number > 0"),
        ({"vertices": LEAF[:2], "open": [[3, 5]]}, r"doors\[0\]\.vertices is .*; allowed: three or more"),
        ({"vertices": [*LEAF[2:], *LEAF[1::-1]], "open": [[3, 5]]}, r"doors\[0\]\.vertices: Self-intersection"),
        ({"vertices": LEAF, "open": [[3, 5]], "repeat": 4}, r"repeat is unknown; allowed: vertices, open, period"),
        ({"vertices": [[0, 0], [2e3, 0], [0, 1]], "open": [[3, 5]]}, "lift has 2000 m of a body; allowed: up to 1000"),
    ],
)
def test_a_door_that_is_none_is_one_line_with_file_and_key(tmp_path: Path, door: dict[str, Any], said: str) -> None:
    with pytest.raises(InputFileError, match=said) as caught:
        read(write(tmp_path, door))
    assert "lift.json" in str(caught.value)
    assert "\n" not in str(caught.value)


def test_more_doors_than_can_be_run_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputFileError, match="lift has 101 doors; allowed: up to 100"):
        read(write(tmp_path, *[{"vertices": LEAF, "open": [[3, 5]]}] * 101))


def test_doors_are_shown_and_drawn(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = write(
        tmp_path, {"vertices": LEAF, "open": [[5, 12], [14, 15]], "period": 24}, {"vertices": LEAF, "open": [[7]]}
    )
    assert main(["scenario", "show", str(path)]) == 0
    shown = [" ".join(line.split()) for line in capsys.readouterr().out.splitlines()]
    assert "lift 0 (5.50, 6.05) 5 .. 12 s, 14 .. 15 s 24 s" in shown
    assert "lift 1 (5.50, 6.05) from 7 s -" in shown
    picture = tmp_path / "lift.png"
    words = ["scenario", "draw", str(path), "--to", str(picture), "world=empty", "world.width=12", "world.height=8"]
    assert main(words) == 0
    image = np.asarray(Image.open(picture).convert("RGB")).astype(int)
    assert (np.abs(image - DOOR).max(axis=-1) < 8).sum() > 100


def test_formats_without_doors_say_that_they_are_left_out(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = write(tmp_path, {"vertices": LEAF, "open": [[5, 12]]})
    for form in ("arena-tools", "arena-rosnav"):
        assert main(["scenario", "convert", str(path), str(tmp_path / "theirs.json"), f"format={form}"]) == 0
        assert "left out: doors" in capsys.readouterr().out


def test_an_episode_records_when_its_doors_were_open(tmp_path: Path) -> None:
    path, out = write(tmp_path, {"vertices": LEAF, "open": [[0.5, 1.2]]}), tmp_path / "run"
    words = ["planner=pure_pursuit", "robot=jackal", "pedestrians=none", "world=empty", "localizer=ground_truth"]
    words += ["task=scenario", f"task.path={path}", "task.time_limit=2", "executor=serial", "report=false"]
    assert main(["run", *words, "episodes=1", f"out={out}"]) == 0
    record = read_record(next(iter(find_runs(out))) / "records" / "0000.npz")
    assert record.meta["scenario"]["doors"] == [{"vertices_xy": LEAF, "open": [[0.5, 1.2]], "period": None}]
    stamps = record["stamp"]
    assert record["doors_open"][:, 0].tolist() == [0.5 - 1e-6 <= stamp < 1.2 - 1e-6 for stamp in stamps.tolist()]
