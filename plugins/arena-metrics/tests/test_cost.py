"""What the run cost, from the times of whole episodes."""

import csv

import pytest

from arena_metrics.pooling.cells import cells_of
from arena_metrics.pooling.runs import pool_episodes, read_runs
from arena_metrics.tables.cost import cost_table, format_duration


def timed(folder, cpu):
    """Give every episode of a run the same CPU time, s, and twice as much of the clock on the wall."""
    table = folder / "episodes.csv"
    rows = list(csv.DictReader(table.read_text().splitlines()))
    with table.open("w", newline="") as file:
        writer = csv.DictWriter(file, rows[0], lineterminator="\n")
        writer.writeheader()
        writer.writerows({**row, "planning_episode_cpu": cpu, "planning_episode_time": 2.0 * cpu} for row in rows)


def table_of(folder):
    return cost_table(cells_of(pool_episodes(read_runs([folder]))[0]))


def test_costliest_planner_stands_first_and_all_together_last(tmp_path, run_folder):
    for planner, cpu in (("quick", 1.5), ("slow", 90.0)):
        timed(run_folder(tmp_path / planner, planner, episodes=4, records=False), cpu)
    rows = table_of(tmp_path).rows
    assert [row[0] for row in rows] == ["slow", "quick", "all"]
    assert rows[1] == ["quick", "4", "1.50", "1.50", "3.00", "–", "6 s"]
    assert rows[2][1:3] == ["8", "45.75"]
    assert rows[2][-1] == "6 min"


def test_runs_that_were_not_timed_as_a_whole_have_no_table(tmp_path, run_folder):
    run_folder(tmp_path / "old", records=False)
    assert table_of(tmp_path) is None


@pytest.mark.parametrize(("seconds", "text"), [(0.0, "0 s"), (119.0, "119 s"), (600.0, "10 min"), (9000.0, "2.5 h")])
def test_durations_read_as_one_says_them(seconds, text):
    assert format_duration(seconds) == text
