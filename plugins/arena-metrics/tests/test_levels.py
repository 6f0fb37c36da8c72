"""The report shows which levels staged runs had, and how each block went."""

import pytest

from arena_metrics.pages.levels import level_image, level_table
from arena_metrics.pages.report import ReportCommand
from arena_metrics.pooling.cells import cells_of
from arena_metrics.pooling.runs import pool_episodes, read_runs

FEW = ("success", "collisions", "path_length")


def cells(folder):
    return cells_of(pool_episodes(read_runs([folder]))[0])


@pytest.mark.parametrize(
    ("block", "lines"),
    [
        (2, [["0 – 1", "0", "1 of 2"], ["2 – 3", "0", "1 of 2"], ["4 – 4", "1", "1 of 1"]]),
        (None, [["0 – 3", "0", "2 of 4"], ["4 – 4", "1", "1 of 1"]]),
    ],
)
def test_every_block_is_a_line(run_folder, tmp_path, block, lines):
    run_folder(tmp_path / "a", episodes=5, stages=(0, 0, 0, 0, 1), block=block)
    assert [row[2:] for row in level_table(cells(tmp_path)).rows] == lines


def test_seeds_are_runs_of_their_own(run_folder, tmp_path):
    for seed in (0, 1):
        run_folder(tmp_path / f"{seed}", episodes=2, stages=(0, 1), block=1, seed=seed)
    assert [row[1:4] for row in level_table(cells(tmp_path)).rows] == [
        [s, f"{i} – {i}", str(i)] for s in "01" for i in (0, 1)
    ]


def test_runs_that_are_not_staged_have_no_levels(run_folder, tmp_path):
    run_folder(tmp_path / "a")
    assert level_table(cells(tmp_path)) is None
    assert level_image(cells(tmp_path), pdf=False) is None


def test_report_of_a_staged_run_holds_table_and_figure(run_folder, tmp_path):
    run_folder(tmp_path / "staged", episodes=4, stages=(0, 0, 1, 1), block=2, only=FEW)
    run_folder(tmp_path / "other", planner="teb", only=FEW)
    assert ReportCommand().run([str(tmp_path), "--out", str(tmp_path / "out")]) == 0
    page = (tmp_path / "out" / "index.html").read_text()
    assert "<h2>Levels</h2>" in page
    assert "dwa ended on level 1 (highest 1)." in page
    assert "teb succeeded in 2 of 3 episodes" in page
    assert 'alt="levels: ' in page
    assert "2 – 3 | 1 | 1 of 2" in (tmp_path / "out" / "tables" / "levels.md").read_text()
    assert {path.name for path in (tmp_path / "out" / "figures").glob("levels.*")} == {"levels.png"}
