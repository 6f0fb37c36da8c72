"""Reports group failures by their cause, where someone has found it out."""

from arena_core.records import FindingColumn, Findings, write_findings
from arena_metrics.pages.causes import causes_image
from arena_metrics.pages.contents import pool_runs
from arena_metrics.pages.report import ReportCommand
from arena_metrics.pooling.runs import read_runs
from arena_metrics.tables.cause_table import cause_table, failures_to_explain

COLUMNS = (
    FindingColumn("cause", "text", "neither", "why"),
    FindingColumn("lead", "s", "neither", "until when"),
)
HIT, LOST = {"cause": "ran into", "lead": 1.5}, {"cause": "lost its pose", "lead": float("nan")}


def explain(folder, rows):
    write_findings(folder, Findings("explain", "abc", COLUMNS, rows))


def cells(*folders):
    return pool_runs(read_runs(folders)).summary.cells


def failed(cell):
    return [episode.row["episode"] for episode in cell.episodes if episode.row["strict_success"] == 0.0]


def test_each_cell_has_a_line_and_each_cause_a_column(run_folder, tmp_path):
    dwa, teb = (run_folder(tmp_path / name, planner=name, episodes=5) for name in ("dwa", "teb"))
    one, other = failed(cells(dwa).cells[0])[:2]
    explain(dwa, {one: HIT, other: LOST})
    explain(teb, {one: HIT, other: HIT})
    table = cause_table(cells(tmp_path))
    assert table.head == ["cell", "n", "ran into", "lost its pose", "strict success", "avoidable until [s]"]
    assert table.rows == [
        ["dwa", "5", "1", "1", "3", "1.5 before (n=1)"],
        ["teb", "5", "2", "0", "3", "1.5 before (n=2)"],
    ]
    assert causes_image(cells(tmp_path), pdf=False).name == "causes"


def test_failures_that_no_one_has_explained_are_counted(run_folder, tmp_path):
    folder = run_folder(tmp_path / "run", episodes=5)
    one = failed(cells(folder).cells[0])[0]
    assert failures_to_explain(cells(folder)) == 2
    assert cause_table(cells(folder)) is None
    explain(folder, {one: HIT})
    assert failures_to_explain(cells(folder)) == 1
    assert dict(zip(cause_table(cells(folder)).head, cause_table(cells(folder)).rows[0], strict=True)) == {
        **{"cell": "dwa", "n": "5", "ran into": "1", "strict success": "3", "not explained": "1"},
        "avoidable until [s]": "1.5 before (n=1)",
    }


def test_a_page_says_how_causes_are_found_out_and_shows_them_once_they_are(run_folder, tmp_path):
    folder = run_folder(tmp_path / "run", episodes=5)
    words = [str(folder), f"out={tmp_path / 'report'}", "--no-figures"]
    ReportCommand().run(words)
    page = (tmp_path / "report" / "index.html").read_text()
    assert "2 failures are not explained: <code>arena explain RUN</code>" in page
    explain(folder, dict.fromkeys(failed(cells(folder).cells[0]), HIT))
    ReportCommand().run(words)
    page = (tmp_path / "report" / "index.html").read_text()
    assert "not explained" not in page
    assert "ran into" in (tmp_path / "report" / "tables" / "causes.csv").read_text()
