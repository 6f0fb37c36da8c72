"""``arena report``: tables, figures and one page over all runs below the given folders."""

from __future__ import annotations

import argparse
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Literal

from arena_core import InputFileError
from arena_core.commands import Command, align_columns, split_out
from arena_core.files import check_inside, write_bytes_whole, write_text_whole
from arena_core.records import Reporter
from arena_metrics.one_thread import on_one_thread

if TYPE_CHECKING:
    from arena_metrics.pages.page import PageImages, PageTables
    from arena_metrics.pooling.cells import Cells
    from arena_metrics.pooling.drives import Drive
    from arena_metrics.pooling.runs import Run
    from arena_metrics.pooling.summary import Summary
    from arena_metrics.tables.tables import Table

Figures = Literal["headline", "all", "none"]
PICTURES = 12  # cells whose trajectories are drawn unless --pictures says otherwise
REPLAYS = 6  # episodes that have a replay unless --replays says otherwise
OPTIONS = ("out=", "--pictures", "--replays", "--baseline", "--pdf", "--all-figures", "--no-figures", "--claims")
USAGE = "arena report DIR... [out=DIR] [options]"
PLACE = "out=DIR: where to write (default: report/ in the first folder; only then are the runs' own summaries renewed)"
PARTS = ("", "tables", "figures", "replays")  # folders that a report writes to
PRINTED = 40  # rows of the headline that go to the terminal


class Report(Reporter):
    """Tables, figures and one page over runs, and how their planners differ."""

    @on_one_thread
    def report(self, folders: Sequence[Path], target: Path, baseline: str | None = None) -> None:
        """Write the report and print its headline and place; a report inside the runs' own folder
        renews their summaries too.
        """
        from arena_metrics.pooling.runs import read_runs

        runs = read_runs(folders)
        if target == folders[0] / "report":
            _write_summaries(runs)
        write_report(runs, target, baseline=baseline)

    @on_one_thread
    def compare(self, folders: Sequence[Path], baseline: str | None = None) -> list[dict[str, Any]]:
        """Return a row for each planner, condition and metric: the mean difference to the
        baseline, its interval, p and effect.
        """
        from arena_metrics.pooling.cells import cells_of
        from arena_metrics.pooling.runs import metric_columns, pool_episodes, read_runs
        from arena_metrics.tables.pairs import comparison_rows

        runs = read_runs(folders)
        cells = cells_of(pool_episodes(runs)[0])
        _check_baseline(cells, baseline)
        return list(comparison_rows(cells, metric_columns(runs), baseline))


class ReportCommand(Command):
    """Make tables (CSV, Markdown, LaTeX), figures (PNG, with --pdf PDF) and one HTML page over
    all runs below the given folders.
    """

    help: ClassVar[str] = "tables, figures and one HTML page: arena report DIR... [out=DIR]"

    @on_one_thread
    def run(self, arguments: Sequence[str]) -> int:
        """Write the report and print its headline and place."""
        from arena_metrics.pooling.runs import read_runs

        words, out = split_out(arguments)
        given = _build_parser(self.__doc__).parse_args(words)
        folders = [Path(directory) for directory in given.directories]
        runs = read_runs(folders)
        target = Path(out) if out else folders[0] / "report"
        if out is None:
            _write_summaries(runs)
        figures: Figures = "none" if given.no_figures else "all" if given.all_figures else "headline"
        write_report(runs, target, given.pictures, figures, given.baseline, given.claims, given.replays, pdf=given.pdf)
        return 0

    def complete(self, words: Sequence[str], word: str) -> Sequence[str]:
        """Return the options; folders are the shell's."""
        return [option for option in OPTIONS if option.startswith(word)] if word[:1] in ("-", "o") else ()


def _build_parser(description: str | None) -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser("arena report", usage=USAGE, description=description, epilog=PLACE)
    parser.add_argument("directories", nargs="+", metavar="DIR", help="a run's folder, or one above several")
    parser.add_argument(
        "--pictures",
        type=int,
        default=PICTURES,
        metavar="N",
        help=f"most cells whose trajectories are drawn (default {PICTURES})",
    )
    parser.add_argument(
        "--replays",
        type=int,
        default=REPLAYS,
        metavar="N",
        help=f"most episodes that have a replay, failures first (default {REPLAYS})",
    )
    parser.add_argument(
        "--baseline", metavar="PLANNER", help="what the other planners are compared with in pairs (default: the first)"
    )
    parser.add_argument("--pdf", action="store_true", help="write each figure as PDF too, for print")
    parser.add_argument("--all-figures", action="store_true", help="draw every metric, not those of the headline alone")
    parser.add_argument(
        "--claims", metavar="NAME", help="say which claims of a source hold: paper, or a file of your own"
    )
    parser.add_argument("--no-figures", action="store_true", help="tables alone, within seconds")
    return parser


