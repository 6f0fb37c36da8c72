"""Staged runs: which level each episode had, and how each block of episodes went."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import TYPE_CHECKING

from arena_metrics.pages.figures import PALETTE, Image, render_figure
from arena_metrics.pooling.cells import Cell, Cells
from arena_metrics.pooling.runs import Episode
from arena_metrics.tables.tables import Table

if TYPE_CHECKING:
    from matplotlib.axes import Axes

PANELS = 12  # runs in one figure
SUCCEEDED, FAILED = PALETTE[0], PALETTE[1]


@dataclass(frozen=True, slots=True, eq=False)
class StagedRun:
    """The episodes of one cell and seed, in order."""

    cell: Cell
    seed: int
    episodes: Sequence[Episode]

    def blocks(self) -> list[list[Episode]]:
        """Return the episodes between two possible changes of level; where their number is not
        known, those between two changes.
        """
        length = self.cell.config.get("task", {}).get("block")
        if isinstance(length, int) and length > 0:
            grouped = groupby(self.episodes, lambda episode: episode.row["episode"] // length)
        else:
            grouped = groupby(self.episodes, lambda episode: episode.row["stage"])
        return [list(block) for _, block in grouped]


def staged_runs(cells: Cells) -> Iterator[StagedRun]:
    """Yield every staged run, a cell's by seed."""
    for cell in cells.cells:
        for seed, episodes in groupby(cell.episodes, lambda episode: int(episode.row["seed"])):
            staged = [episode for episode in episodes if episode.row["stage"] >= 0]
            if staged:
                yield StagedRun(cell, seed, staged)


def level_table(cells: Cells) -> Table | None:
    """Return one line a block: its level, episodes and successes; None where no run is staged."""
    rows = []
    for climb in staged_runs(cells):
        for block in climb.blocks():
            first, last = block[0].row["episode"], block[-1].row["episode"]
            share = f"{sum(map(_is_success, block))} of {len(block)}"
            rows.append(
                [cells.name(climb.cell), str(climb.seed), f"{first} – {last}", str(block[0].row["stage"]), share]
            )
    return (
        Table("Levels of staged runs, block by block", ["cell", "seed", "episodes", "level", "succeeded"], rows)
        if rows
        else None
    )


def level_image(cells: Cells, *, pdf: bool) -> Image | None:
    """Draw the level of every staged run over its episodes; None where no run is staged."""
    from matplotlib.figure import Figure

    shown = list(staged_runs(cells))[:PANELS]
    if not shown:
        return None
    across = min(len(shown), 3)
    down = -(-len(shown) // across)
    figure = Figure(figsize=(3.6 * across if across > 1 else 5.2, 2.4 * down + 0.3), layout="constrained")
    panels = figure.subplots(down, across, sharex=True, sharey=True, squeeze=False).ravel()
    for axes, climb in zip(panels, shown, strict=False):
        _draw_levels(axes, climb)
        axes.set_title(f"{cells.name(climb.cell)}, seed {climb.seed}", loc="left")
    for axes in panels[len(shown) :]:
        axes.set_axis_off()
    for axes in panels[::across]:
        axes.set_ylabel("level [–]")
    for axes in panels[max(0, len(shown) - across) : len(shown)]:
        axes.set_xlabel("episode [–]")
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside lower center", ncols=3)
    return render_figure(
        figure, "levels", "level of each episode of the staged runs; at every block its share of successes", pdf=pdf
    )


def _draw_levels(axes: Axes, climb: StagedRun) -> None:
    """Draw the levels as steps, successes on them and failures below, and every block's share of successes above it."""
    from matplotlib.ticker import MaxNLocator

    numbers, levels = ([int(episode.row[key]) for episode in climb.episodes] for key in ("episode", "stage"))
    success = [_is_success(episode) for episode in climb.episodes]
    axes.step(numbers, levels, where="mid", color="#888888", linewidth=1.0, label="level")
    for outcome, colour, offset, label in ((True, SUCCEEDED, 0.0, "succeeded"), (False, FAILED, -0.18, "failed")):
        at = [(n, level + offset) for n, level, s in zip(numbers, levels, success, strict=True) if s is outcome]
        axes.scatter(
            [n for n, _ in at], [level for _, level in at], s=7, color=colour, linewidths=0, label=label, zorder=3
        )
    for block in climb.blocks():
        middle = 0.5 * (block[0].row["episode"] + block[-1].row["episode"])
        share = 100.0 * sum(map(_is_success, block)) / len(block)
        axes.annotate(
            f"{share:.0f} %",
            (middle, block[0].row["stage"]),
            (0, 4),
            textcoords="offset points",
            ha="center",
            fontsize=6.5,
        )
    axes.margins(y=0.15)
    axes.yaxis.set_major_locator(MaxNLocator(integer=True))
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))


def _is_success(episode: Episode) -> bool:
    """Return whether an episode succeeded; where the metric was not computed, whether it reached its goal."""
    return bool(episode.row.get("success", episode.row["outcome"] == "goal_reached") == 1.0)
