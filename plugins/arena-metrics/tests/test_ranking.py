"""Ranks over all conditions, interquartile means, and performance profiles."""

import csv

import numpy as np
import pytest
from scipy.stats import trim_mean

from arena_core.statistics import interquartile_mean
from arena_metrics.pages.profiles import profile_image, slowdown_ratios
from arena_metrics.pooling.cells import cells_of
from arena_metrics.pooling.runs import metric_columns, pool_episodes, read_runs
from arena_metrics.pooling.summary import summarise_cells
from arena_metrics.tables.ranking import common_conditions, planner_ranks, ranking_table

FEW = ("success", "strict_success", "collisions", "spl", "time_to_goal")


def summary_of(folder):
    runs = read_runs([folder])
    return summarise_cells(cells_of(pool_episodes(runs)[0]), metric_columns(runs))


@pytest.fixture
def folder(tmp_path, run_folder):
    """Three planners on 20 problems among five and ten people: one always quick, one that takes half as
    long again, one that fails.
    """
    for people in (5, 10):
        for planner, fails in (("quick", [20]), ("slow", [20]), ("lost", range(20))):
            run_folder(
                tmp_path / f"{planner}{people}",
                planner,
                people=people,
                episodes=20,
                fails=fails,
                only=FEW,
                records=False,
            )
        table = tmp_path / f"slow{people}" / "episodes.csv"
        rows = list(csv.DictReader(table.read_text().splitlines()))
        with table.open("w", newline="") as file:
            writer = csv.DictWriter(file, rows[0], lineterminator="\n")
            writer.writeheader()
            writer.writerows({**row, "time_to_goal": 1.5 * float(row["time_to_goal"])} for row in rows)
    return tmp_path


def test_interquartile_mean_leaves_out_a_quarter_on_each_side():
    strata = [np.array([0.0, 100.0, 4.0, 5.0]), np.array([6.0, 7.0, -50.0, 1000.0, 5.5])]
    found = interquartile_mean(strata)
    assert found.mean == pytest.approx(trim_mean(np.concatenate(strata), 0.25))
    assert found.low <= found.mean <= found.high
    assert found.n == 9


def test_interquartile_mean_is_the_same_whenever_it_is_asked():
    strata = [np.arange(20.0), np.arange(7.0)]
    assert interquartile_mean(strata) == interquartile_mean(strata)


def test_interval_of_the_interquartile_mean_holds_the_truth_as_often_as_it_says():
    random = np.random.default_rng(4)
    held = [
        (f := interquartile_mean([random.normal(size=30), random.normal(size=30)])).low <= 0.0 <= f.high
        for _ in range(300)
    ]
    assert np.mean(held) == pytest.approx(0.95, abs=0.035)


def test_undefined_figures_and_few_problems_have_no_interval():
    assert interquartile_mean([np.array([np.nan])]).n == 0
    assert not interquartile_mean([np.array([1.0, 2.0, np.nan])]).has_interval


def test_planners_that_pairs_do_not_tell_apart_share_their_ranks(folder):
    summary = summary_of(folder)
    columns = {column.name: column for column in summary.columns}
    found = common_conditions(summary.cells)
    assert planner_ranks(found, columns["success"]) == {"quick": (1, 2), "slow": (1, 2), "lost": (3, 3)}
    assert planner_ranks(found, columns["collisions"]) == dict.fromkeys(("quick", "slow", "lost"), (1, 3))
    assert planner_ranks(found, columns["time_to_goal"]) == {}  # one has no pair with the others


def test_table_has_the_best_first_over_the_conditions_that_all_faced(folder):
    table = ranking_table(summary_of(folder))
    assert table.caption == "Ranking over the 2 conditions that all planners faced"
    assert [row[0] for row in table.rows][2] == "lost"
    assert {row[0]: row[3] for row in table.rows} == {"quick": "1–2", "slow": "1–2", "lost": "3"}
    assert {row[1] for row in table.rows} == {"40"}


def test_slowdown_is_over_the_quickest_and_infinite_where_a_planner_failed(folder):
    found = slowdown_ratios(common_conditions(summary_of(folder).cells))
    assert found["quick"] == pytest.approx(np.ones(40))
    assert found["slow"] == pytest.approx(np.full(40, 1.5))
    assert np.isinf(found["lost"]).all()


def test_profiles_are_drawn_and_a_single_planner_has_none(folder):
    assert profile_image(summary_of(folder), pdf=False).png.startswith(b"\x89PNG")
    alone = summary_of(folder / "quick5")
    assert profile_image(alone, pdf=False) is None
    assert ranking_table(alone) is None
