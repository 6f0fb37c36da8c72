"""Planners against a baseline on the same scenarios: differences in pairs, which share the luck of the draw."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from arena_metrics.cells import FACTORS, Cell, Cells
from arena_metrics.intervals import Estimate, difference
from arena_metrics.runs import Column, Episode
from arena_metrics.summary import Summary
from arena_metrics.tables import Table, column_title, decimals, headline_columns

PAIRED = ("collisions_caused",)  # beside the headline's metrics


def paired_table(summary: Summary, baseline: str | None = None) -> Table | None:
    """Return one line a cell that has a baseline under its condition: mean difference [95 % interval] (pairs).

    ``baseline`` is a planner's preset, by default the first; None comes back where there is nothing to compare. An asterisk marks
    an interval without 0.
    """
    columns = _columns(summary)
    compared = [(cell, base) for group in conditions(summary.cells) for cell, base in _against(group, baseline)]
    found = [[paired(cell, base, column) for column in columns] for cell, base in compared]
    if not any(estimate.n for row in found for estimate in row):
        return None
    places = [decimals(row[i] for row in found) for i in range(len(columns))]
    names = [[summary.cells.condition(cell), f"{summary.cells.planner(cell)} − {summary.cells.planner(base)}"] for cell, base in compared]
    texts = [[_text(e, column, p) for e, column, p in zip(row, columns, places, strict=True)] for row in found]
    first = 0 if any(condition for condition, _ in names) else 1  # a single condition needs no column
    head = [*["condition", "difference"][first:], *(column_title(column) for column in columns)]
    return Table(
        "Differences on the same scenarios: mean [95 % interval] (pairs in which both are defined), * where the interval excludes 0",
        head,
        [[*name[first:], *row] for name, row in zip(names, texts, strict=True)],
    )


def _columns(summary: Summary) -> list[Column]:
    """Return the headline's metrics and what belongs beside them."""
    first = [column for column, _ in headline_columns(summary)]
    return first + [column for column in summary.columns if column.name in PAIRED and column not in first]


def conditions(cells: Cells) -> Iterator[list[Cell]]:
    """Yield the cells that differ in their planner alone."""
    without = [factor for factor in FACTORS.values() if factor not in ("planner", "timing")]

    groups: dict[tuple[str, ...], list[Cell]] = {}
    for cell in cells.cells:
        groups.setdefault(tuple(cell.factors[factor] for factor in without), []).append(cell)
    yield from groups.values()


def _against(group: Sequence[Cell], baseline: str | None) -> Iterator[tuple[Cell, Cell]]:
    """Yield the other cells of a condition with the baseline's."""
    named = [cell for cell in group if cell.factors["planner"] == baseline]
    base = (named or list(group))[0]
    yield from ((cell, base) for cell in group if cell is not base)


def paired(cell: Cell, base: Cell, column: Column) -> Estimate:
    """Estimate how much more of a metric a cell has than another on the scenarios that both drove."""
    ours, theirs = _by_scenario(cell), _by_scenario(base)
    both = [name for name in ours if name in theirs]
    values, baseline = ([float(of[name].row.get(column.name, float("nan"))) for name in both] for of in (ours, theirs))
    return difference(values, baseline, column.proportion)


def _by_scenario(cell: Cell) -> dict[tuple[int, str], Episode]:
    """Return the episodes that may have a pair; those of a staged task have none, because what a planner meets depends on how it did."""
    episodes = [episode for episode in cell.episodes if episode.row["scenario"] and episode.row["stage"] < 0]
    return {(episode.row["seed"], episode.row["scenario"]): episode for episode in episodes}


def _text(estimate: Estimate, column: Column, places: int) -> str:
    if estimate.n == 0:
        return "–"
    scale, places = (100.0, 0) if column.proportion else (1.0, places)
    mean = f"{scale * estimate.mean:+.{places}f}".replace("-", "−")
    if not estimate.has_interval:
        return f"{mean} ({estimate.n})"
    low, high = (f"{scale * end:+.{places}f}".replace("-", "−") for end in (estimate.low, estimate.high))
    mark = "*" if estimate.low > 0.0 or estimate.high < 0.0 else ""
    return f"{mean} [{low}, {high}]{mark} ({estimate.n})"
