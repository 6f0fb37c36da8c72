"""Performance profiles: how often each planner is within a factor of the quickest, and how
often it has at most so many collisions.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from arena_core.statistics import FloatArray
from arena_metrics.pages.figures import PALETTE, Image, render_figure
from arena_metrics.pooling.cells import Cell
from arena_metrics.tables.ranking import CommonConditions, common_conditions

if TYPE_CHECKING:
    from arena_metrics.pooling.summary import Summary

PROFILES = "profiles"  # the figure's name
SLOWEST = 3.0  # the factor where the axis ends
MOST_COLLISIONS = 5  # where the other ends
LINES = ("-", "--", ":")  # a colour that comes again comes with another line


def profile_image(summary: Summary, *, pdf: bool) -> Image | None:
    """Draw the profiles of planners over the conditions that all faced; None where there is nothing to compare or the
    metrics are missing.

    Left after Dolan and More (2002): a planner that fails is no factor at all, so its line ends below 1.
    """
    from matplotlib.figure import Figure

    found = common_conditions(summary.cells)
    if found is None or not {"success", "collisions", "time_to_goal"} <= {column.name for column in summary.columns}:
        return None
    figure = Figure(figsize=(8.4, 3.0), layout="constrained")
    left, right = figure.subplots(1, 2, sharey=True)
    factors = np.linspace(1.0, SLOWEST, 201)
    collisions = np.arange(MOST_COLLISIONS + 1.0)
    for i, (name, ratios) in enumerate(slowdown_ratios(found).items()):
        line = _line_style(name, i)
        left.plot(factors, _share_below(ratios, factors), **line)
        hits = _all_values(found.planners[name], "collisions")
        right.plot(collisions, _share_below(hits, collisions), **line, marker="o")
    left.set_xlabel("time to goal over that of the quickest [–]")
    left.set_ylabel("share of episodes [%]")
    right.set_xlabel("collisions, at most [–]")
    left.set_ylim(0.0, 102.0)
    figure.legend(
        *left.get_legend_handles_labels(),
        loc="outside right upper",
        title="planner",
        title_fontsize=8.5,
        alignment="left",
    )
    caption = (
        f"Performance profiles over {found.conditions} condition{'s' * (found.conditions > 1)} that all planners "
        "faced: higher is better"
    )
    return render_figure(figure, PROFILES, caption, pdf=pdf)


def slowdown_ratios(found: CommonConditions) -> dict[str, FloatArray]:
    """Return by planner, of each scenario that all drove and one solved, its time over that of the
    quickest; inf where it failed.
    """
    times: dict[str, list[FloatArray]] = {name: [] for name in found.planners}
    for group in zip(*found.planners.values(), strict=True):
        by_scenario = [dict(_goal_times(cell)) for cell in group]
        common = [key for key in by_scenario[0] if all(key in of for of in by_scenario)]
        for name, of in zip(times, by_scenario, strict=True):
            times[name].append(np.array([of[key] for key in common]))
    return _time_ratios({name: np.concatenate(parts) for name, parts in times.items()})


def _time_ratios(times: Mapping[str, FloatArray]) -> dict[str, FloatArray]:
    least = np.min(list(times.values()), axis=0)
    solved = np.isfinite(least)
    return {name: of[solved] / least[solved] for name, of in times.items()}


def _goal_times(cell: Cell) -> Iterator[tuple[tuple[int, str], float]]:
    """Yield each scenario of a cell with the time to its goal, s; inf where that was not reached with success."""
    for episode in cell.episodes:
        row = episode.row
        reached = row.get("success") == 1.0
        yield (row["seed"], row["scenario"]), float(row["time_to_goal"]) if reached else np.inf


def _all_values(cells: Sequence[Cell], column: str) -> FloatArray:
    return np.concatenate([cell.values(column) for cell in cells])


def _share_below(values: FloatArray, limits: FloatArray) -> FloatArray:
    """Return the share of values that are at most each limit, %."""
    known = values[~np.isnan(values)]
    shares: FloatArray = 100.0 * np.searchsorted(np.sort(known), limits + 1e-9, side="right") / max(len(known), 1)
    return shares


def _line_style(name: str, planner: int) -> dict[str, Any]:
    """Return how the line of a planner looks."""
    colour, line = PALETTE[planner % len(PALETTE)], LINES[planner // len(PALETTE) % len(LINES)]
    return {"label": name, "color": colour, "linestyle": line, "linewidth": 1.6, "markersize": 4}
