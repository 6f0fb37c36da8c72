"""What sees the truth stands in every ranking, and competes in none."""

from __future__ import annotations

import csv
from pathlib import Path

import pytest

from arena_core import InputFileError, Runs, run
from arena_metrics.pages.contents import pool_runs
from arena_metrics.pages.headline import make_headline, summary_sentences
from arena_metrics.pooling.runs import read_runs
from arena_metrics.pooling.summary import Summary
from arena_metrics.tables.pairs import comparison_rows, paired_tables
from arena_metrics.tables.ranking import ranking_table
from arena_metrics.tables.tables import headline_table, metric_tables

pytestmark = pytest.mark.slow
ROOM = ["robot=jackal", "world=empty", "world.width=8", "world.height=6", "task.pedestrians=4"]
FEW = ["localizer=ground_truth", "episodes=2", "seed=3", "executor=serial", "report=false"]
CERTIFIED, SIGHTED = "clairvoyant (no competitor)", "sighted (no competitor)"


@pytest.fixture(scope="module")
def runs(tmp_path_factory) -> Runs:
    """Return runs of two planners and of `sighted` on two problems, with a reference."""
    words = ["planner=pure_pursuit,sighted", "reference=clairvoyant", *ROOM, *FEW]
    folder = tmp_path_factory.mktemp("rows") / "runs"
    run(words, folder / "seeing")
    run(["planner=pure_pursuit", "planner.speed=1.9", "reference=clairvoyant", *ROOM, *FEW], folder / "fast")
    return Runs.below(folder)


@pytest.fixture(scope="module")
def summary(runs: Runs) -> Summary:
    return pool_runs(read_runs([one.folder for one in runs])).summary


def test_a_ranking_has_a_row_for_each_reference_without_a_rank(summary: Summary) -> None:
    table = ranking_table(summary)
    assert table is not None
    ranks = {row[0]: [text for head, text in zip(table.head, row, strict=True) if head == "rank"] for row in table.rows}
    assert list(ranks)[2:] == [SIGHTED, CERTIFIED]
    assert set(ranks[CERTIFIED]) == set(ranks[SIGHTED]) == {"–"}
    assert all(set(found) != {"–"} for name, found in ranks.items() if name.startswith("pure_pursuit"))
    assert [row[1] for row in table.rows] == ["2"] * 4


def test_references_stand_in_the_headline_and_in_the_tables_of_all_metrics(summary: Summary) -> None:
    shown = headline_table(summary)
    rows = {row[shown.head.index("planner")]: row for row in shown.rows}
    assert rows.keys() >= {CERTIFIED, SIGHTED}
    assert rows[CERTIFIED][shown.head.index("success [%]")].startswith("100")
    assert any(CERTIFIED in name for table in metric_tables(summary, "all") for name in table.head)
    lines = [line for group in make_headline(summary).groups for line in group.lines]
    assert [line.name for line in lines][-1] == CERTIFIED
    assert not any(figure.best for line in lines for figure in line.figures if line.name in (CERTIFIED, SIGHTED))


def test_a_certificate_has_the_figures_of_its_own_record(summary: Summary, runs: Runs) -> None:
    (cell,) = summary.certificates
    assert cell.values("time_to_goal") == cell.values("reference.time_certified")
    assert cell.values("reference.stl") == [1.0, 1.0]
    assert cell.values("reference.time_regret") == [0.0, 0.0]
    assert cell.values("collisions") == [0.0, 0.0]


def test_no_test_of_significance_and_no_sentence_has_a_reference(summary: Summary) -> None:
    compared = list(comparison_rows(summary.cells, summary.columns))
    assert compared
    assert not any("competitor" in row[name] for row in compared for name in ("planner", "baseline"))
    assert not any("competitor" in row[0] for table in paired_tables(summary) for row in table.rows)
    assert not any("competitor" in sentence for sentence in summary_sentences(summary))


def test_certificates_count_as_no_episodes(summary: Summary) -> None:
    assert [cell.factors["planner"] for cell in summary.cells.cells].count(CERTIFIED) == 0
    assert sum(len(cell.episodes) for cell in summary.cells.cells) == 6


def test_files_of_a_report_name_references_and_a_reference_is_no_baseline(runs: Runs, tmp_path: Path) -> None:
    runs.report(tmp_path / "report")
    for name in ("headline", "ranking", "all_episodes"):
        assert CERTIFIED in (tmp_path / "report" / "tables" / f"{name}.csv").read_text(encoding="utf-8")
    with (tmp_path / "report" / "summary.csv").open(encoding="utf-8", newline="") as lines:
        assert CERTIFIED in {row["planner"] for row in csv.DictReader(lines)}
    with pytest.raises(InputFileError, match=r"baseline is clairvoyant; allowed: pure_pursuit$"):
        runs.report(tmp_path / "other", "clairvoyant")


def test_where_the_clairvoyant_drove_itself_its_own_episodes_count(tmp_path: Path) -> None:
    words = ["planner=pure_pursuit,clairvoyant", "reference=clairvoyant", *ROOM, *FEW, "episodes=1"]
    driven = run(words, tmp_path / "runs")
    found = pool_runs(read_runs([one.folder for one in driven])).summary
    assert [cell.factors["planner"] for cell in found.shown.cells] == [CERTIFIED, "pure_pursuit"]
    assert not found.certificates
