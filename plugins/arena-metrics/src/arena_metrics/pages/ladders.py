"""Ladders in a report and on the ladder's own page: curves of all planners under the limit, and breaking densities."""

from __future__ import annotations

from typing import TYPE_CHECKING

from arena_metrics.pages.figures import INK, PALETTE, Image, render_figure
from arena_metrics.pooling.ladders import LIMIT, SUCCESS, LadderCurve, LadderDocument, LadderResult
from arena_metrics.tables.tables import Table

if TYPE_CHECKING:
    from matplotlib.axes import Axes

LADDERS = "ladders"  # the figure's name
CAPTION = (
    "success over density, a panel for each world and crowd: fitted curves, what was driven as points, and the 95 % "
    "intervals of the densities at which success falls to .9 and .5 as bars, each planner's below those before; "
    "bars of many planners would hide the curves, the tables have them"
)
MANY = 7  # ladders, beyond which their intervals are not drawn
STYLES = ("-", "--", ":")  # of the first ladders that share the colours, the next, those after
APART = 0.022  # success by which a planner's intervals lie below those of the one before, so that all are seen
SHARES = ((0.9, "rho90"), (0.5, "rho50"))


def ladder_tables(document: LadderDocument) -> list[Table]:
    """Return a table for each kind of success and share: a row for each cell, in it each planner's breaking density."""
    return [
        _table(document, kind, name, f"{title} falls to {share:g} among so many people per 100 m² [95 % interval]")
        for kind, title in ((SUCCESS, "Success"), ("strict_success", "Strict success"))
        for share, name in SHARES
        if any(kind in cell for ladder in document.ladders for cell in ladder.cells.values())
    ]


def _table(document: LadderDocument, kind: str, name: str, caption: str) -> Table:
    rows = []
    for cell in document.cells:
        curves = [ladder.cells.get(cell, {}).get(kind) for ladder in document.ladders]
        texts = ["–" if curve is None else getattr(curve, name).text for curve in curves]
        rows.append([*cell.split("_", 1), *texts])
    return Table(caption, ["world", "crowd", *(ladder.name for ladder in document.ladders)], rows)


def ladder_image(document: LadderDocument, *, pdf: bool) -> Image | None:
    """Draw the curves of all ladders, a panel for each cell; None where there is no ladder."""
    from matplotlib.figure import Figure

    cells = document.cells
    if not cells:
        return None
    across = 2 if len(cells) == 4 else min(len(cells), 3)
    down = -(-len(cells) // across)
    figure = Figure(figsize=(3.6 * across if across > 1 else 5.2, 2.6 * down + 0.4), layout="constrained")
    panels = figure.subplots(down, across, sharex=True, sharey=True, squeeze=False).ravel()
    for axes, cell in zip(panels, cells, strict=False):
        for place, ladder in enumerate(document.ladders):
            _draw_ladder(axes, ladder, cell, place)
            if SUCCESS in ladder.cells.get(cell, {}) and len(document.ladders) <= MANY:
                _draw_intervals(axes, ladder.cells[cell][SUCCESS], place)
        axes.set_title(cell.replace("_", ", "), loc="left")
        axes.axhline(0.9, color="#bbbbbb", linewidth=0.8, linestyle=":", zorder=0)
        axes.set_ylim(-0.03, 1.03)
    for axes in panels[len(cells) :]:
        axes.set_axis_off()
    for axes in panels[::across]:
        axes.set_ylabel("success [–]")
    for axes in panels[max(0, len(cells) - across) : len(cells)]:
        axes.set_xlabel("people per 100 m²")
        axes.tick_params(labelbottom=True)
    labels = {label: handle for axes in panels for handle, label in zip(*axes.get_legend_handles_labels(), strict=True)}
    figure.legend(labels.values(), labels.keys(), loc="outside lower center", ncols=4)
    return render_figure(figure, LADDERS, CAPTION, pdf=pdf)


def _draw_ladder(axes: Axes, ladder: LadderResult, cell: str, place: int) -> None:
    curves = ladder.cells.get(cell, {})
    if SUCCESS in curves:
        _draw_curve(axes, curves[SUCCESS], ladder.name, place)
    if LIMIT in curves:
        axes.plot(*zip(*curves[LIMIT].curve, strict=True), color=INK, linewidth=1.0, linestyle="--", label=LIMIT)


def _draw_curve(axes: Axes, curve: LadderCurve, name: str, place: int) -> None:
    colour, style = PALETTE[place % len(PALETTE)], STYLES[place // len(PALETTE) % len(STYLES)]
    axes.plot(*zip(*curve.curve, strict=True), color=colour, linewidth=1.4, linestyle=style, label=name)
    for people, won, episodes in curve.driven:
        axes.scatter(people, won, s=1.5 * episodes, color=colour, alpha=0.45, linewidths=0)


def _draw_intervals(axes: Axes, curve: LadderCurve, place: int) -> None:
    colour = PALETTE[place % len(PALETTE)]
    highest = curve.curve[-1][0]
    for share, density in ((0.9 - APART * place, curve.rho90), (0.5 - APART * place, curve.rho50)):
        if density.low < highest and density.value < highest:  # beyond the ladder there is nothing to show
            around = [[density.value - density.low], [density.high - density.value]]
            axes.errorbar(
                density.value, share, xerr=around, color=colour, fmt="o", markersize=3, capsize=2, linewidth=1
            )
