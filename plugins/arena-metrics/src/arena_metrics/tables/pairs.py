"""Planners against a baseline on the same scenarios: differences in pairs, which share the luck of the draw."""

from __future__ import annotations

import math
from collections.abc import Hashable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

from arena_core.statistics import Comparison, after_holm, compare
from arena_metrics.pooling.cells import FACTORS, Cell, Cells
from arena_metrics.pooling.problems import problem_key
from arena_metrics.pooling.runs import Column, Episode
from arena_metrics.pooling.summary import Summary, success_column
from arena_metrics.tables.tables import Table, column_title, decimal_places, headline_columns

PAIRED = ("collisions_caused", "jerk")  # beside the headline's metrics
HEAD = ["mean [95 % interval]", "p", "p after Holm", "effect", "higher / lower", "pairs", "problems"]


@dataclass(frozen=True, slots=True)
class Pair:
    """A metric of two planners on the same scenario, and whose problem in which world it is."""

    ours: float
    theirs: float
    problem: Hashable
    world: str


def paired_tables(summary: Summary, baseline: str | None = None) -> list[Table]:
    """Return a table for each metric, with one line a cell that has a baseline under its condition; none where nothing
    can be compared.

    ``baseline`` is a planner's preset, by default the first. The lines of a table are one family of comparisons: an
    asterisk marks what chance does not explain (p after Holm of 0.05 or less).
    """
    couples = [
        (cell, base) for group in condition_groups(summary.cells) for cell, base in baseline_pairs(group, baseline)
    ]
    tables = [_paired_table(summary.cells, couples, column) for column in _paired_columns(summary)]
    return [table for table in tables if table.rows]


def comparison_rows(cells: Cells, columns: Sequence[Column], baseline: str | None = None) -> Iterator[dict[str, Any]]:
    """Yield what each comparison found, one after the other: those of one metric are one family.

    Beside the numbers stand the words that the report has for them: ``title``, ``shown``, ``p_shown``,
    ``p_holm_shown``, ``over_shown``.
    """
    couples = [(cell, base) for group in condition_groups(cells) for cell, base in baseline_pairs(group, baseline)]
    for column in columns:
        found = after_holm([compare_pairs(metric_pairs(cell, base, column), column) for cell, base in couples])
        places = decimal_places(one.difference for one in found)
        for (cell, base), one in zip(couples, found, strict=True):
            difference, texts = one.difference, _comparison_texts(one, column, places)
            yield {
                **{"planner": cells.planner(cell), "baseline": cells.planner(base), "condition": cells.condition(cell)},
                **{
                    "metric": column.name,
                    "unit": column.unit,
                    "over": "both succeeded" if column.path_metric else "all",
                },
                **{
                    "difference": difference.mean,
                    "low": difference.low,
                    "high": difference.high,
                    "p": one.p,
                    "p_holm": one.holm,
                },
                **{
                    "effect": one.effect,
                    "higher": one.higher,
                    "lower": one.lower,
                    "pairs": difference.n,
                    "problems": difference.problems,
                },
                **{"title": column_title(column), "shown": texts[0], "p_shown": texts[1], "p_holm_shown": texts[2]},
                **{"over_shown": _pairs_text(column)},
            }


def _paired_table(cells: Cells, couples: Sequence[tuple[Cell, Cell]], column: Column) -> Table:
    found = after_holm([compare_pairs(metric_pairs(cell, base, column), column) for cell, base in couples])
    places = decimal_places(one.difference for one in found)
    several = any(cells.condition(cell) for cell, _ in couples)  # a single condition needs no column
    rows = [
        [
            *([cells.condition(cell)] if several else []),
            f"{cells.planner(cell)} − {cells.planner(base)}",
            *_comparison_texts(one, column, places),
        ]
        for (cell, base), one in zip(couples, found, strict=True)
        if one.difference.n
    ]
    caption = f"{column_title(column)}, pairs of {_pairs_text(column)}"
    head = [*(["condition"] if several else []), "difference", *HEAD]
    return Table(caption, head, rows, {caption: column.name})


def _pairs_text(column: Column) -> str:
    return "episodes in which both succeeded" if column.path_metric else "all episodes"