def write_report(
    runs: Sequence[Run],
    target: Path,
    pictures: int = PICTURES,
    figures: Figures = "headline",
    baseline: str | None = None,
    claims: str | None = None,
    replays: int = REPLAYS,
    *,
    pdf: bool = False,
) -> None:
    """Write a report over these runs to the folder ``target``; raise InputFileError when they hold no episode, or not
    the baseline.

    ``claims`` names a file of claims to judge. ``figures`` says which metrics are drawn; with none, no record is read
    and no picture drawn either, and there are no ``replays``.
    """
    from arena_metrics.pages.levels import level_table
    from arena_metrics.pages.page import PageImages, PageTables, Pooled, render_page
    from arena_metrics.pages.replays import write_replays
    from arena_metrics.pooling.cells import cells_of
    from arena_metrics.pooling.runs import metric_columns, pool_episodes
    from arena_metrics.pooling.summary import summarise_cells
    from arena_metrics.tables.pairs import paired_tables
    from arena_metrics.tables.problem_table import problem_table
    from arena_metrics.tables.query import write_table
    from arena_metrics.tables.ranking import ranking_table

    for part in PARTS:
        check_inside(target.parent if target.name == "report" else target, target / part)
    episodes, repeats = pool_episodes(runs)
    if not episodes:
        raise InputFileError(
            f"{runs[0].folder / 'episodes.csv'}: holds no episode yet; allowed: a run with one finished episode or more"
        )
    summary = summarise_cells(cells_of(episodes), metric_columns(runs))
    _check_baseline(summary.cells, baseline)
    judged = _judge_claims(summary, claims, target) if claims else None
    tables = PageTables(
        judged,
        pairs=paired_tables(summary, baseline),
        levels=level_table(summary.cells),
        problems=problem_table(summary.cells, summary.columns),
        ranking=ranking_table(summary),
        of_drives=(),
    )
    _write_tables(summary, tables, target)
    write_table([run.folder for run in runs], target / "tables" / "episodes.parquet")
    drives = _read_drives(summary, pictures) if figures != "none" else {}
    tables = tables._replace(of_drives=_tables_of_drives(summary, drives, target))
    images = PageImages((), (), ())
    if figures != "none":
        images = _draw_pictures(summary, drives, target, figures, pdf=pdf)
    shown = write_replays(summary.cells, target, replays if figures != "none" else 0)
    page = render_page(Pooled(summary, runs, repeats), baseline, tables, images, shown)
    write_text_whole(target / "index.html", page)
    _print_headline(summary, baseline)
    if judged is not None:
        print("\n".join(f"{row[1]}: {row[0]}" for row in judged.rows))
    print(f"report: {target / 'index.html'}")


def _check_baseline(cells: Cells, baseline: str | None) -> None:
    planners = sorted({cell.factors["planner"] for cell in cells.cells})
    if baseline is not None and baseline not in planners:
        raise InputFileError(f"baseline is {baseline}; allowed: {', '.join(planners)}")


def _write_summaries(runs: Sequence[Run]) -> None:
    """Renew the summary in every run's own folder."""
    from arena_metrics.pooling.cells import cells_of
    from arena_metrics.pooling.runs import metric_columns, pool_episodes
    from arena_metrics.pooling.summary import summarise_cells, summary_csv

    columns = metric_columns(runs)
    for run in runs:
        episodes, _ = pool_episodes([run])
        if episodes:
            write_text_whole(run.folder / "summary.csv", summary_csv(summarise_cells(cells_of(episodes), columns)))


def _judge_claims(summary: Summary, name: str, target: Path) -> Table:
    """Write and return what the runs say of a source's claims."""
    from arena_metrics.claims.claim_verdicts import claims_table, judge_claims
    from arena_metrics.claims.model import read_claims

    claims = read_claims(name)
    table = claims_table(judge_claims(summary.cells, summary.columns, claims), claims.source)
    _write_table(target, "claims", [table])
    return table


