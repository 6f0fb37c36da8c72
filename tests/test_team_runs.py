"""Runs of teams: a record and a row for each robot, the same for any number of workers."""

import csv
import json

import numpy as np
import pytest

from arena_core import ArenaError
from arena_core.config.configuration import compose
from arena_core.hosting import build_benchmark, load_registry
from arena_core.records import read_record
from arena_core.runs.folders.resuming import re_evaluate
from arena_core.runs.running import RunRequest, run_all

TEAM = [
    *("task=antipodal", "world=empty", "world.width=8", "world.height=8", "task.radius=1.5", "task.team=3"),
    *("planner=orca", "localizer=ground_truth", "pedestrians=none", "metrics=[si,team]", "episodes=2", "report=false"),
    "task.time_limit=40",
]


def drive(folder, *overrides, choices=None):
    chosen = {"robot": "turtlebot3", "planner": "orca", "world": "empty", **(choices or {})}
    config = compose([*TEAM, "executor=serial", *overrides])
    return run_all([RunRequest(config, folder, chosen)], load_registry())[0]


def table(folder):
    with (folder / "episodes.csv").open() as file:
        return list(csv.DictReader(file))


@pytest.fixture(scope="module")
def driven(tmp_path_factory):
    folder = tmp_path_factory.mktemp("team")
    drive(folder)
    return folder


def test_each_robot_of_each_scenario_has_a_row_and_a_record(driven):
    rows = table(driven)
    assert [int(row["episode"]) for row in rows] == list(range(6))
    assert [int(row["member"]) for row in rows] == [0, 1, 2, 0, 1, 2]
    assert [row["scenario"] for row in rows] == ["antipodal/0000"] * 3 + ["antipodal/0001"] * 3
    assert all(row["outcome"] == "goal_reached" for row in rows)
    for row in rows:
        record = read_record(driven / "records" / f"{int(row['episode']):04d}.npz")
        assert record.meta["team"]["member"] == int(row["member"])
        assert record["team_pose"].shape[1:] == (3, 3)


def test_rows_of_one_team_agree_on_the_team(driven):
    for first in (0, 3):
        rows = table(driven)[first : first + 3]
        assert len({row["team.makespan"] for row in rows}) == 1
        assert float(rows[0]["team.makespan"]) == max(float(row["time_to_goal"]) for row in rows)


def test_workers_drive_what_one_process_drives(driven, tmp_path):
    drive(tmp_path, "executor=processes", "executor.workers=2")
    for path in sorted((driven / "records").glob("*.npz")):
        one, two = read_record(path), read_record(tmp_path / "records" / path.name)
        for name, array in one.arrays.items():
            assert np.array_equal(array, two.arrays[name], equal_nan=array.dtype.kind == "f"), name


def test_evaluating_again_gives_the_same_table(driven, tmp_path):
    before = (driven / "episodes.csv").read_text()
    assert re_evaluate(driven, load_registry(), target=tmp_path) == 6
    assert (tmp_path / "episodes.csv").read_text() == before


def test_a_run_that_lost_a_record_of_a_team_drives_the_team_again(driven, tmp_path):
    drive(tmp_path, "episodes=1")
    before = (tmp_path / "episodes.csv").read_text()
    (tmp_path / "records" / "0001.npz").unlink()
    run = drive(tmp_path, "episodes=1", "resume=true")
    assert run.left() == 0
    assert len(table(tmp_path)) == len(before.splitlines()) - 1


def test_teammates_may_drive_with_another_planner(tmp_path):
    drive(tmp_path, "task.teammates=dwa", "episodes=1")
    rows = table(tmp_path)
    assert [row["planner"] for row in rows] == ["orca", "dwa", "dwa"]
    assert len({row["config_hash"] for row in rows}) == 2
    record = read_record(tmp_path / "records" / "0001.npz")
    assert [robot["planner"] for robot in record.meta["team"]["robots"]] == ["orca", "dwa", "dwa"]
    assert record.meta["config"]["planner"]["name"] == "dwa"


def test_teammates_may_be_robots_of_another_type(tmp_path):
    drive(tmp_path, "task.teammates_robot=jackal", "task.teammates=dwa", "episodes=1", "task.team=2", "task.radius=2")
    rows = table(tmp_path)
    assert [(row["robot"], row["planner"]) for row in rows] == [("turtlebot3", "orca"), ("jackal", "dwa")]
    assert all(row["outcome"] == "goal_reached" for row in rows)
    first, second = (read_record(tmp_path / "records" / f"{k:04d}.npz") for k in range(2))
    assert [record.meta["robot"]["name"] for record in (first, second)] == ["turtlebot3", "jackal"]
    assert second.meta["config"]["robot"]["name"] == "jackal"
    assert [robot["robot"]["name"] for robot in first.meta["team"]["robots"]] == ["turtlebot3", "jackal"]
    assert second["twist"][:, 0].max() > 0.5  # m/s, more than a turtlebot3 can


def test_a_run_says_what_its_robots_tell_each_other(driven, tmp_path):
    drive(tmp_path, "communication=broadcast", "episodes=1")
    (first, *_), silent = table(tmp_path), table(driven)
    assert first["communication"] == "broadcast"
    assert "communication" not in silent[0]
    assert first["config_hash"] != silent[0]["config_hash"]
    assert json.loads((tmp_path / "provenance.json").read_text())["config"]["communication"]["delay"] == 0.1
    alike = [read_record(folder / "records" / "0000.npz")["pose"] for folder in (driven, tmp_path)]
    assert not np.array_equal(*alike)  # what was heard counts


@pytest.mark.parametrize(
    ("overrides", "said"),
    [
        (["task.teammates_robot=nobody"], "nobody"),
        (["task.teammates=nobody"], "nobody"),
        (["task.team=1"], "task.team is 1; allowed"),
        (["simulator=mujoco", "task.teammates_robot=jackal", "task.teammates=dwa"], "one type"),
        (["communication=nobody"], "nobody"),
        (["communication=broadcast", "communication.loss=2"], "communication.loss is 2"),
    ],
)
def test_what_cannot_be_a_team_is_refused_in_one_line(tmp_path, overrides, said):
    with pytest.raises(ArenaError) as refused:
        drive(tmp_path, *overrides)
    assert said in str(refused.value)
    assert "\n" not in str(refused.value)


def test_a_robot_alone_has_no_one_to_talk_to():
    with pytest.raises(ArenaError, match="communication is broadcast, and task random has one robot; allowed: "):
        build_benchmark(compose(["world=empty", "communication=broadcast"]), load_registry())


def test_more_robots_than_there_is_room_for_are_rows_with_the_reason(tmp_path):
    drive(tmp_path, "task.team=60", "episodes=1")
    rows = table(tmp_path)
    assert len(rows) == 60
    assert all("60 robots have starts" in row["error"] for row in rows)
