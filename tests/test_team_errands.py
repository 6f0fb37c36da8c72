"""Teams that run errands: robots are sent from place to place until the time limit, and records say who was where."""

import csv
import math

import numpy as np
import pytest

from arena_core import ConfigurationError, run
from arena_core.config.configuration import compose
from arena_core.hosting import load_registry
from arena_core.records import read_record
from arena_core.runs.running import RunRequest, run_all

SMALL = [
    *("world=empty", "world.width=8", "world.height=8", "task.team=2", "task.spacing=2.5", "task.time_limit=40"),
    *("planner=orca", "localizer=ground_truth", "pedestrians=none", "metrics=[si,team]", "episodes=1", "report=false"),
]


def drive(folder, *overrides):
    config = compose([*overrides, *SMALL, "executor=serial"])
    run_all([RunRequest(config, folder, {"robot": "turtlebot3", "planner": "orca"})], load_registry())
    with (folder / "episodes.csv").open() as file:
        return list(csv.DictReader(file)), [read_record(folder / "records" / f"{k:04d}.npz") for k in range(2)]


@pytest.mark.parametrize("task", ["patrol", "delivery"])
def test_robots_are_sent_on_until_the_time_limit_and_that_is_success(tmp_path, task):
    rows, records = drive(tmp_path, f"task={task}")
    assert [(row["outcome"], row["success"]) for row in rows] == [("goal_reached", "1.0")] * 2
    assert [record["stamp"][-1] for record in records] == [40.0, 40.0]
    errands = records[0].meta["team"]["errands"]
    assert errands == records[1].meta["team"]["errands"]
    assert (errands["kind"], errands["missed"]) == (task, 0)
    assert {robot for _, robot, _ in errands["visits"]} == {0, 1}
    assert {float(row["team.visits"]) for row in rows} == {len(errands["visits"])}
    assert all(row["team.makespan"] == row["team.delay"] == "" for row in rows)


def test_who_is_said_to_have_visited_a_place_was_there(tmp_path):
    _, records = drive(tmp_path, "task=patrol")
    errands, poses, stamps = records[0].meta["team"]["errands"], records[0]["team_pose"], records[0]["team_stamp"]
    assert len(errands["visits"]) > 3
    for stamp, robot, place in errands["visits"]:
        step = int(np.abs(stamps - stamp).argmin())
        assert math.dist(poses[step, robot, :2], errands["places"][place]) <= 0.5 + 1e-3  # m, goal_radius


def test_deliveries_are_counted_an_hour(tmp_path):
    rows, records = drive(tmp_path, "task=delivery", "task.stations=5")
    visits = records[0].meta["team"]["errands"]["visits"]
    assert float(rows[0]["team.throughput"]) == pytest.approx(len(visits) * 3600.0 / 40.0)
    assert rows[0]["team.idleness_mean"] == ""


def test_a_reference_of_robots_without_one_goal_is_refused_before_anything_runs(tmp_path):
    words = ["task=patrol", "planner=pure_pursuit", "world=empty", "localizer=ground_truth", "reference=clairvoyant"]
    with pytest.raises(ConfigurationError, match="task patrol sends robots on until the time limit"):
        run([*words, "executor=serial", "episodes=1", "report=false"], tmp_path / "run")
    assert not (tmp_path / "run" / "episodes.csv").exists()
