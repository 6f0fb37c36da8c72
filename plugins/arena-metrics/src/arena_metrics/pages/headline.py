"""What the first screen shows: sentences that answer, and the headline table with its bars and interval strips."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import groupby

import numpy as np

from arena_core.statistics import Estimate, after_holm, estimate
from arena_metrics.pages.levels import StagedRun, staged_runs
from arena_metrics.pooling.cells import Cell, Cells
from arena_metrics.pooling.problems import problem_count, problem_keys
from arena_metrics.pooling.runs import Column, Row
from arena_metrics.pooling.summary import Over, Summary
from arena_metrics.tables.comparison_sentences import comparison_sentences
from arena_metrics.tables.pairs import compare_pairs, metric_pairs
from arena_metrics.tables.tables import decimal_places, headline_columns, interval_text, mean_text, unit_text

OUTCOMES = {  # how an episode ended, in words, with the colour of its bar
    "clean": ("success, no collision", "#0072B2"),
    "success": ("success, one collision", "#7FB8DA"),
    "reached": ("goal reached, too many collisions", "#E69F00"),
    "collision": ("stopped at a collision", "#D55E00"),
    "false_arrival": ("false arrival", "#B07AA1"),
    "time_out": ("time-out", "#A6A6A6"),
    "error": ("error", "#222222"),
}
LINES = 60  # rows of the headline table before the rest is folded away
SPOKEN = 6  # planners that the answering sentence names


@dataclass(frozen=True, slots=True)
class HeadlineValue:
    """One figure of the headline table: texts, and positions on the column's scale in percent
    (None where there is none).
    """

    mean: str
    interval: str
    n: int
    at: float | None
    low: float | None
    high: float | None
    best: bool


@dataclass(frozen=True, slots=True)
class OutcomeSegment:
    """One part of an outcome bar."""

    label: str
    colour: str
    share: float
    count: int


@dataclass(frozen=True, slots=True)
class HeadlineRow:
    """One cell's row of the headline table; ``factor_values`` are its values of the factors that differ."""

    name: str
    facts: Mapping[str, str]
    n: int
    problems: int
    outcomes: Sequence[OutcomeSegment]
    figures: Sequence[HeadlineValue]


@dataclass(frozen=True, slots=True)
class ConditionGroup:
    """The rows of one condition."""

    condition: str
    lines: Sequence[HeadlineRow]


@dataclass(frozen=True, slots=True)
class HeadlineColumn:
    """A column of the headline table; ``name`` is the metric's."""

    name: str
    title: str
    unit: str
    over: Over
    description: str


@dataclass(frozen=True, slots=True)
class ColumnScale:
    """How figures of a metric are written and drawn: decimals, and the upper end of its strips, which begin at zero."""

    column: Column
    over: Over
    places: int
    end: float


@dataclass(frozen=True, slots=True)
class Headline:
    """The headline table: its columns, the groups of rows shown and folded away, and the outcomes in it with their
    colours.
    """

    headings: Sequence[HeadlineColumn]
    groups: Sequence[ConditionGroup]
    folded: Sequence[ConditionGroup]
    outcomes: Sequence[tuple[str, str]]


def outcome_text(row: Row) -> str:
    """Return how an episode ended, with its success where that is known."""
    if row.get("success") == 1.0:
        return "clean" if row.get("collisions") == 0.0 else "success"
    ended = str(row["outcome"])
    return ended if ended in OUTCOMES else "reached"


def factor_values(cells: Cells, cell: Cell) -> dict[str, str]:
    """Return a cell's values of the factors by which the page's rows can be chosen."""
    return {factor: cell.factors[factor] for factor in cells.varying if cell.factors[factor]}


def outcome_segments(cell: Cell) -> list[OutcomeSegment]:
    """Return the parts of a cell's outcome bar."""
    ended = [outcome_text(episode.row) for episode in cell.episodes]
    counts = {kind: ended.count(kind) for kind in OUTCOMES}
    return [OutcomeSegment(*OUTCOMES[kind], 100.0 * n / len(ended), n) for kind, n in counts.items() if n]


def make_headline(summary: Summary) -> Headline:
    """Return the headline table: cells grouped by condition, planners side by side."""
    columns = headline_columns(summary)
    headings = [HeadlineColumn(c.name, c.title, unit_text(c.unit), over, c.description) for c, over in columns]
    scales = [_column_scale(summary, column, over) for column, over in columns]
    groups = [
        ConditionGroup(condition, _group_rows(summary, list(members), scales))
        for condition, members in groupby(summary.shown.cells, key=summary.cells.condition)
    ]
    found = {outcome_text(episode.row) for cell in summary.shown.cells for episode in cell.episodes}
    return Headline(headings, *_split_groups(groups), [label for kind, label in OUTCOMES.items() if kind in found])


