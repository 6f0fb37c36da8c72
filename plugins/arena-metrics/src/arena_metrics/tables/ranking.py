"""Who is best over all conditions: means, interquartile means, and ranks that say where
episodes cannot tell planners apart.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from arena_core.statistics import Estimate, FloatArray, after_holm, estimate, interquartile_mean
from arena_metrics.pooling.cells import Cell, Cells
from arena_metrics.pooling.problems import problem_keys
from arena_metrics.pooling.runs import Column
from arena_metrics.pooling.summary import Summary
from arena_metrics.tables.pairs import Pair, compare_pairs, condition_groups, condition_key, metric_pairs
from arena_metrics.tables.tables import Table, column_title, decimal_places, estimate_text

RANKED = ("success", "strict_success", "collisions", "time_to_goal")
MIDDLE = ("spl", "collisions")  # of which the interquartile mean says more than the mean
MOST_PLANNERS = 12  # which are 66 comparisons a metric


@dataclass(frozen=True, slots=True, eq=False)
class CommonConditions:
    """The conditions that all planners faced: of each planner its cells, in the order of the conditions; likewise of
    each reference, a planner that sees the truth and has no rank.
    """

    cells: Cells
    planners: Mapping[str, Sequence[Cell]]
    references: Mapping[str, Sequence[Cell]]

    @property
    def all(self) -> Mapping[str, Sequence[Cell]]:
        """Return the cells of planners and references."""
        return {**self.planners, **self.references}

    @property
    def conditions(self) -> int:
        """Return how many conditions there are."""
        return len(next(iter(self.planners.values())))


def common_conditions(cells: Cells) -> CommonConditions | None:
    """Return what all planners faced; None where there are not two of them that compete, more than
    ``MOST_PLANNERS``, or no such condition.
    """
    names = list(dict.fromkeys(cells.planner(cell) for cell in cells.cells if cell.competes))
    groups = [{cells.planner(cell): cell for cell in group} for group in condition_groups(cells)]
    faced = [group for group in groups if len(group) == len(names)]
    if not 2 <= len(names) <= MOST_PLANNERS or not faced:
        return None
    planners = {name: [group[name] for group in faced] for name in names}
    return CommonConditions(cells, planners, dict(_references(cells, planners[names[0]])))


def _references(cells: Cells, faced: Sequence[Cell]) -> Iterator[tuple[str, list[Cell]]]:
    """Yield the references that stand in every condition of some cells, and theirs."""
    of: dict[str, dict[tuple[str, ...], Cell]] = {}
    for cell in cells.cells:
        if not cell.competes:
            of.setdefault(cells.planner(cell), {})[condition_key(cell)] = cell
    wanted = [condition_key(cell) for cell in faced]
    yield from ((name, [own[key] for key in wanted]) for name, own in of.items() if all(key in own for key in wanted))


def planner_ranks(found: CommonConditions, column: Column) -> dict[str, tuple[int, int]]:
    """Return the best and the worst rank that each planner may have: p of all pairs after Holm leaves out what chance
    may explain.

    Empty where the planners drove no common scenarios.
    """
    duels = {names: _shared_pairs(found, *names, column) for names in combinations(found.planners, 2)}
    if not all(duels.values()):
        return {}
    lost = dict.fromkeys(found.planners, 0)
    won = dict.fromkeys(found.planners, 0)
    for (ours, theirs), one in zip(
        duels, after_holm([compare_pairs(met, column) for met in duels.values()]), strict=True
    ):
        if one.told_apart:
            better = (one.difference.mean > 0.0) == (column.better == "higher")
            winner, loser = (ours, theirs) if better else (theirs, ours)
            won[winner] += 1
            lost[loser] += 1
    return {name: (1 + lost[name], len(found.planners) - won[name]) for name in found.planners}


def ranking_table(summary: Summary) -> Table | None:
    """Return a line for each planner over the conditions that all faced, best success first, then one for each
    reference; None where nothing is to be ranked.
    """
    found = common_conditions(summary.shown)
    by_name = {column.name: column for column in summary.columns}
    ranked = [by_name[name] for name in RANKED if name in by_name]
    if found is None or not ranked:
        return None
    middle = [by_name[name] for name in MIDDLE if name in by_name]
    head = ["planner", "n"] + [text for column in ranked for text in (column_title(column), "rank")]
    head += [f"{column_title(column)}, interquartile mean" for column in middle]
    columns = [list(_rank_column(found, column)) for column in ranked] + [
        list(_middle_column(found, column)) for column in middle
    ]
    lines = [
        [name, str(sum(len(cell.episodes) for cell in cells)), *(text for column in columns for text in column[i])]
        for i, (name, cells) in enumerate(found.all.items())
    ]
    order = sorted(range(len(lines)), key=lambda i: (i >= len(found.planners), _sort_key(found, ranked[0], i)))
    said = (
        f"the {found.conditions} conditions that all planners faced"
        if found.conditions > 1
        else "the condition that all planners faced"
    )
    titles = {column_title(column): column.name for column in ranked}
    titles |= {f"{column_title(column)}, interquartile mean": column.name for column in middle}
    return Table(f"Ranking over {said}", head, [lines[i] for i in order], titles)


def _sort_key(found: CommonConditions, column: Column, place: int) -> float:
    mean = _pooled_estimate(list(found.all.values())[place], column).mean
    return math.inf if math.isnan(mean) else -mean if column.better == "higher" else mean


def _shared_pairs(found: CommonConditions, ours: str, theirs: str, column: Column) -> list[Pair]:
    cells = zip(found.planners[ours], found.planners[theirs], strict=True)
    return [pair for cell, other in cells for pair in metric_pairs(cell, other, column)]


def _rank_column(found: CommonConditions, column: Column) -> Iterator[tuple[str, str]]:
    """Yield each planner's mean and rank, "–" where it has none."""
    means = [_pooled_estimate(cells, column) for cells in found.all.values()]
    places, known = decimal_places(means), planner_ranks(found, column)
    for name, mean in zip(found.all, means, strict=True):
        best, worst = known.get(name, (0, 0))
        rank = "–" if name not in known else str(best) if best == worst else f"{best}–{worst}"
        yield estimate_text(mean, column, places), rank


def _middle_column(found: CommonConditions, column: Column) -> Iterator[tuple[str]]:
    means = [interquartile_mean([_by_problem(cell, column) for cell in cells]) for cells in found.all.values()]
    places = decimal_places(means)
    for mean in means:
        yield (estimate_text(mean, column, places),)


def _by_problem(cell: Cell, column: Column) -> FloatArray:
    """Return the mean of each problem's episodes, (P,)."""
    values: dict[object, list[float]] = {}
    for label, value in zip(problem_keys(cell), cell.values(column.name), strict=True):
        values.setdefault(label, []).append(value)
    return np.array([np.mean(of) for of in values.values()])


def _pooled_estimate(cells: Sequence[Cell], column: Column) -> Estimate:
    """Estimate a mean over cells, by problem and within conditions."""
    values = np.concatenate([cell.values(column.name) for cell in cells])
    problems = [(i, label) for i, cell in enumerate(cells) for label in problem_keys(cell)]
    return estimate(values, column.kind(values), problems, [i for i, _ in problems]).within(*column.bounds)
