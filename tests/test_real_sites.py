"""Whole runs on maps and scenarios of real sites."""

import csv
from pathlib import Path

import pytest


def rows():
    with Path("run/episodes.csv").open(newline="") as file:
        return list(csv.DictReader(file))


def test_a_real_map_can_be_driven_on_among_people(arena, data):
    site = data / "maps/turtlebot3/map.yaml"
    words = ("planner=dwa", "robot=turtlebot3", "world=ros_map", f"world.path={site}", "task=random", "task.pedestrians=5", "episodes=2")
    answer = arena("run", *words, "executor=serial", "report=false", "hydra.run.dir=run")
    assert answer.status == 0
    assert [row["n_pedestrians"] for row in rows()] == ["5", "5"]
    assert {row["outcome"] for row in rows()} <= {"goal_reached", "false_arrival", "time_out"}


@pytest.mark.slow
def test_a_scenario_of_another_tool_runs_on_its_map(arena, data):
    site = data / "maps/arena_bench/small_warehouse/map.yaml"
    scenario = data / "scenarios/small_warehouse_obs05.json"
    words = ("planner=dwa", "robot=jackal", "world=ros_map", f"world.path={site}", "task=scenario", f"task.path={scenario}", "episodes=1")
    answer = arena("run", *words, "executor=serial", "report=false", "hydra.run.dir=run")
    assert answer.status == 0, answer.errors
    assert (rows()[0]["n_pedestrians"], rows()[0]["error"]) == ("5", "")
