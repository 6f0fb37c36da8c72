"""Pictures of a tuning: its curve, how much each parameter matters, and what values of it were worth."""

from __future__ import annotations

import io
import math
from collections.abc import Mapping, Sequence
from textwrap import fill
from typing import TYPE_CHECKING, Any

from arena_tuning.racing import Entrant
from arena_tuning.study import Search

if TYPE_CHECKING:
    from matplotlib.figure import Figure

COLUMNS = 4  # of parameters in a picture
LABEL = 50  # characters of a line of a label


def draw_curve(curve: Sequence[Sequence[float]]) -> bytes:
    """Draw the best advantage over the present values by the episodes that it took."""
    figure = _make_figure(6.0, 3.5)
    axes = figure.add_subplot()
    axes.step([one[0] for one in curve], [one[1] for one in curve], where="post")
    axes.set(xlabel="episodes of the search", ylabel="objective over that of the present values")
    return _png(figure)


def draw_importance(importance: Mapping[str, float]) -> bytes:
    """Draw which share of the differences each parameter explains."""
    figure = _make_figure(6.0, 0.8 + 0.3 * len(importance))
    axes = figure.add_subplot()
    axes.barh(list(importance), list(importance.values()))
    axes.invert_yaxis()
    axes.set(xlabel="share of the variance (fANOVA)")
    return _png(figure)


def draw_pareto(card: Mapping[str, Any]) -> bytes:
    """Draw what finalists gained on validation by the first two objectives; those that no other one dominates are
    filled, the chosen one has a ring, and the present values are at zero.
    """
    figure = _make_figure(6.0, 4.5)
    axes = figure.add_subplot()
    axes.axhline(0.0, color="0.7", linewidth=0.8)
    axes.axvline(0.0, color="0.7", linewidth=0.8)
    front = card["pareto"]
    for points, filled in ((card["validation"], False), (front, True)):
        x, y = ([one["advantages"][k] for one in points] for k in (0, 1))
        axes.scatter(x, y, s=40, facecolors="tab:blue" if filled else "none", edgecolors="tab:blue", zorder=3)
    chosen = [one["advantages"] for one in front if one["chosen"]]
    axes.scatter([one[0] for one in chosen], [one[1] for one in chosen], s=160, facecolors="none", edgecolors="tab:red")
    first, second = (fill(text, LABEL) for text in card["objectives"][:2])
    axes.set(title="gains over the present values, on validation", xlabel=first, ylabel=second)
    return _png(figure)


def draw_sensitivity(search: Search, space: Mapping[str, Any]) -> bytes:
    """Draw what sets of values were worth against each of their parameters; dark points drove more problems."""
    keys = sorted(space)
    rows = math.ceil(len(keys) / COLUMNS)
    figure = _make_figure(3.0 * COLUMNS, 2.5 * rows)
    known = [(one, one.advantage(search.scores)) for one in search.entrants if not one.failed]
    for place, key in enumerate(keys, 1):
        axes = figure.add_subplot(rows, COLUMNS, place)
        _draw_slice(axes, key, [(one, worth) for one, worth in known if math.isfinite(worth)], search)
        if space[key].log:
            ticks = [float(one) for one in space[key].samples()]
            axes.set_xscale("log")
            axes.minorticks_off()
            axes.set_xticks(ticks, [f"{one:.3g}" for one in ticks])
    return _png(figure)


def _draw_slice(axes: Any, key: str, known: Sequence[tuple[Entrant, float]], search: Search) -> None:
    shade = [len(one.scores) / len(search.problems) for one, _ in known]
    values = [one.values[key] for one, _ in known]
    axes.scatter(values, [worth for _, worth in known], c=shade, cmap="Blues", vmin=-0.3, vmax=1.0, s=10)
    if isinstance(search.present[key], (int, float)):
        axes.axvline(search.present[key], color="tab:red", linewidth=0.8)
    axes.set_title(key, fontsize=8)
    axes.axhline(0.0, color="0.7", linewidth=0.8)


def _make_figure(width: float, height: float) -> Figure:
    from matplotlib.figure import Figure

    return Figure(figsize=(width, height), layout="constrained")


def _png(figure: Figure) -> bytes:
    with io.BytesIO() as file:
        figure.savefig(file, format="png", dpi=110, metadata={"Software": None})
        return file.getvalue()
