"""The figures of every cell: mean, 95 % interval and n of each metric, over all and over successful episodes."""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from arena_core import Metric, write_text_whole
from arena_metrics.cells import FACTORS, VARIANT, Cell, Cells, cells_of
from arena_metrics.intervals import Estimate, estimates
from arena_metrics.runs import DEFAULT_PACK, Column, Episode, Run, columns_of

Over = Literal["all", "successful"]
HEADER = ["config_hash", "cell", *FACTORS.values(), VARIANT, "metric", "unit", "over", "n", "mean", "low", "high", "interval"]


@dataclass(frozen=True, slots=True, eq=False)
class Summary:
    """All estimates: ``of[cell hash, column, over]``."""

    cells: Cells
    columns: Sequence[Column]
    of: Mapping[tuple[str, str, Over], Estimate]

    def get(self, cell: Cell, column: Column, over: Over = "all") -> Estimate:
        """Return one estimate."""
        return self.of[cell.hash, column.name, over]


def summarise(cells: Cells, columns: Sequence[Column]) -> Summary:
    """Estimate every metric in every cell."""
    of: dict[tuple[str, str, Over], Estimate] = {}
    for cell in cells.cells:
        of.update(_estimated(cell, columns, "all"))
        of.update(_estimated(cell, [column for column in columns if column.path_metric], "successful"))
    return Summary(cells, columns, of)


def _estimated(cell: Cell, columns: Sequence[Column], over: Over) -> dict[tuple[str, str, Over], Estimate]:
    values = [np.array(cell.values(column.name)) for column in columns]
    if over == "successful":
        values = [v[successful(cell, column.pack)] for v, column in zip(values, columns, strict=True)]
    found = estimates(values, [column.proportion for column in columns])
    return {(cell.hash, column.name, over): estimate for column, estimate in zip(columns, found, strict=True)}


def successful(cell: Cell, pack: str) -> NDArray[np.bool_]:
    """Tell which episodes succeeded, by the pack's own word where it has one, else by that of ``si``."""
    own = "success" if pack == DEFAULT_PACK else f"{pack}.success"
    name = own if any(own in episode.row for episode in cell.episodes) else "success"
    return np.equal(cell.values(name), 1.0)


def write_summary(rows: Sequence[Mapping[str, Any]], metrics: Mapping[str, Sequence[Metric]], path: Path) -> None:
    """Write the summary of one run's rows, as ``arena run`` has them, whole or not at all."""
    run = Run(path.parent, rows, {})
    episodes = [Episode({"n_pedestrians": -1, "reaction": "", **row}, run) for row in rows]
    write_text_whole(path, summary_csv(summarise(cells_of(episodes), columns_of(metrics))))


def summary_csv(summary: Summary) -> str:
    """Return the summary as CSV, one line a cell, metric and choice of episodes; empty where a figure is not defined."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(HEADER)
    by_name = {column.name: column for column in summary.columns}
    cells = {cell.hash: cell for cell in summary.cells.cells}
    for (name, metric, over), estimate in summary.of.items():
        cell, column = cells[name], by_name[metric]
        figures = [repr(x) if x == x else "" for x in (estimate.mean, estimate.low, estimate.high)]
        factors = [cell.factors[factor] for factor in (*FACTORS.values(), VARIANT)]
        writer.writerow([name, summary.cells.name(cell), *factors, metric, column.unit, over, estimate.n, *figures, estimate.method])
    return text.getvalue()
