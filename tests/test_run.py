import csv
import json
import shutil
from pathlib import Path

import numpy as np
import pytest

import arena_core
from arena_core.records import read_record
from arena_core.runs.folders.provenance import kernels_kind

QUICK = (
    *("planner=pure_pursuit", "robot=jackal", "world=empty", "world.width=8", "world.height=8"),
    *(
        "task.pedestrians=0",
        "localizer=ground_truth",
        "executor=serial",
        "report=false",
        "hydra.run.dir=run",
        "episodes=1",
    ),
)


def rows(folder="run"):
    with Path(folder, "episodes.csv").open(newline="") as file:
        return list(csv.DictReader(file))


def files(folder):
    return sorted(str(path.relative_to(folder)) for path in Path(folder).rglob("*") if path.is_file())


@pytest.fixture
def done(arena):
    """Run two episodes into ``run``."""
    answer = arena("run", *QUICK, "episodes=2")
    assert (answer.status, answer.errors) == (0, [])


def test_a_folder_of_a_run_holds_what_is_documented(done):
    (world,) = Path("run/worlds").iterdir()
    assert files("run") == [
        *(".hydra/config.yaml", ".hydra/hydra.yaml", ".hydra/overrides.yaml"),
        *(
            "episodes.csv",
            "provenance.json",
            "records/0000.npz",
            "records/0001.npz",
            "timing/0000.npz",
            "timing/0001.npz",
        ),
        f"worlds/{world.name}",
    ]


def test_a_row_says_what_was_run(done):
    row = rows()[1]
    known = {
        name: row[name]
        for name in (
            "planner",
            "preset",
            "robot",
            "simulator",
            "world",
            "task",
            "localizer",
            "timing",
            "outcome",
            "error",
        )
    }
    assert known == {
        "planner": "pure_pursuit",
        "preset": "pure_pursuit",
        "robot": "jackal",
        "simulator": "sim2d",
        "world": "empty",
        "task": "random",
        "localizer": "ground_truth",
        "timing": "ideal",
        "outcome": "goal_reached",
        "error": "",
    }
    assert (row["episode"], row["seed"], row["n_pedestrians"]) == ("1", "0", "0")
    assert row["config_hash"] == json.loads(Path("run/provenance.json").read_text())["config_hash"]


def test_provenance_says_what_a_reader_needs_to_repeat_a_run(done):
    said = json.loads(Path("run/provenance.json").read_text())
    assert (said["seed"], said["episodes"]) == (0, 2)
    assert said["versions"]["arena-core"] == arena_core.__version__
    assert {"numpy", "numba", "hydra-core"} <= set(said["versions"])
    assert said["config"]["planner"]["name"] == "pure_pursuit"
    assert said["python"].startswith("3.")
    assert said["machine"]["kernels"] == kernels_kind()


@pytest.mark.parametrize(
    ("target", "ready", "said"),
    [
        (None, None, "this processor"),
        (None, "none", "this processor"),
        ("generic", "none", "generic"),
        ("x86-64-v3", "0a", "x86-64-v3, ready-made 0a"),
    ],
)
def test_it_is_said_for_what_kernels_were_compiled(target, ready, said, monkeypatch):
    for name, value in {"NUMBA_CPU_NAME": target, "ARENA_READY_KERNELS": ready}.items():
        monkeypatch.delenv(name, raising=False)
        if value is not None:
            monkeypatch.setenv(name, value)
    assert kernels_kind() == said


def test_a_record_knows_its_configuration_world_and_scenario(done):
    record = read_record(Path("run/records/0001.npz"))
    assert record.meta["config"]["robot"]["name"] == "jackal"
    assert record.meta["scenario"]["name"] == rows()[1]["scenario"]
    with np.load(Path("run") / record.meta["world"]["grid"]) as grid:
        assert grid["data"].dtype == np.int8


def test_metrics_are_computed_anew_from_records_alone(done, arena):
    before = rows()
    answer = arena("evaluate", "run", "metrics=[paper_legacy]")
    assert (answer.status, answer.out) == (0, "run: 2 episodes\n")
    assert "success" in before[0]
    assert "success" not in rows()[0]
    assert any(name.startswith("paper_legacy.") for name in rows()[0])
    assert arena("evaluate", ".").status == 0
    assert rows() == before


def test_evaluating_keeps_the_rows_of_episodes_that_left_no_record(done, arena):
    Path("run/records/0001.npz").unlink()
    table = Path("run/episodes.csv").read_text().replace("1,0,goal_reached,", "1,0,error,lost")
    Path("run/episodes.csv").write_text(table)
    assert arena("evaluate", "run").status == 0
    assert [(row["outcome"], row["error"]) for row in rows()] == [("goal_reached", ""), ("error", "lost")]


