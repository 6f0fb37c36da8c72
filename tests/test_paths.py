"""What takes a path takes text too; relative paths are those of where the command was called."""

import json
from pathlib import Path

import numpy as np
import pytest

from arena_core import InputFileError, OccupancyGrid, Pose, Run, files, records
from arena_core.loop.record_files import write_grid, write_record
from arena_core.records import read_record
from arena_core.testing import record
from arena_tasks.scenario_files.problem import PersonDefaults
from arena_tasks.scenario_files.scenario_file import read_scenarios, save_scenarios

SMALL = [
    "planner=pure_pursuit",
    "robot=jackal",
    "world=empty",
    "world.width=8",
    "world.height=8",
    "localizer=ground_truth",
]
RUN = ["run", *SMALL, "executor=serial", "episodes=1"]
SCENARIO = {"format": "arena-scenario", "version": 2, "scenarios": [{"name": "s", "start": [2, 2, 0], "goal": [6, 6]}]}


@pytest.fixture
def folder(tmp_path):
    """A run's folder with one record, a map, and files of each format."""
    write_record(tmp_path, 0, record())
    write_grid(tmp_path, OccupancyGrid(np.zeros((2, 3), np.int8), 0.1, Pose(0.0, 0.0)))
    (tmp_path / "episodes.csv").write_text("episode\n0\n")
    (tmp_path / "provenance.json").write_text('{"config": {"seed": 0}}')
    (tmp_path / "a.json").write_text("{}")
    (tmp_path / "a.yaml").write_text("a: 1")
    np.save(tmp_path / "a.npy", np.arange(3))
    return tmp_path


@pytest.mark.parametrize(
    ("name", "file", "more"),
    [
        ("read_record", "records/0000.npz", ()),
        ("read_json", "a.json", ("JSON",)),
        ("read_yaml", "a.yaml", ("YAML",)),
        ("read_table", "episodes.csv", ("a table",)),
        ("read_text", "a.json", (99, "a text")),
        ("read_bytes", "a.json", (99, "bytes")),
        ("read_array", "a.npy", ("an array",)),
        ("read_arrays", "records/0000.npz", ("arrays",)),
        ("read_provenance", "", ()),
        ("find_runs", "", ()),
        ("record_path", "", (7,)),
        ("record_paths", "", ()),
        ("timing_paths", "", ()),
        ("is_file", "a.json", ()),
        ("local_path", "a.json", ()),
        ("check_inside", "", ("a.json",)),
        ("write_text_whole", "b.txt", ("text",)),
        ("write_bytes_whole", "b.txt", (b"bytes",)),
    ],
)
def test_a_function_of_the_core_takes_a_path_as_text(folder, name, file, more, monkeypatch):
    monkeypatch.chdir(folder)
    function = getattr(records if hasattr(records, name) else files, name)
    assert repr(function(f"{folder}/{file}", *more)) == repr(function(folder / file, *more))


def test_maps_runs_and_scenarios_take_a_path_as_text(folder):
    (grid,) = (folder / "worlds").glob("*.npz")
    assert records.read_grid(str(grid)).data.shape == (2, 3)
    assert Run(str(folder)).record(0).meta["outcome"] == "goal_reached"
    (folder / "s.json").write_text(json.dumps(SCENARIO))
    problems = read_scenarios(str(folder / "s.json"), PersonDefaults(1.0, 0.3))
    save_scenarios(str(folder / "t.json"), problems)
    assert read_scenarios(folder / "t.json", PersonDefaults(1.0, 0.3))[0].name == "s"


@pytest.mark.parametrize("path", ["nowhere/records/0000.npz", "", "a\0.npz"])
def test_a_text_that_is_no_path_is_one_line(path):
    with pytest.raises(InputFileError):
        read_record(path)


@pytest.mark.parametrize("more", [(), ("-m",)])
def test_relative_paths_of_a_run_are_read_where_it_was_called(arena, more):
    Path("s.json").write_text(json.dumps(SCENARIO))
    words = [
        *more,
        "hydra.job.chdir=true",
        "hydra.run.dir=here",
        "hydra.sweep.dir=here",
        "hydra.sweep.subdir=.",
        "report=false",
    ]
    answer = arena(*RUN, *words, "task=scenario", "task.path=s.json", "task.time_limit=2")
    assert (answer.status, answer.errors) == (0, [])
    assert sorted(path.name for path in Path().iterdir()) == ["here", "s.json"]
    assert Path("here/records/0000.npz").exists()
