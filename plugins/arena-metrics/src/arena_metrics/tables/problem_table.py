"""The problems of a file, one by one: how each went over its repeats."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from arena_core.statistics import Estimate, estimate
from arena_metrics.pooling.cells import Cell, Cells
from arena_metrics.pooling.problems import file_problem
from arena_metrics.pooling.runs import Column, Episode
from arena_metrics.tables.tables import Table, column_title, decimal_places, estimate_text

# metrics of a problem; True: of its successes
SHOWN = {"success": False, "collisions": False, "time_to_goal": True, "path_length": True}


def problem_table(cells: Cells, columns: Sequence[Column]) -> Table | None:
    """Return one line a cell and problem of a file, over its repeats; None where no problem was repeated."""
    shown = [column for column in columns if column.name in SHOWN]
    found = [(cell, name, part) for cell in cells.cells for name, part in _by_problem(cell).items()]
    if not shown or all(len(part.episodes) < 2 for _, _, part in found):
        return None
    figures = [[_over_repeats(part, column) for column in shown] for _, _, part in found]
    places = [decimal_places(row[i] for row in figures) for i in range(len(shown))]
    rows = []
    for (cell, name, part), row in zip(found, figures, strict=True):
        texts = [
            estimate_text(e, c, p) + (f" (n={e.n})" if SHOWN[c.name] else "")
            for e, c, p in zip(row, shown, places, strict=True)
        ]
        rows.append([cells.name(cell), name, str(len(part.episodes)), *texts])
    head = [column_title(column, "successful" if SHOWN[column.name] else "all") for column in shown]
    caption = "Problem by problem: mean over its repeats [95 % interval, of this problem alone]"
    titles = {text: column.name for text, column in zip(head, shown, strict=True)}
    return Table(caption, ["cell", "problem", "repeats", *head], rows, titles)


def _by_problem(cell: Cell) -> dict[str, Cell]:
    """Return a cell's episodes by problem, those of files alone."""
    groups: dict[str, list[Episode]] = {}
    for episode in cell.episodes:
        groups.setdefault(file_problem(episode.row), []).append(episode)
    return {name: replace(cell, episodes=groups[name]) for name in sorted(groups) if name}


def _over_repeats(part: Cell, column: Column) -> Estimate:
    values = part.values(column.name)
    if SHOWN[column.name]:
        values = [value for value, success in zip(values, part.values("success"), strict=True) if success == 1.0]
    return estimate(values, column.kind(values)).within(*column.bounds)