@pytest.mark.parametrize("folder", ["nowhere", "."])
def test_where_there_is_no_run_nothing_can_be_evaluated(arena, folder):
    answer = arena("evaluate", folder)
    assert answer.status == 2
    assert "allowed: a folder that `arena run` wrote, or one above it" in answer.line


def test_a_run_without_its_provenance_cannot_be_evaluated(done, arena):
    Path("run/provenance.json").unlink()
    answer = arena("evaluate", "run")
    assert answer.status == 2
    assert "run/provenance.json: cannot be read" in answer.line


def test_runs_of_a_sweep_are_evaluated_together(done, arena):
    shutil.copytree("run", "sweep/0")
    shutil.copytree("run", "sweep/1")
    assert arena("evaluate", "sweep").out == "sweep/0: 2 episodes\nsweep/1: 2 episodes\n"


def test_a_continued_run_only_runs_what_is_missing(done, arena):
    stamps = {path.name: path.stat().st_mtime_ns for path in Path("run/records").iterdir()}
    assert arena("run", *QUICK, "episodes=3", "resume=true").status == 0
    after = {path.name: path.stat().st_mtime_ns for path in Path("run/records").iterdir()}
    assert set(after) == {*stamps, "0002.npz"}
    assert stamps.items() <= after.items()
    assert [row["episode"] for row in rows()] == ["0", "1", "2"]


def test_a_problem_that_cannot_be_made_is_a_row_with_its_error(arena):
    answer = arena("run", *QUICK, "world.width=0.2", "world.height=0.2")
    assert answer.status == 1
    assert answer.line.startswith("episode 0 failed: ImpossibleScenario: ")
    assert (rows()[0]["outcome"], rows()[0]["planner"]) == ("error", "pure_pursuit")


def test_plugins_hear_of_a_finished_episode_when_its_record_is_there(third_party, arena):
    third_party.package("listener", LISTENER)
    answer = arena("run", *QUICK, "episodes=2")
    assert answer.status == 0
    assert [line for line in answer.out.splitlines() if line.startswith("heard")] == ["heard 0 True", "heard 1 True"]


LISTENER = """
    from pathlib import Path

    from arena_core import hookimpl

    @hookimpl
    def episode_finished(record):
        episode = record.meta["columns"]["episode"]
        print("heard", episode, Path(f"run/records/{episode:04d}.npz").exists())
"""


def test_scans_are_recorded_when_asked_for(arena):
    assert arena("run", *QUICK, "recording.scans=true").status == 0
    record = read_record(Path("run/records/0000.npz"))
    assert record["scan_ranges"].shape == (len(record["stamp"]) - 1, 720)


def test_late_commands_change_the_drive(arena):
    drives = []
    for name, latency in (("ideal", 0.0), ("late", 0.2)):
        assert (
            arena("run", *QUICK, f"hydra.run.dir={name}", "timing.mode=latency", f"timing.latency={latency}").status
            == 0
        )
        drives.append(read_record(Path(name, "records/0000.npz"))["pose"])
    moving = [
        int(np.argmax(np.hypot(*(drive - drive[0])[:, :2].T) + np.abs(drive - drive[0])[:, 2] > 0.0))
        for drive in drives
    ]
    assert moving == [1, 3]


def test_a_robot_without_a_map_finds_its_goal(arena):
    assert arena("run", *QUICK, "world.known=false").status == 0
    assert rows()[0]["outcome"] == "goal_reached"
    assert read_record(Path("run/records/0000.npz")).meta["world"]["known"] is False


def test_a_planner_that_is_not_tuned_for_the_robot_says_so(third_party, arena):
    third_party.package("tuned", TUNED, {"planner/tuned": PRESET, "planner/tuned_tuning/robotino": "gain: 3.0\n"})
    answer = arena("run", *QUICK, "planner=tuned")
    assert (answer.status, answer.errors) == (0, ["tuned: untuned for jackal"])
    assert json.loads(Path("run/provenance.json").read_text())["untuned"] == ["tuned: untuned for jackal"]
    assert arena("run", *QUICK, "planner=tuned", "robot=robotino", "hydra.run.dir=other").errors == []


TUNED = """
    from arena_core import hookimpl

    @hookimpl
    def register_planners(register):
        register("tuned", "arena_pure_pursuit:PurePursuit")

    @hookimpl
    def config_package():
        return "tuned.conf"
"""
PRESET = """
    defaults:
      - _self_
      - optional tuned_tuning@_here_: ${robot}
    name: tuned
    speed: null
    turn_in_place_from: 1.0
    gain: 2.0
"""