def _write_tables(summary: Summary, tables: PageTables, target: Path) -> None:
    from arena_metrics.pooling.summary import summary_csv
    from arena_metrics.tables.cost import cost_table
    from arena_metrics.tables.tables import headline_table, metric_tables

    cost = cost_table(summary.cells)
    write_text_whole(target / "summary.csv", summary_csv(summary))
    contents: dict[str, Sequence[Table]] = {
        "headline": [headline_table(summary)],
        "ranking": [tables.ranking] if tables.ranking else [],
        "all_episodes": metric_tables(summary, "all"),
        "successful_episodes": metric_tables(summary, "successful"),
        "paired_differences": tables.pairs,
        "levels": [tables.levels] if tables.levels else [],
        "problems": [tables.problems] if tables.problems else [],
        "cost": [cost] if cost else [],
    }
    for name, content in ((name, content) for name, content in contents.items() if content):
        _write_table(target, name, content)


def _write_table(target: Path, name: str, content: Sequence[Table]) -> None:
    from arena_metrics.tables.tables import csv_tables, latex_tables, markdown_tables

    write_text_whole(target / "tables" / f"{name}.csv", csv_tables(content))
    write_text_whole(target / "tables" / f"{name}.md", markdown_tables(content))
    write_text_whole(target / "tables" / f"{name}.tex", latex_tables(content))


def _read_drives(summary: Summary, pictures: int) -> dict[str, list[Drive]]:
    """Read the records of the cells that are drawn, by the cells' hashes."""
    from arena_metrics.pooling.drives import drives_of

    return {cell.hash: drives_of(summary.cells, cell) for cell in summary.cells.cells[: max(0, pictures)]}


def _tables_of_drives(summary: Summary, drives: Mapping[str, Sequence[Drive]], target: Path) -> list[Table]:
    """Write and return what the records of the cells drawn say together: repeats of one problem, and
    planners on the same scenarios.
    """
    from arena_metrics.tables.repeats import distances_table, repeats_table

    found = {"repeats": repeats_table(summary.cells, drives), "path_distances": distances_table(summary.cells, drives)}
    known = {name: table for name, table in found.items() if table is not None}
    for name, table in known.items():
        _write_table(target, name, [table])
    return list(known.values())


def _draw_pictures(
    summary: Summary, drives: Mapping[str, Sequence[Drive]], target: Path, figures: Figures, *, pdf: bool
) -> PageImages:
    """Draw and write the figures of metrics, pictures and levels."""
    from arena_metrics.pages.figures import metric_figures, report_style
    from arena_metrics.pages.levels import level_image
    from arena_metrics.pages.page import PageImages
    from arena_metrics.pages.panels import picture_layouts
    from arena_metrics.pages.profiles import profile_image
    from arena_metrics.pages.trajectories import cell_image
    from arena_metrics.tables.tables import headline_columns

    cells = summary.cells
    columns = summary.columns if figures == "all" else [column for column, _ in headline_columns(summary)]
    panels = picture_layouts(cells, drives)
    with report_style():
        profiles = profile_image(summary, pdf=pdf)
        metrics = [*([profiles] if profiles else []), *metric_figures(cells, columns, pdf=pdf)]
        images = [
            cell_image(cells, cell, drives[cell.hash], panels[cells.condition(cell)], pdf=pdf)
            for cell in cells.cells
            if drives.get(cell.hash)
        ]
        levels = [image for image in [level_image(cells, pdf=pdf)] if image is not None]
    for image in [*metrics, *images, *levels]:
        write_bytes_whole(target / "figures" / f"{image.name}.png", image.png)
        if image.pdf is not None:
            write_bytes_whole(target / "figures" / f"{image.name}.pdf", image.pdf)
    return PageImages(metrics, images, levels)


def _print_headline(summary: Summary, baseline: str | None) -> None:
    """Print the headline table with aligned columns, and what it answers."""
    from arena_metrics.pages.headline import summary_sentences
    from arena_metrics.tables.tables import headline_table

    table = headline_table(summary)
    print("\n".join(align_columns([table.head, *table.rows[:PRINTED]])))
    if len(table.rows) > PRINTED:
        print(f"... {len(table.rows) - PRINTED} more")
    print("\n".join(summary_sentences(summary, baseline)))
