"""The figure of causes: by what each cell's episodes failed, a bar a cell."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import TYPE_CHECKING

from arena_metrics.pages.figures import INK, PALETTE, Image, render_figure
from arena_metrics.pooling.cells import Cells
from arena_metrics.tables.cause_table import FINE, OPEN, causes_of, known_causes

if TYPE_CHECKING:
    from matplotlib.axes import Axes

CAUSES = "causes"  # the figure's name
BARS = 24  # cells that are drawn
HATCHES = ("", "//")  # of causes whose colour comes again
CAPTION = "Why episodes failed: how many of each cell by each cause; the rest were strict successes"


def causes_image(cells: Cells, *, pdf: bool) -> Image | None:
    """Draw how many episodes failed by each cause; None where none was explained, or none failed."""
    from matplotlib.figure import Figure
    from matplotlib.ticker import MaxNLocator

    counted = [(cells.name(cell), counts) for cell in cells.cells if (counts := causes_of(cell)) is not None][:BARS]
    shown = [*known_causes(cells), *[OPEN] * any(counts[OPEN] for _, counts in counted)]
    if not counted or not shown:
        return None
    figure = Figure(figsize=(8.4, 0.9 + 0.34 * len(counted)), layout="constrained")
    axes = figure.subplots()
    _draw_bars(axes, counted, shown)
    axes.set_xlim(0, 1.01 * max(counts.total() for _, counts in counted))
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    axes.set_xlabel("episodes [–]")
    axes.invert_yaxis()
    axes.grid(visible=False, axis="y")
    figure.legend(*axes.get_legend_handles_labels(), loc="outside right upper")
    return render_figure(figure, CAUSES, CAPTION, pdf=pdf)


def _draw_bars(axes: Axes, counted: Sequence[tuple[str, Counter[str]]], shown: Sequence[str]) -> None:
    names, left = [name for name, _ in counted], [0] * len(counted)
    for i, cause in enumerate(shown):
        counts = [of[cause] for _, of in counted]
        colour, hatch = PALETTE[i % len(PALETTE)], HATCHES[i // len(PALETTE) % len(HATCHES)]
        bars = axes.barh(names, counts, left=left, color=colour, hatch=hatch, label=cause, height=0.7)
        axes.bar_label(bars, [str(n) if n else "" for n in counts], label_type="center", color="white", fontsize=7.5)
        left = [before + n for before, n in zip(left, counts, strict=True)]
    rest = [of[FINE] for _, of in counted]
    axes.barh(names, rest, left=left, color="white", edgecolor=INK, linewidth=0.5, label=FINE, height=0.7)
