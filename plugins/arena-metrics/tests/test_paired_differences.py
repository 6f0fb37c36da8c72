"""Differences between planners on the same scenarios."""

import math

import numpy as np
import pytest

from arena_core import InputFileError
from arena_metrics.cells import cells_of
from arena_metrics.intervals import difference, estimate
from arena_metrics.pairs import paired_table
from arena_metrics.report import ReportCommand
from arena_metrics.runs import metric_columns, pooled, read_runs
from arena_metrics.summary import summarise

FEW = ("success", "collisions", "path_length")


def table_of(folder, baseline=None):
    runs = read_runs([folder])
    return paired_table(summarise(cells_of(pooled(runs)[0]), metric_columns(runs)), baseline)


def test_pairs_find_a_difference_that_is_smaller_than_the_scatter():
    random = np.random.default_rng(0)
    luck = random.normal(0.0, 10.0, 30)
    ours, theirs = luck + 1.0 + random.normal(0.0, 0.5, 30), luck
    paired, first, second = difference(ours, theirs), estimate(ours), estimate(theirs)
    assert paired.low > 0.0
    assert first.low < second.high


def test_pair_counts_only_where_both_are_defined():
    assert difference([1.0, np.nan, 3.0, 5.0], [0.0, 1.0, np.nan, 2.0]).n == 2


def test_interval_of_paired_proportions_is_that_of_agresti_and_min():
    ours = np.array([1.0] * 18 + [0.0] * 12)
    theirs = np.array([1.0] * 10 + [0.0] * 8 + [1.0] * 2 + [0.0] * 10)
    found = difference(ours, theirs, proportion=True)
    won, lost, n = 8.5, 2.5, 32
    half = 1.959964 * math.sqrt(won + lost - (won - lost) ** 2 / n) / n
    assert found.mean == pytest.approx(0.2)
    assert (found.low, found.high) == pytest.approx(((won - lost) / n - half, (won - lost) / n + half), abs=1e-6)


def test_equal_proportions_are_not_certain_to_be_equal():
    found = difference(np.ones(30), np.ones(30), proportion=True)
    assert found.mean == 0.0
    assert found.low < 0.0 < found.high


def test_difference_from_itself_has_the_opposite_sign_of_its_mirror():
    ours, theirs = np.random.default_rng(1).normal(size=(2, 20))
    one, other = difference(ours, theirs), difference(theirs, ours)
    assert (one.mean, one.low) == pytest.approx((-other.mean, -other.high), abs=0.02)


def test_every_other_planner_is_compared_under_its_own_condition(run_folder, tmp_path):
    for planner in ("dwa", "mpc", "teb"):
        for people in (5, 10):
            run_folder(tmp_path / f"{planner}{people}", planner=planner, people=people, episodes=4)
    table = table_of(tmp_path)
    assert [row[:2] for row in table.rows] == [[f"{n} people", f"{p} − dwa"] for n in (5, 10) for p in ("mpc", "teb")]
    assert table.rows[0][2].startswith("+0 [")
    assert table.rows[0][2].endswith("(4)")
    assert [row[1] for row in table_of(tmp_path, "teb").rows[:2]] == ["dwa − teb", "mpc − teb"]


def test_scenarios_that_only_one_drove_are_no_pairs(run_folder, tmp_path):
    run_folder(tmp_path / "a", planner="dwa", episodes=6)
    run_folder(tmp_path / "b", planner="teb", episodes=4, errors=(1,))
    assert table_of(tmp_path).rows[0][1].endswith("(3)")


def test_staged_episodes_are_no_pairs(run_folder, tmp_path):
    for planner in ("dwa", "teb"):
        run_folder(tmp_path / planner, planner=planner, stages=(0, 0, 1))
    assert table_of(tmp_path) is None


def test_without_a_rival_there_is_no_table(run_folder, tmp_path):
    assert table_of(run_folder(tmp_path / "a")) is None


def test_report_holds_the_pairs_and_refuses_an_unknown_baseline(run_folder, tmp_path):
    for planner in ("dwa", "teb"):
        run_folder(tmp_path / planner, planner=planner, only=FEW)
    assert ReportCommand().run([str(tmp_path), "--out", str(tmp_path / "out"), "--no-figures", "--baseline", "teb"]) == 0
    assert "dwa − teb" in (tmp_path / "out" / "tables" / "paired_differences.md").read_text()
    assert "Differences in pairs" in (tmp_path / "out" / "index.html").read_text()
    with pytest.raises(InputFileError, match="allowed: dwa, teb"):
        ReportCommand().run([str(tmp_path), "--out", str(tmp_path / "out"), "--baseline", "mpc"])