def _column_scale(summary: Summary, column: Column, over: Over) -> ColumnScale:
    found = [summary.get(cell, column, over) for cell in summary.shown.cells]
    greatest = max((x for e in found for x in (e.mean, e.high) if math.isfinite(x)), default=0.0) or 1.0
    return ColumnScale(column, over, decimal_places(found), 1.0 if column.is_proportion else greatest)


def _group_rows(summary: Summary, cells: Sequence[Cell], scales: Sequence[ColumnScale]) -> list[HeadlineRow]:
    """Return the rows of the cells of one condition."""
    found = [[summary.get(cell, scale.column, scale.over) for scale in scales] for cell in cells]
    best = [_best_cell(of, cells, scale.column) for of, scale in zip(zip(*found, strict=True), scales, strict=True)]
    return [
        HeadlineRow(
            summary.cells.planner(cell),
            factor_values(summary.cells, cell),
            len(cell.episodes),
            problem_count(cell),
            outcome_segments(cell),
            [_headline_value(e, scale, best=one is cell) for e, scale, one in zip(of, scales, best, strict=True)],
        )
        for cell, of in zip(cells, found, strict=True)
    ]


def _split_groups(all_groups: Sequence[ConditionGroup]) -> tuple[list[ConditionGroup], list[ConditionGroup]]:
    """Split the headline table where it grows too long, inside a group if need be."""
    shown: list[ConditionGroup] = []
    folded: list[ConditionGroup] = []
    room = LINES
    for group in all_groups:
        if group.lines[:room]:
            shown.append(ConditionGroup(group.condition, group.lines[:room]))
        if group.lines[room:]:
            folded.append(ConditionGroup(group.condition, group.lines[room:]))
        room = max(0, room - len(group.lines))
    return shown, folded


def _best_cell(found: Sequence[Estimate], cells: Sequence[Cell], column: Column) -> Cell | None:
    """Return the cell that pairs of the same scenarios show to be better than every other one of its group, p after
    Holm; None where there is none.

    Means alone do not say it: of a planner that fails the hard half they speak of the easy one. Figures that are
    defined in less than half of a cell's episodes do not compete, nor do those of planners that see the truth.
    """
    met = zip(found, cells, strict=True)
    known = [(e, cell) for e, cell in met if cell.competes and e.n and 2 * e.n >= len(cell.episodes)]
    if len(known) < 2 or column.better == "neither":
        return None
    sign = 1.0 if column.better == "higher" else -1.0
    best = max(known, key=lambda one: sign * one[0].mean)[1]
    rivals = [cell for _, cell in known if cell is not best]
    duels = after_holm([compare_pairs(metric_pairs(best, rival, column), column) for rival in rivals])
    return best if all(one.told_apart and sign * one.difference.mean > 0.0 for one in duels) else None


def _headline_value(found: Estimate, scale: ColumnScale, *, best: bool) -> HeadlineValue:
    low, high = (found.low, found.high) if found.has_interval else (math.nan, math.nan)
    at, low_at, high_at = (_to_percent(x / scale.end) for x in (found.mean, low, high))
    mean = mean_text(found, scale.column, scale.places)
    interval = interval_text(found, scale.column, scale.places)
    return HeadlineValue(mean, interval, found.n, at, low_at, high_at, best)


def _to_percent(share: float) -> float | None:
    return round(100.0 * min(1.0, max(0.0, share)), 2) if math.isfinite(share) else None


def summary_sentences(summary: Summary, baseline: str | None = None) -> list[str]:
    """Return the sentences that say what came out: of staged runs their levels, because all of
    them succeed about equally often.
    """
    named = {column.name: column for column in summary.columns}
    success = named.get("success")
    if success is None:
        return []
    climbed = list(staged_runs(summary.cells))
    fixed = [cell for cell in summary.cells.competing.cells if all(climb.cell is not cell for climb in climbed)]
    standing = replace(summary, cells=replace(summary.cells, cells=fixed))
    return (
        _success_sentences(standing)
        + comparison_sentences(standing.cells, success, named.get("time_to_goal"), baseline, SPOKEN)
        + _level_sentences(summary.cells, climbed)
    )


def _level_sentences(cells: Cells, climbed: Sequence[StagedRun]) -> list[str]:
    ends = [(cells.name(c.cell), c.episodes[-1].row["stage"], max(e.row["stage"] for e in c.episodes)) for c in climbed]
    texts = [f"{name} ended on level {last} (highest {highest})" for name, last, highest in ends]
    more = f"; {len(texts) - SPOKEN} more below" if len(texts) > SPOKEN else ""
    return [f"{'; '.join(texts[:SPOKEN])}{more}."] if texts else []


