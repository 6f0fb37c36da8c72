"""Tables for readers: the headline and all metrics, as Markdown, LaTeX and CSV."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

from arena_core.commands import one_line
from arena_core.files import csv_text
from arena_core.statistics import Estimate
from arena_metrics.pooling.cells import VARIANT, Cell
from arena_metrics.pooling.problems import problem_count
from arena_metrics.pooling.runs import Column
from arena_metrics.pooling.summary import Over, Summary

HEADLINE: dict[str, Over] = {  # what a reader asks first; lengths and times say little where the goal was not reached
    "success": "all",
    "strict_success": "all",
    "collisions": "all",
    "time_to_goal": "successful",
    "path_length": "successful",
    "planning_time_mean": "all",
    "planning_cpu_mean": "all",
    "people_per_100m2": "all",
}
TEXTS = 5  # different texts of a metric that a cell of a table holds
BLOCK = 6  # cells side by side in a table of all metrics
LATEX = {"\\": r"\textbackslash{}", "–": "--", "−": "$-$", "²": "$^2$", "³": "$^3$", "·": r"$\cdot$"} | {
    c: f"\\{c}" for c in "&%$#_{}"
}
LATEX |= {"~": r"\textasciitilde{}", "^": r"\textasciicircum{}", "<": "$<$", ">": "$>$"}


@dataclass(frozen=True, slots=True)
class Table:
    """A table of texts, all rows as long as the head; ``metrics`` are the columns of metrics by the texts that name
    them in it.
    """

    caption: str
    head: Sequence[str]
    rows: Sequence[Sequence[str]]
    metrics: Mapping[str, str] = field(default_factory=dict)


def unit_text(unit: str) -> str:
    """Return a unit for a reader: percent for proportions, nothing for pure numbers."""
    return {"0/1": "%", "-": "", "": ""}.get(unit, unit.replace("^2", "²").replace("^3", "³"))


def column_title(column: Column, over: Over = "all") -> str:
    """Return a metric's name with its unit."""
    unit = unit_text(column.unit)
    return column.title + (f" [{unit}]" if unit else "") + (", successful" if over == "successful" else "")


def decimal_places(found: Iterable[Estimate]) -> int:
    """Return how many decimals show three digits of the greatest mean, two of one below 1."""
    greatest = max((abs(e.mean) for e in found if math.isfinite(e.mean)), default=0.0)
    if greatest == 0.0:
        return 2
    return min(6, max(0, (2 if greatest >= 1.0 else 1) - math.floor(math.log10(greatest))))


def mean_text(estimate: Estimate, column: Column, places: int) -> str:
    """Return a mean, "–" where there is none."""
    if not math.isfinite(estimate.mean):
        return "–"
    return f"{100.0 * estimate.mean:.0f}" if column.is_proportion else f"{estimate.mean:.{places}f}"


def interval_text(estimate: Estimate, column: Column, places: int) -> str:
    """Return an interval as "low – high", empty where there is none."""
    if not estimate.has_interval:
        return ""
    ends = (estimate.low, estimate.high)
    low, high = (f"{100.0 * x:.0f}" if column.is_proportion else f"{x:.{places}f}" for x in ends)
    return f"{low} – {high}"


def estimate_text(estimate: Estimate, column: Column, places: int) -> str:
    """Return a mean with its interval in brackets."""
    interval = interval_text(estimate, column, places)
    return mean_text(estimate, column, places) + (f" [{interval}]" if interval else "")


def headline_columns(summary: Summary) -> list[tuple[Column, Over]]:
    """Return the metrics of the headline: those chosen, else the usual ones, else the first few there are."""
    by_name = {column.name: column for column in summary.columns}
    wanted: Mapping[str, Over] = dict.fromkeys(summary.headline, "all") or HEADLINE
    known = [(by_name[name], over) for name, over in wanted.items() if name in by_name]
    if summary.headline:
        return [(column, "successful" if column.path_metric else "all") for column, _ in known]
    usual: list[tuple[Column, Over]] = [(column, over if column.path_metric else "all") for column, over in known]
    return usual or [(column, "all") for column in summary.columns[: len(HEADLINE)]]


def headline_table(summary: Summary) -> Table:
    """Return the headline: one row a cell."""
    cells = summary.shown
    factors = [f for f in cells.varying if f != VARIANT] or ["planner"]
    factors += [VARIANT] if VARIANT in cells.varying else []
    columns = headline_columns(summary)
    places = [decimal_places(summary.get(cell, column, over) for cell in cells.cells) for column, over in columns]
    head = [*factors, "n", *(column_title(column, over) for column, over in columns)]
    rows = [
        [*(cell.factors[f] for f in factors), _count_text(cell), *_headline_texts(summary, cell, columns, places)]
        for cell in cells.cells
    ]
    metrics = {column_title(column, over): column.name for column, over in columns}
    return Table("Headline figures: mean [95 % interval]", head, rows, metrics)