def _paired_columns(summary: Summary) -> list[Column]:
    """Return the headline's metrics and what belongs beside them, but for what is no merit."""
    first = [column for column, _ in headline_columns(summary)]
    shown = first + [column for column in summary.columns if column.name in PAIRED and column not in first]
    return [column for column in shown if column.better != "neither"]


def condition_groups(cells: Cells) -> Iterator[list[Cell]]:
    """Yield the cells that compete and differ in their planner alone."""
    groups: dict[tuple[str, ...], list[Cell]] = {}
    for cell in cells.cells:
        if cell.competes:
            groups.setdefault(condition_key(cell), []).append(cell)
    yield from groups.values()


def condition_key(cell: Cell) -> tuple[str, ...]:
    """Return what a cell shares with those that differ from it in their planner alone."""
    return tuple(cell.factors[factor] for factor in FACTORS.values() if factor not in ("planner", "timing"))


def baseline_pairs(group: Sequence[Cell], baseline: str | None) -> Iterator[tuple[Cell, Cell]]:
    """Yield the other cells of a condition with the baseline's."""
    named = [cell for cell in group if cell.factors["planner"] == baseline]
    base = (named or list(group))[0]
    yield from ((cell, base) for cell in group if cell is not base)


def metric_pairs(cell: Cell, base: Cell, column: Column) -> list[Pair]:
    """Return a metric of both on the scenarios that both drove; one of the path only where both succeeded."""
    ours, theirs = _by_scenario(cell), _by_scenario(base)
    both = [name for name in ours if name in theirs]
    if column.path_metric:
        both = [
            name
            for name in both
            if all(_is_success(of[name], cells, column) for of, cells in ((ours, cell), (theirs, base)))
        ]
    return [
        Pair(
            _metric_value(ours[name], column),
            _metric_value(theirs[name], column),
            problem_key(ours[name].row),
            str(ours[name].row["world"]),
        )
        for name in both
    ]


def compare_pairs(found: Sequence[Pair], column: Column) -> Comparison:
    """Compare over pairs, repeats of a problem being one problem and worlds strata."""
    ours, theirs = [pair.ours for pair in found], [pair.theirs for pair in found]
    one = compare(
        ours, theirs, column.kind([*ours, *theirs]), [pair.problem for pair in found], [pair.world for pair in found]
    )
    return replace(one, difference=one.difference.within(*column.difference_bounds))


def _is_success(episode: Episode, cell: Cell, column: Column) -> bool:
    return float(episode.row.get(success_column(cell, column.pack), math.nan)) == 1.0


def _metric_value(episode: Episode, column: Column) -> float:
    return float(episode.row.get(column.name, math.nan))


def _by_scenario(cell: Cell) -> dict[tuple[int, str, str], Episode]:
    """Return the episodes that may have a pair; those of a staged task have none, because what a planner meets depends
    on how it did.

    Problems of other files or in other walls are no pair, whatever they are called.
    """
    episodes = [episode for episode in cell.episodes if episode.row["scenario"] and episode.row["stage"] < 0]
    return {(e.row["seed"], e.row["scenario"], e.row.get("scenario_hash", "")): e for e in episodes}


def _comparison_texts(one: Comparison, column: Column, places: int) -> list[str]:
    found, scale = one.difference, 100.0 if column.is_proportion else 1.0
    mean, low, high = (
        _signed_text(scale * x, 0 if column.is_proportion else places) for x in (found.mean, found.low, found.high)
    )
    interval = f" [{low}, {high}]{'*' if one.told_apart else ''}" if found.has_interval else ""
    effect = _signed_text(one.effect, 2) if math.isfinite(one.effect) else "–"
    return [
        mean + interval,
        p_text(one.p),
        p_text(one.holm),
        effect,
        f"{one.higher} / {one.lower}",
        str(found.n),
        str(found.problems),
    ]


def _signed_text(number: float, places: int) -> str:
    return f"{number:+.{places}f}".replace("-", "−") if math.isfinite(number) else "–"


def p_text(p: float) -> str:
    """Return p with two digits that count, as psychologists write it."""
    if not math.isfinite(p):
        return "–"
    if p < 0.001:
        return "< .001"
    return f"{p:.{2 if p >= 0.0995 else 3}f}".lstrip("0") if p < 0.995 else "1"
