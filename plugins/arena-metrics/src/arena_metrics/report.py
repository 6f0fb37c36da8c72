"""``arena report``: tables, figures and one page over all runs below the given folders."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

from arena_core import Command, InputFileError, write_bytes_whole, write_text_whole

if TYPE_CHECKING:
    from arena_metrics.figures import Image
    from arena_metrics.runs import Run
    from arena_metrics.summary import Summary
    from arena_metrics.tables import Table

PICTURES = 12  # cells whose trajectories are drawn unless --pictures says otherwise
PRINTED = 40  # rows of the headline that go to the terminal


class ReportCommand(Command):
    """Make tables (CSV, Markdown, LaTeX), figures (PNG, PDF) and one HTML page over all runs below the given folders."""

    help: ClassVar[str] = "tables, figures and one HTML page: arena report DIR..."

    def run(self, arguments: Sequence[str]) -> int:
        """Write the report and print its headline and place."""
        from arena_metrics.runs import read_runs

        given = _parser(self.__doc__).parse_args(list(arguments))
        runs = read_runs(Path(directory) for directory in given.directories)
        target = Path(given.out) if given.out else Path(given.directories[0]) / "report"
        if given.out is None:
            _write_summaries(runs)
        write_report(runs, target, given.pictures, figures=not given.no_figures, baseline=given.baseline)
        return 0


def _parser(description: str | None) -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser("arena report", description=description)
    parser.add_argument("directories", nargs="+", metavar="DIR", help="a run's folder, or one above several")
    parser.add_argument(
        "--out", metavar="DIR", help="where to write (default: report/ in the first folder; only then are the runs' own summaries renewed)"
    )
    parser.add_argument(
        "--pictures", type=int, default=PICTURES, metavar="N", help=f"most cells whose trajectories are drawn (default {PICTURES})"
    )
    parser.add_argument("--baseline", metavar="PLANNER", help="what the other planners are compared with in pairs (default: the first)")
    parser.add_argument("--no-figures", action="store_true", help="tables alone, within seconds")
    return parser


def write_report(runs: Sequence[Run], target: Path, pictures: int = PICTURES, figures: bool = True, baseline: str | None = None) -> None:
    """Write a report over these runs to the folder ``target``; raise InputFileError when they hold no episode, or not the baseline."""
    from arena_metrics.cells import cells_of
    from arena_metrics.levels import level_table
    from arena_metrics.page import render
    from arena_metrics.pairs import paired_table
    from arena_metrics.runs import metric_columns, pooled
    from arena_metrics.summary import summarise

    episodes, repeats = pooled(runs)
    if not episodes:
        raise InputFileError(f"{runs[0].folder / 'episodes.csv'}: holds no episode yet; allowed: a run with one finished episode or more")
    summary = summarise(cells_of(episodes), metric_columns(runs))
    planners = sorted({cell.factors["planner"] for cell in summary.cells.cells})
    if baseline is not None and baseline not in planners:
        raise InputFileError(f"--baseline is {baseline}; allowed: {', '.join(planners)}")
    pairs, levels = paired_table(summary, baseline), level_table(summary.cells)
    _write_tables(summary, pairs, levels, target)
    drawn = _draw(summary, pictures, target) if figures else ([], [], [])
    write_text_whole(target / "index.html", render(summary, pairs, levels, runs, repeats, *drawn))
    _print_headline(summary)
    print(f"report: {target / 'index.html'}")


def _write_summaries(runs: Sequence[Run]) -> None:
    """Renew the summary in every run's own folder."""
    from arena_metrics.cells import cells_of
    from arena_metrics.runs import metric_columns, pooled
    from arena_metrics.summary import summarise, summary_csv

    columns = metric_columns(runs)
    for run in runs:
        episodes, _ = pooled([run])
        if episodes:
            write_text_whole(run.folder / "summary.csv", summary_csv(summarise(cells_of(episodes), columns)))


def _write_tables(summary: Summary, pairs: Table | None, levels: Table | None, target: Path) -> None:
    from arena_metrics.summary import summary_csv
    from arena_metrics.tables import comma_separated, headline, latex, markdown, metric_tables

    write_text_whole(target / "summary.csv", summary_csv(summary))
    tables: dict[str, list[Table]] = {
        "headline": [headline(summary)],
        "all_episodes": metric_tables(summary, "all"),
        "successful_episodes": metric_tables(summary, "successful"),
        "paired_differences": [pairs] if pairs else [],
        "levels": [levels] if levels else [],
    }
    for name, content in ((name, content) for name, content in tables.items() if content):
        write_text_whole(target / "tables" / f"{name}.csv", comma_separated(content))
        write_text_whole(target / "tables" / f"{name}.md", markdown(content))
        write_text_whole(target / "tables" / f"{name}.tex", latex(content))


def _draw(summary: Summary, pictures: int, target: Path) -> tuple[list[Image], list[Image], list[Image]]:
    """Draw and write the figures of all metrics (with one cell and nothing to compare: of the headline alone), pictures and levels."""
    from arena_metrics.figures import metric_figures, style
    from arena_metrics.levels import level_image
    from arena_metrics.tables import headline_columns
    from arena_metrics.trajectories import cell_image

    cells = summary.cells
    columns = summary.columns if len(cells.cells) > 1 else [column for column, _ in headline_columns(summary)]
    with style():
        figures = list(metric_figures(cells, columns))
        drawn = [cell_image(cells, cell) for cell in cells.cells[: max(0, pictures)]]
        climbing = [level_image(cells)]
    images, levels = ([image for image in found if image is not None] for found in (drawn, climbing))
    for image in [*figures, *images, *levels]:
        write_bytes_whole(target / "figures" / f"{image.name}.png", image.png)
        write_bytes_whole(target / "figures" / f"{image.name}.pdf", image.pdf)
    return figures, images, levels


def _print_headline(summary: Summary) -> None:
    """Print the headline table with aligned columns."""
    from arena_metrics.tables import headline

    table = headline(summary)
    rows = [table.head, *table.rows[:PRINTED]]
    widths = [max(len(row[i]) for row in rows) for i in range(len(table.head))]
    for row in rows:
        print("  ".join(text.ljust(width) for text, width in zip(row, widths, strict=True)).rstrip())
    if len(table.rows) > PRINTED:
        print(f"... {len(table.rows) - PRINTED} more")
