"""Bold in the headline: only where pairs of the same scenarios show one planner to be better than all others."""

import numpy as np

from arena_metrics.pages.headline import make_headline
from arena_metrics.pooling.cells import cells_of
from arena_metrics.pooling.runs import metric_columns, pool_episodes, read_runs
from arena_metrics.pooling.summary import summarise_cells

FEW = ("success", "strict_success", "collisions", "path_length", "time_to_goal")


def bold_planners(folder, metric, change=lambda planner, row: row):
    """Return the planners whose figure of a metric is bold, where each row was changed first."""
    runs = read_runs([folder])
    for run in runs:
        for row in run.rows:
            row.update(change(row["preset"], row))
    summary = summarise_cells(cells_of(pool_episodes(runs)[0]), metric_columns(runs))
    headline = make_headline(summary)
    place = [heading.name for heading in headline.headings].index(metric)
    return [line.name for group in headline.groups for line in group.lines if line.figures[place].best]


def test_planner_that_fails_the_hard_half_gets_no_bold_for_its_time(run_folder, tmp_path):
    """teb is as quick as dwa where both arrive; its mean is lower because it never arrives where the way is long."""
    run_folder(tmp_path / "dwa", planner="dwa", episodes=24, only=FEW, fails=[])
    run_folder(tmp_path / "teb", planner="teb", episodes=24, only=FEW, fails=range(12, 24))
    seconds = np.where(np.arange(24) < 12, 10.0, 60.0) + 0.1 * (np.arange(24) % 3)

    def change(planner, row):
        arrived = float(planner == "dwa" or row["episode"] < 12)
        return {"success": arrived, "time_to_goal": seconds[row["episode"]]}

    assert bold_planners(tmp_path, "time_to_goal", change) == []
    assert bold_planners(tmp_path, "success", change) == ["dwa"]


def test_planner_that_is_sooner_in_pairs_is_bold_whatever_its_mean(run_folder, tmp_path):
    for planner in ("dwa", "teb"):
        run_folder(tmp_path / planner, planner=planner, episodes=12, only=FEW, fails=[])

    def change(planner, row):
        return {
            "success": 1.0,
            "time_to_goal": 20.0 + 5.0 * (row["episode"] % 4) - (planner == "teb") * (1.0 + 0.01 * row["episode"]),
        }

    assert bold_planners(tmp_path, "time_to_goal", change) == ["teb"]


def test_next_to_equal_planners_have_no_bold(run_folder, tmp_path):
    run_folder(tmp_path / "dwa", planner="dwa", episodes=12, only=FEW, fails=[0])
    run_folder(tmp_path / "teb", planner="teb", episodes=12, only=FEW, fails=[0, 1])
    assert bold_planners(tmp_path, "success") == []
