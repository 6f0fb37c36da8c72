"""The figure of what was possible: how long planners took, between the lower bound and the time that was certified."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from arena_core.statistics import estimate
from arena_metrics.pages.figures import INK, PALETTE, PANELS, PLANNERS, Image, render_figure
from arena_metrics.pooling.cells import Cell, Cells
from arena_metrics.pooling.problems import problem_keys
from arena_metrics.pooling.runs import Row

if TYPE_CHECKING:
    from matplotlib.axes import Axes

POSSIBLE = "possible"  # the figure's name
LOWER, CERTIFIED, REGRET = "reference.time_lower", "reference.time_certified", "reference.time_regret"
CAPTION = (
    "Time to the goal of strict successes, with 95 % intervals, beside what was possible in the same problems: the "
    "lower bound (nobody who touches nothing is sooner) and the time of a certificate that was driven"
)


def possible_image(cells: Cells, *, pdf: bool) -> Image | None:
    """Draw a panel for each condition; None where no problem has a certificate."""
    from matplotlib.figure import Figure

    certified = [cell for cell in cells.cells if len(_times(cell, CERTIFIED))]
    if not certified:
        return None
    conditions = list(dict.fromkeys(map(cells.condition, certified)))[:PANELS]
    across = min(len(conditions), 3)
    down = -(-len(conditions) // across)
    most = max(sum(cells.condition(cell) == condition for cell in certified) for condition in conditions)
    figure = Figure(figsize=(max(2.8, 0.7 * min(most, PLANNERS) + 1.4) * across, 2.7 * down), layout="constrained")
    panels = figure.subplots(down, across, squeeze=False).ravel()
    for axes, condition in zip(panels, conditions, strict=False):
        own = [cell for cell in certified if cells.condition(cell) == condition][:PLANNERS]
        _draw_panel(axes, own, [cells.planner(cell) for cell in own])
        axes.set_title(condition, loc="left")
    for axes in panels[len(conditions) :]:
        axes.set_axis_off()
    for axes in panels[::across]:
        axes.set_ylabel("time to goal [s]")
    return render_figure(figure, POSSIBLE, CAPTION, pdf=pdf)


def _times(cell: Cell, column: str) -> NDArray[np.float64]:
    """Return the finite values of a column of findings."""
    values = np.array([float(episode.row.get(column) or "nan") for episode in cell.episodes])
    return np.asarray(values[np.isfinite(values)])


def _draw_panel(axes: Axes, cells: Sequence[Cell], names: Sequence[str]) -> None:
    for i, cell in enumerate(cells):
        taken = np.array([_taken(episode.row) for episode in cell.episodes])
        known = np.isfinite(taken)
        if not known.any():
            continue
        keys = [key for key, there in zip(problem_keys(cell), known, strict=True) if there]
        found = estimate(taken[known], "figure", keys).within(0.0, math.inf)
        low, high = (found.low, found.high) if found.has_interval else (found.mean, found.mean)
        colour = PALETTE[i % len(PALETTE)]
        axes.errorbar(i, found.mean, [[found.mean - low], [high - found.mean]], fmt="o", color=colour, capsize=3)
    floor, best = (
        float(np.mean(np.concatenate([_times(cell, name) for cell in cells]))) for name in (LOWER, CERTIFIED)
    )
    axes.axhline(best, color=INK, linewidth=1.0, label="certified")
    axes.axhspan(0.0, floor, color="#d9d9d9", zorder=0, label="impossible")
    axes.set_ylim(0.0, None)
    axes.set_xticks(range(len(names)), names, rotation=30 if len(names) > 4 else 0)
    axes.legend(loc="lower right", fontsize=7.5)


def _taken(row: Row) -> float:
    """Return the time of a strict success, s, NaN of anything else."""
    values = [float(row.get(name) or "nan") for name in (REGRET, CERTIFIED)]
    return sum(values)
