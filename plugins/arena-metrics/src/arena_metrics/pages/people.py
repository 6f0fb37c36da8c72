"""The figure of what planners cost people: their delay against the time that the robot needs."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from arena_core.statistics import Estimate, FloatArray
from arena_metrics.pages.figures import FAINT, MARKERS, PALETTE, PANELS, PLANNERS, Image, render_figure
from arena_metrics.pooling.cells import Cell
from arena_metrics.pooling.runs import Column
from arena_metrics.pooling.summary import Summary
from arena_metrics.tables.people_table import DELAY, FLOOR

if TYPE_CHECKING:
    from matplotlib.axes import Axes

PEOPLE = "cost_to_people"  # the figure's name
TIME = "time_to_goal"
CAPTION = (
    "Cost to people against time to goal, means with 95 % intervals: nearer to the lower left is better for both. The "
    "line joins the planners that no other one beats in both, but for those that see the truth; below the grey band no "
    "difference is reported"
)


def people_image(summary: Summary, *, pdf: bool) -> Image | None:
    """Draw a panel for each condition, a point a planner; None where times or costs are not known."""
    from matplotlib.figure import Figure

    by_name = {column.name: column for column in summary.columns}
    if TIME not in by_name or DELAY not in by_name:
        return None
    cells = [cell for cell in summary.cells.cells if _is_known(_point(summary, cell, by_name))]
    if not cells:
        return None
    conditions = list(dict.fromkeys(map(summary.cells.condition, cells)))[:PANELS]
    across = min(len(conditions), 3)
    down = -(-len(conditions) // across)
    figure = Figure(figsize=(4.8 * across, 3.2 * down), layout="constrained")
    panels = figure.subplots(down, across, squeeze=False).ravel()
    for axes, condition in zip(panels, conditions, strict=False):
        own = [cell for cell in cells if summary.cells.condition(cell) == condition][:PLANNERS]
        _draw_panel(axes, summary, own, by_name)
        axes.set_title(condition, loc="left")
    for axes in panels[len(conditions) :]:
        axes.set_axis_off()
    return render_figure(figure, PEOPLE, CAPTION, pdf=pdf)


def _point(summary: Summary, cell: Cell, columns: dict[str, Column]) -> tuple[Estimate, Estimate]:
    """Return a cell's time to the goal of successes, s, and its delay of people, s."""
    return summary.get(cell, columns[TIME], "successful"), summary.get(cell, columns[DELAY])


def _is_known(point: tuple[Estimate, Estimate]) -> bool:
    return all(bool(np.isfinite(one.mean)) for one in point)


def pareto_front(points: FloatArray) -> list[int]:
    """Return which of the points (N, 2) no other one is below in both, or below in one and level in the other, by
    rising first figure.
    """
    better = (points[:, None] <= points).all(axis=2) & (points[:, None] < points).any(axis=2)
    best = np.flatnonzero(~better.any(axis=0))
    return sorted(best.tolist(), key=lambda i: (points[i, 0], points[i, 1]))


def _draw_panel(axes: Axes, summary: Summary, cells: Sequence[Cell], columns: dict[str, Column]) -> None:
    found = [_point(summary, cell, columns) for cell in cells]
    competing = [point for cell, point in zip(cells, found, strict=True) if cell.competes]
    means = np.array([[one.mean for one in point] for point in competing]).reshape(-1, 2)
    front = means[pareto_front(means)]
    axes.plot(*front.T, color="#888888", linewidth=1.2, linestyle="--", zorder=1)
    for i, (cell, (time, delay)) in enumerate(zip(cells, found, strict=True)):
        axes.errorbar(
            time.mean,
            delay.mean,
            _bars(delay),
            _bars(time),
            fmt=MARKERS[i % len(MARKERS)],
            color=PALETTE[i % len(PALETTE)],
            markersize=6,
            elinewidth=1.0,
            capsize=2,
            label=summary.cells.planner(cell),
        )
    if FLOOR in columns:
        floor = max(summary.get(cell, columns[FLOOR]).mean for cell in cells)
        if np.isfinite(floor):
            axes.axhspan(-floor, floor, color=FAINT, zorder=0)
    axes.axhline(0.0, color="#888888", linewidth=0.8, zorder=0)
    axes.set_xlabel("time to goal, successful [s]")
    axes.set_ylabel("delay of people [s]")
    axes.legend(fontsize=7.5, loc="upper left", bbox_to_anchor=(1.0, 1.0))


def _bars(one: Estimate) -> list[list[float]] | None:
    return [[one.mean - one.low], [one.high - one.mean]] if one.has_interval else None
