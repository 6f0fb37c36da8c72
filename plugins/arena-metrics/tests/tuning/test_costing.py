"""Episodes of a tuning: rows as runs have them, with what the robot cost the people where twins were driven."""

import pytest

from arena_core import Run
from arena_core.hosting import Job, compose, load_registry, run_jobs, to_plain
from arena_reference.costing import cost_of_run
from arena_tuning.costing import COST_NAMES, DROVE, TWINS, drive, drive_and_cost

WORDS = ("planner=pure_pursuit", "robot=jackal", "world=empty", "world.width=7", "world.height=7", "executor=serial")
SHORT = ("task.time_limit=4", "localizer=ground_truth", "report=false", "episodes=1", "pedestrians.reaction=yield")


@pytest.fixture(scope="module")
def config():
    return to_plain(compose([*WORDS, *SHORT, "task.pedestrians=3"]))


def test_costs_are_those_that_arena_cost_finds_out_and_the_rest_of_the_row_is_that_of_a_run(config, tmp_path):
    (run,) = run_jobs({tmp_path / "run": [*WORDS, *SHORT, "task.pedestrians=3"]})
    told = cost_of_run(Run(run.folder), load_registry()).rows[0]
    (tmp_path / "drive").mkdir()
    row = drive_and_cost(Job(config, str(tmp_path / "drive"), 0)).row
    assert told["people_compared"] == 3.0
    assert {name: row[name] for name in COST_NAMES} == pytest.approx(
        {name: told[name.removeprefix("cost.")] for name in COST_NAMES}, nan_ok=True
    )
    assert row[DROVE] > 0.0 < row[TWINS]
    columns = ("outcome", "time_to_goal", "path_length", "clearance_people_min")
    assert [row[name] for name in columns] == [run.episodes[name][0] for name in columns]


def test_twins_that_raise_leave_the_episode_as_it_is_with_the_reason(config, tmp_path, monkeypatch):
    def refuse(*what):
        raise ZeroDivisionError("division by zero")

    monkeypatch.setattr("arena_tuning.costing.cost_of_record", refuse)
    row = drive_and_cost(Job(config, str(tmp_path), 0)).row
    assert row["outcome"] == "goal_reached"
    assert row["cost.note"] == "ZeroDivisionError('division by zero')"


def test_without_people_no_twins_are_driven(config, tmp_path):
    nobody = {**config, "task": {**config["task"], "pedestrians": 0}}
    assert not set(COST_NAMES) & set(drive_and_cost(Job(nobody, str(tmp_path), 0)).row)
    assert drive(Job(nobody, str(tmp_path), 0)).row[TWINS] == 0.0