def _success_sentences(summary: Summary) -> list[str]:
    cells = summary.cells
    if not cells.cells:
        return []
    planners = list(dict.fromkeys(cells.planner(cell) for cell in cells.cells))
    if len(cells.cells) == 1:
        return [_single_sentence(summary, cells.cells[0])]
    if len(planners) == 1:
        return [_spread_sentence(summary, planners[0])]
    return [_ranking_sentence(cells, planners), *_crowd_sentences(cells, planners)]


def _single_sentence(summary: Summary, cell: Cell) -> str:
    found, strict = _pooled_success([cell]), sum(v == 1.0 for v in cell.values("strict_success"))
    succeeded = round(found.mean * found.n) if found.n else 0
    if not found.n:
        return f"{summary.cells.planner(cell)}: no episode could be judged."
    range_text = f" (95 % interval {100 * found.low:.0f} to {100 * found.high:.0f} %)" if found.has_interval else ""
    sentence = (
        f"{summary.cells.planner(cell)} succeeded in {succeeded} of {found.n} episode{'s' * (found.n > 1)}{range_text}"
    )
    return sentence + (f", {strict or 'none'} of them without any collision." if succeeded else ".")


def _spread_sentence(summary: Summary, planner: str) -> str:
    means = [(_pooled_success([cell]).mean, summary.cells.condition(cell)) for cell in summary.cells.cells]
    known = sorted(pair for pair in means if math.isfinite(pair[0]))
    if not known:
        return f"{planner}: no episode could be judged."
    (worst, where_worst), (best, where_best) = known[0], known[-1]
    if worst == best:
        return f"{planner} succeeded in {100 * best:.0f} % of the episodes in every cell."
    return (
        f"{planner} succeeded in {100 * worst:.0f} % ({where_worst}) to "
        f"{100 * best:.0f} % ({where_best}) of the episodes."
    )


def _ranking_sentence(cells: Cells, planners: Sequence[str]) -> str:
    """Compare planners over all conditions, or say that they did not face the same ones."""
    conditions = {p: {cells.condition(c) for c in cells.cells if cells.planner(c) == p} for p in planners}
    shared = set.intersection(*conditions.values())
    if not shared:
        return "The planners shown did not face the same conditions; compare within a condition only."
    pooled = {
        p: _pooled_success(c for c in cells.cells if cells.planner(c) == p and cells.condition(c) in shared)
        for p in planners
    }
    ranked = sorted((item for item in pooled.items() if item[1].n), key=lambda item: -item[1].mean)
    texts = [
        f"{p} {100 * e.mean:.0f} %" + (f" ({100 * e.low:.0f} to {100 * e.high:.0f})" if e.has_interval else "")
        for p, e in ranked
    ]
    where = "" if len(shared) == 1 else f" over the {len(shared)} conditions that all planners faced"
    more = f"; {len(texts) - SPOKEN} more below" if len(texts) > SPOKEN else ""
    return f"Success{where}: {', '.join(texts[:SPOKEN])}{more}."


def _crowd_sentences(cells: Cells, planners: Sequence[str]) -> list[str]:
    """Return what more people do to each planner, the one that bears most of them first.

    Nothing where conditions differ otherwise, where the number of people differs by episode, or where a planner did
    not face the fewest and the most.
    """
    counts = {cell.factors["people"] for cell in cells.cells}
    if set(cells.varying) - {"planner"} != {"people"} or not all(count.isdigit() for count in counts):
        return []
    few, many = min(counts, key=int), max(counts, key=int)
    found = {(cells.planner(cell), cell.factors["people"]): _pooled_success([cell]) for cell in cells.cells}
    ends = {p: (found[p, few], found[p, many]) for p in planners if (p, few) in found and (p, many) in found}
    if len(ends) < len(planners) or not all(least.n and most.n for least, most in ends.values()):
        return []
    ranked = sorted(ends.items(), key=lambda item: -item[1][1].mean)
    texts = [f"from {100 * least.mean:.0f} to {100 * most.mean:.0f} % ({p})" for p, (least, most) in ranked[:SPOKEN]]
    return [f"Among {many} people instead of {few}, success goes {', '.join(texts)}."]


def _pooled_success(cells: Iterable[Cell]) -> Estimate:
    """Estimate the share of successes over cells, by problem and within worlds."""
    pooled = list(cells)
    worlds = [str(episode.row["world"]) for cell in pooled for episode in cell.episodes]
    problems = [label for cell in pooled for label in problem_keys(cell)]
    return estimate(np.concatenate([cell.values("success") for cell in pooled]), True, problems, worlds)
