"""The figures of every cell: mean, 95 % interval and n of each metric, over all and over successful episodes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from arena_core.files import csv_text
from arena_core.statistics import Estimate, Kind, estimate
from arena_metrics.pooling.cells import FACTORS, VARIANT, Cell, Cells
from arena_metrics.pooling.problems import problem_keys
from arena_metrics.pooling.runs import Column

Over = Literal["all", "successful"]
HEADER = ["config_hash", "code", "cell", *FACTORS.values(), VARIANT, "metric", "unit", "over"]
HEADER += ["n", "problems", "mean", "low", "high", "interval"]


@dataclass(frozen=True, slots=True, eq=False)
class Summary:
    """All estimates: ``of[cell hash, column, over]``; ``texts`` are the metrics of which there are none, ``headline``
    the columns chosen for the headline, the usual ones where there are none.

    ``certificates`` are cells of what the clairvoyant did in the same problems, which tables show beside the others.
    """

    cells: Cells
    columns: Sequence[Column]
    texts: Sequence[Column]
    of: Mapping[tuple[str, str, Over], Estimate]
    headline: Sequence[str] = ()
    certificates: Sequence[Cell] = ()

    @property
    def shown(self) -> Cells:
        """Return the cells with those of certificates, each at the end of its condition."""
        groups: dict[str, list[Cell]] = {}
        for cell in (*self.cells.cells, *self.certificates):
            groups.setdefault(self.cells.condition(cell), []).append(cell)
        return replace(self.cells, cells=[cell for group in groups.values() for cell in group])

    def get(self, cell: Cell, column: Column, over: Over = "all") -> Estimate:
        """Return one estimate."""
        return self.of[cell.hash, column.name, over]


def summarise_cells(cells: Cells, columns: Sequence[Column], certificates: Sequence[Cell] = ()) -> Summary:
    """Estimate every metric in every cell, also of certificates, unless it is a text."""
    texts = [column for column in columns if column.text]
    columns = [column for column in columns if not column.text]
    of: dict[tuple[str, str, Over], Estimate] = {}
    kinds = {
        column.name: column.kind(value for cell in cells.cells for value in cell.values(column.name))
        for column in columns
    }
    for cell in (*cells.cells, *certificates):
        of.update(_estimate_cell(cell, columns, "all", kinds))
        of.update(_estimate_cell(cell, [column for column in columns if column.path_metric], "successful", kinds))
    return Summary(cells, columns, texts, of, certificates=certificates)


def _estimate_cell(
    cell: Cell, columns: Sequence[Column], over: Over, kinds: Mapping[str, Kind]
) -> dict[tuple[str, str, Over], Estimate]:
    problems = problem_keys(cell)
    found: dict[tuple[str, str, Over], Estimate] = {}
    for column in columns:
        values = np.array(cell.values(column.name))
        if over == "successful":
            values = np.where(success_mask(cell, column.pack), values, np.nan)
        found[cell.hash, column.name, over] = estimate(values, kinds[column.name], problems).within(*column.bounds)
    return found


def success_mask(cell: Cell, pack: str) -> NDArray[np.bool_]:
    """Tell which episodes succeeded, by the pack's own word where it has one, else by that of ``si``."""
    return np.equal(cell.values(success_column(cell, pack)), 1.0)


def success_column(cell: Cell, pack: str) -> str:
    """Return the column that says which episodes succeeded by a pack's own word, else by that of ``si``."""
    own = f"{pack}.success" if pack else "success"
    return own if any(own in episode.row for episode in cell.episodes) else "success"


def summary_csv(summary: Summary) -> str:
    """Return the summary as CSV, one line a cell, metric and choice of episodes;
    empty where a figure is not defined.
    """
    rows: list[Sequence[Any]] = [HEADER]
    by_name = {column.name: column for column in summary.columns}
    cells = {cell.hash: cell for cell in summary.shown.cells}
    for (name, metric, over), one in summary.of.items():
        cell, column = cells[name], by_name[metric]
        figures = [repr(x) if x == x else "" for x in (one.mean, one.low, one.high)]
        factors = [cell.factors[factor] for factor in (*FACTORS.values(), VARIANT)]
        identity = [name.removesuffix(f"-{cell.code or 'unknown'}"), cell.code, summary.cells.name(cell), *factors]
        rows.append([*identity, metric, column.unit, over, one.n, one.problems, *figures, one.method])
    return csv_text(rows)
