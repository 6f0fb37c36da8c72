"""Figures: each metric over the number of people, one line a planner."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from io import BytesIO
from typing import TYPE_CHECKING, Any

import numpy as np

from arena_core.statistics import estimate
from arena_metrics.pooling.cells import Cells
from arena_metrics.pooling.problems import problem_keys
from arena_metrics.pooling.runs import Column
from arena_metrics.pooling.summary import success_mask
from arena_metrics.tables.tables import unit_text

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

# Okabe and Ito's palette (colour-blind safe), without the yellow that no white page shows
PALETTE = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#555555"]
MARKERS = ["o", "s", "D", "^", "v", "P", "X"]
INK, FAINT = "#222222", "#d9d9d9"
DPI, SHOWN_DPI = 192, 100  # of the PNG, and at which a page shows it
SPREAD, SPREAD_ALL = 0.13, 0.8  # most between the marks of two planners, and of all, in steps of the axis of people
PANELS = 9  # conditions side by side in one figure
PLANNERS = len(PALETTE) * 2


STYLE: dict[Any, Any] = {
    "font.family": "sans-serif",
    "font.sans-serif": ["DejaVu Sans"],
    "font.size": 9,
    "axes.labelsize": 9,
    "xtick.labelsize": 8.5,
    "ytick.labelsize": 8.5,
    "legend.fontsize": 8.5,
    "axes.edgecolor": "#888888",
    "axes.labelcolor": INK,
    "axes.titlesize": 9,
    "axes.titleweight": "normal",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "grid.color": "#ececec",
    "text.color": INK,
    "xtick.color": "#444444",
    "ytick.color": "#444444",
    "legend.frameon": False,
    "pdf.fonttype": 42,  # TrueType: publishers reject Type 3
    "svg.hashsalt": "arena",
}


@dataclass(frozen=True, slots=True)
class Image:
    """A drawn figure, as PDF too where that was asked for; ``width`` is how wide a page shows it, CSS pixels."""

    name: str
    png: bytes
    pdf: bytes | None
    caption: str
    width: int


@contextmanager
def report_style() -> Iterator[None]:
    """Draw in the report's style, whatever the user's settings are."""
    import matplotlib as mpl
    import seaborn as sns

    with mpl.rc_context(), sns.axes_style("whitegrid"), sns.plotting_context("notebook"):
        mpl.rcParams.update(STYLE)
        yield


def render_figure(figure: Figure, name: str, caption: str, *, pdf: bool) -> Image:
    """Return a figure as PNG, with ``pdf`` as PDF too, the same bytes for the same figure."""
    figure.draw_without_rendering()
    figure.set_layout_engine("none")  # the layout is settled: solve it once, not for each format
    png, print_ = BytesIO(), BytesIO()
    figure.savefig(png, format="png", dpi=DPI, metadata={"Software": None})
    if pdf:
        figure.savefig(print_, format="pdf", metadata={"CreationDate": None, "Producer": None})
    pixels = int.from_bytes(png.getvalue()[16:20], "big")  # the width stands there in every PNG
    return Image(name, png.getvalue(), print_.getvalue() if pdf else None, caption, round(pixels * SHOWN_DPI / DPI))


def metric_figures(cells: Cells, columns: Sequence[Column], *, pdf: bool) -> Iterator[Image]:
    """Draw every metric that is defined in some episode; those of the path over successful
    episodes, where there are any.
    """
    for column in columns:
        data = _metric_frame(cells, column)
        if column.path_metric and data["success"].any():
            yield _metric_figure(
                cells, column, data[data["success"]], f"{column.description} (successful episodes)", pdf=pdf
            )
        elif len(data):
            yield _metric_figure(cells, column, data, column.description, pdf=pdf)


def _metric_frame(cells: Cells, column: Column) -> pd.DataFrame:
    """Return one row for each episode in which the metric is defined: its planner, condition, number of
    people, success and value.
    """
    import pandas as pd

    parts = [
        pd.DataFrame(
            {
                "planner": cells.planner(cell),
                "condition": cells.condition(cell, without=["people"]),
                "people": [max(episode.row["n_pedestrians"], 0) for episode in cell.episodes],
                "success": success_mask(cell, column.pack),
                "problem": problem_keys(cell),
                "value": np.array(cell.values(column.name)) * (100.0 if column.is_proportion else 1.0),
            }
        )
        for cell in cells.cells
    ]
    return pd.concat(parts, ignore_index=True).dropna(subset=["value"])


def _metric_figure(cells: Cells, column: Column, data: pd.DataFrame, caption: str, *, pdf: bool) -> Image:
    from matplotlib.figure import Figure

    conditions = list(dict.fromkeys(cells.condition(cell, without=["people"]) for cell in cells.cells))[:PANELS]
    planners = sorted(dict.fromkeys(cells.planner(cell) for cell in cells.cells))[:PLANNERS]
    across = min(len(conditions), 3)
    down = -(-len(conditions) // across)
    over_people = data["people"].nunique() > 1
    figure = Figure(
        figsize=(_panel_width(planners, over_people=over_people) * across, 2.7 * down), layout="constrained"
    )
    shared = _is_comparable(data)
    panels = figure.subplots(down, across, sharey=shared, squeeze=False).ravel()
    for axes, condition in zip(panels, conditions, strict=False):
        part = data[(data["condition"] == condition) & data["planner"].isin(planners)]
        _draw_panel(axes, part, column, planners, over_people=over_people)
        axes.set_title(condition, loc="left")
    # only now: a limit set earlier would hold for panels yet to come
    for axes in panels[: 1 if shared else len(conditions)]:
        _limit_axis(axes, column, data)
    for axes in panels[len(conditions) :]:
        axes.set_axis_off()
    for axes in panels[::across]:
        axes.set_ylabel(axis_label(column))
    if over_people:
        _draw_legend(figure, planners)
    return render_figure(figure, column.name, caption, pdf=pdf)


def _is_comparable(data: pd.DataFrame) -> bool:
    """Return whether one scale suits the panels of all conditions."""
    means = data.groupby("condition")["value"].mean().abs()
    return bool(means.max() <= 4.0 * means.min())


def _limit_axis(axes: Axes, column: Column, data: pd.DataFrame) -> None:
    if column.is_proportion:
        axes.set_ylim(-4, 104)
    elif data["value"].min() >= 0.0:
        axes.set_ylim(0.0, 1.04 * axes.get_ylim()[1])


def _panel_width(planners: Sequence[str], *, over_people: bool) -> float:
    return 3.4 if over_people else max(2.6, 0.7 * len(planners) + 1.2)


def axis_label(column: Column) -> str:
    """Return an axis label with its unit."""
    unit = unit_text(column.unit)
    return f"{column.title} [{unit or '–'}]"


def _draw_panel(axes: Axes, data: pd.DataFrame, column: Column, planners: Sequence[str], *, over_people: bool) -> None:
    """Draw the episodes as faint points, and their means with 95 % intervals."""
    import seaborn as sns

    order = sorted(data["people"].unique()) if over_people else list(planners)
    gap = min(SPREAD, SPREAD_ALL / len(planners)) if over_people else 0.0
    spread = gap * (len(planners) - 1)
    for i, planner in enumerate([] if column.is_proportion else planners):
        own = data[data["planner"] == planner]
        at = [order.index(people) - spread / 2 + gap * i for people in own["people"]] if over_people else [i] * len(own)
        axes.plot(
            at, own["value"], "o", color=_planner_colour(i), markersize=3, alpha=0.25, markeredgewidth=0, zorder=1
        )
    sns.pointplot(
        data=data,
        x="people" if over_people else "planner",
        y="value",
        order=order,
        hue="planner",
        hue_order=list(planners),
        palette={planner: _planner_colour(i) for i, planner in enumerate(planners)},
        markers=[_planner_marker(i) for i in range(len(planners))],
        dodge=spread or False,
        errorbar=_interval_function(column, data),
        err_kws={"linewidth": 1.6},
        linestyle="-" if over_people else "none",
        linewidth=1.2,
        markersize=5.5,
        legend=False,
        ax=axes,
    )
    axes.set_xlabel("people [–]" if over_people else "")
    axes.set_ylabel("")
    if not over_people and (len(planners) > 4 or max(map(len, planners)) > 12):
        axes.tick_params(axis="x", rotation=30)


def _interval_function(column: Column, data: pd.DataFrame) -> Any:
    """Return the function by which seaborn gets our intervals for the values of rows of ``data``."""
    scale = 100.0 if column.is_proportion else 1.0
    kind = column.kind(data["value"])

    def interval(values: pd.Series[float]) -> tuple[float, float]:
        found = estimate(np.asarray(values, dtype=float) / scale, kind, list(data.loc[values.index, "problem"]))
        found = found.within(*column.bounds)
        return (
            (found.low * scale, found.high * scale) if found.has_interval else (found.mean * scale, found.mean * scale)
        )

    return interval


def _planner_colour(planner: int) -> str:
    return PALETTE[planner % len(PALETTE)]


def _planner_marker(planner: int) -> str:
    """Return a planner's mark; a colour that comes again comes with another mark."""
    return MARKERS[(planner + planner // len(PALETTE)) % len(MARKERS)]


def _draw_legend(figure: Figure, planners: Sequence[str]) -> None:
    """Put the legend outside, beside the panels."""
    from matplotlib.lines import Line2D

    handles = [
        Line2D(
            [], [], color=_planner_colour(i), marker=_planner_marker(i), markersize=5.5, linewidth=1.2, label=planner
        )
        for i, planner in enumerate(planners)
    ]
    figure.legend(handles=handles, loc="outside right upper", title="planner", title_fontsize=8.5, alignment="left")