def _count_text(cell: Cell) -> str:
    """Return how many episodes a cell has, and on how many problems, where that is another number."""
    episodes, problems = len(cell.episodes), problem_count(cell)
    return str(episodes) if problems == episodes else f"{episodes} on {problems} problem{'s' * (problems > 1)}"


def _headline_texts(
    summary: Summary, cell: Cell, columns: Sequence[tuple[Column, Over]], places: Sequence[int]
) -> list[str]:
    found = [(summary.get(cell, column, over), column, p) for (column, over), p in zip(columns, places, strict=True)]
    return [
        estimate_text(e, column, p) + (f" (n={e.n})" if e.n != len(cell.episodes) else "") for e, column, p in found
    ]


def metric_tables(summary: Summary, over: Over, cells: Sequence[Cell] | None = None) -> list[Table]:
    """Return all metrics, one row each, with at most six cells side by side in one table; other
    packs in tables of their own.
    """
    shown = list(summary.shown.cells if cells is None else cells)
    packs = dict.fromkeys(column.pack for column in [*summary.columns, *summary.texts])
    blocks = [shown[i : i + BLOCK] for i in range(0, len(shown), BLOCK)]
    return [table for pack in packs for block in blocks if (table := _metric_table(summary, over, pack, block)).rows]


def _metric_table(summary: Summary, over: Over, pack: str, cells: Sequence[Cell]) -> Table:
    columns = [c for c in summary.columns if c.pack == pack and (over == "all" or c.path_metric)]
    rows = []
    for column in columns:
        places = decimal_places(summary.get(cell, column, over) for cell in cells)
        found = [summary.get(cell, column, over) for cell in cells]
        rows.append(
            [column.title, unit_text(column.unit), *(f"{estimate_text(e, column, places)} ({e.n})" for e in found)]
        )
    texts = [column for column in summary.texts if column.pack == pack and over == "all"]
    rows += [[column.title, "", *(_frequent_texts(cell.texts(column.name)) for cell in cells)] for column in texts]
    name = f"{pack}: " if pack else ""
    caption = f"{name}mean [95 % interval] (n) over {over} episodes"
    metrics = {column.title: column.name for column in [*columns, *texts]}
    return Table(caption, ["metric", "unit", *(summary.cells.name(cell) for cell in cells)], rows, metrics)


def _frequent_texts(counts: Counter[str]) -> str:
    """Return the texts that most episodes have, each with their number."""
    more = len(counts) - TEXTS
    return ", ".join([f"{text} ({n})" for text, n in counts.most_common(TEXTS)] + [f"{more} more"] * (more > 0)) or "–"


def markdown_tables(tables: Sequence[Table]) -> str:
    """Return tables as Markdown."""
    return "\n".join(_markdown_table(table) for table in tables)


def _markdown_table(table: Table) -> str:
    def line(texts: Iterable[str]) -> str:
        return "| " + " | ".join(one_line(text).replace("|", r"\|") for text in texts) + " |"

    return "\n".join(
        [f"**{table.caption}**", "", line(table.head), line("---" for _ in table.head), *map(line, table.rows), ""]
    )


def latex_tables(tables: Sequence[Table]) -> str:
    """Return tables as LaTeX (needs the package booktabs)."""
    return "\n".join(_latex_table(table) for table in tables)


def _latex_table(table: Table) -> str:
    def line(texts: Iterable[str]) -> str:
        return " & ".join("".join(LATEX.get(c, c) for c in one_line(text)) for text in texts) + r" \\"

    body = [r"\toprule", line(table.head), r"\midrule", *map(line, table.rows), r"\bottomrule"]
    caption = "".join(LATEX.get(c, c) for c in table.caption)
    begin = [
        r"\begin{table}",
        r"\centering",
        rf"\caption{{{caption}}}",
        rf"\begin{{tabular}}{{{'l' * len(table.head)}}}",
    ]
    return "\n".join([*begin, *body, r"\end{tabular}", r"\end{table}", ""])


def csv_tables(tables: Sequence[Table]) -> str:
    """Return tables as CSV, one below the other."""
    return csv_text(row for table in tables for row in (table.head, *table.rows))
