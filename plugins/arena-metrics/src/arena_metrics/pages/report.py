"""``arena report``: tables, figures and one page over all runs below the given folders."""

from __future__ import annotations

import argparse
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

from arena_core import ConfigurationError, InputFileError
from arena_core.commands import Command, align_columns, split_out
from arena_core.files import check_inside, write_bytes_whole, write_text_whole
from arena_core.records import Reporter
from arena_metrics.one_thread import on_one_thread
from arena_metrics.pages.options import PICTURES, REPLAYS, ReportOptions

if TYPE_CHECKING:
    from arena_metrics.pages.contents import ReportContent
    from arena_metrics.pages.figures import Image
    from arena_metrics.pooling.cells import Cells
    from arena_metrics.pooling.runs import Run
    from arena_metrics.tables.tables import Table

COLUMNS = "report.columns="
OPTIONS = (
    "out=",
    COLUMNS,
    "--pictures",
    "--replays",
    "--baseline",
    "--pdf",
    "--all-figures",
    "--no-figures",
    "--claims",
)
USAGE = "arena report DIR... [out=DIR] [report.columns=METRIC,METRIC] [options]"
PLACE = (
    "out=DIR: where to write (default: report/ in the first folder; only then are the runs' own summaries renewed); "
    "report.columns=METRIC,METRIC: the columns of the headline"
)
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
        write_report(runs, target, ReportOptions(baseline=baseline))

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

        words, out = split_out([word for word in arguments if not word.startswith(COLUMNS)])
        given = _build_parser(self.__doc__).parse_args(words)
        folders = [Path(directory) for directory in given.directories]
        runs = read_runs(folders)
        target = Path(out) if out else folders[0] / "report"
        if out is None:
            _write_summaries(runs)
        options = ReportOptions(
            baseline=given.baseline,
            claims=given.claims,
            figures="none" if given.no_figures else "all" if given.all_figures else "headline",
            pictures=given.pictures,
            replays=given.replays,
            pdf=given.pdf,
            columns=_columns(arguments),
        )
        write_report(runs, target, options)
        return 0

    def complete(self, words: Sequence[str], word: str) -> Sequence[str]:
        """Return the options; folders are the shell's."""
        return [option for option in OPTIONS if option.startswith(word)] if word[:1] in ("-", "o", "r") else ()


def _columns(arguments: Sequence[str]) -> tuple[str, ...]:
    """Return the columns that were chosen for the headline, none where the usual ones are wanted."""
    given = [word.removeprefix(COLUMNS).strip("[]") for word in arguments if word.startswith(COLUMNS)]
    names = [name.strip() for text in given for name in text.split(",")]
    if len(given) > 1 or not all(names):
        raise ConfigurationError(f"{COLUMNS}{','.join(given)}; allowed: {COLUMNS}METRIC,METRIC, once")
    return tuple(dict.fromkeys(names))


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


def write_report(runs: Sequence[Run], target: Path, options: ReportOptions) -> None:
    """Write a report over these runs to the folder ``target``, tables first; raise InputFileError when they hold no
    episode, or not the baseline.
    """
    from arena_metrics.pages import contents, images
    from arena_metrics.pages.page import render
    from arena_metrics.pages.replays import write_replays
    from arena_metrics.pooling.summary import summary_csv
    from arena_metrics.tables.query import write_table

    for part in PARTS:
        check_inside(target.parent if target.name == "report" else target, target / part)
    pooled = contents.pool_runs(runs, options.columns)
    summary, drawn_at_all = pooled.summary, options.figures != "none"
    _check_baseline(summary.cells, options.baseline)
    tables = contents.compute_tables(summary, options, pooled.ladders)
    write_text_whole(target / "summary.csv", summary_csv(summary))
    _write_tables(target, tables.by_file())
    write_table([run.folder for run in runs], target / "tables" / "episodes.parquet")
    drives = contents.read_drives(summary.cells, options.pictures) if drawn_at_all else {}
    tables = replace(tables, of_drives=contents.compute_tables_of_drives(summary, drives))
    _write_tables(target, {name: [table] for name, table in tables.of_drives.items()})
    drawn = images.draw_images(summary, drives, options, pooled.ladders)
    _write_images(target, drawn)
    replays = write_replays(summary.cells, target, options.replays if drawn_at_all else 0)
    shown = images.show_images(summary, drawn)
    content = contents.gather_content(pooled, options.baseline, tables, shown, replays)
    write_text_whole(target / "index.html", render(content))
    _print_headline(content)
    print(f"report: {target / 'index.html'}")


def _check_baseline(cells: Cells, baseline: str | None) -> None:
    planners = sorted({cell.factors["planner"] for cell in cells.cells if cell.competes})
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


def _write_tables(target: Path, tables: Mapping[str, Sequence[Table]]) -> None:
    """Write tables as CSV, Markdown and LaTeX, by the names of their files."""
    from arena_metrics.tables.tables import csv_tables, latex_tables, markdown_tables

    for name, content in tables.items():
        write_text_whole(target / "tables" / f"{name}.csv", csv_tables(content))
        write_text_whole(target / "tables" / f"{name}.md", markdown_tables(content))
        write_text_whole(target / "tables" / f"{name}.tex", latex_tables(content))


def _write_images(target: Path, images: Iterable[Image]) -> None:
    for image in images:
        write_bytes_whole(target / "figures" / f"{image.name}.png", image.png)
        if image.pdf is not None:
            write_bytes_whole(target / "figures" / f"{image.name}.pdf", image.pdf)


def _print_headline(content: ReportContent) -> None:
    """Print the headline table with aligned columns, what it answers, and the verdicts on claims."""
    table, claims = content.tables.headline, content.tables.claims
    print("\n".join(align_columns([table.head, *table.rows[:PRINTED]])))
    if len(table.rows) > PRINTED:
        print(f"... {len(table.rows) - PRINTED} more")
    print("\n".join(content.answers))
    if claims is not None:
        print("\n".join(f"{row[1]}: {row[0]}" for row in claims.rows))
