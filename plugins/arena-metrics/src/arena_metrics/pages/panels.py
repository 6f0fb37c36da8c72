"""Which problems a picture shows side by side, and which stretch of the world each shows: the same for all
planners under one condition.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from arena_metrics.pooling.cells import Cells
from arena_metrics.pooling.drives import Drive, Problem, problem_name
from arena_metrics.tables.repeats import by_problem

PANELS = 16  # most in one picture
MARGIN = 1.0  # m around all that happened
FLATTEST, TALLEST = 0.4, 2.5  # height over width of panels
Window = tuple[float, float, float, float]


@dataclass(frozen=True, slots=True)
class Panel:
    """One part of a picture: the problems that it shows, what they are called, and x and y limits, m."""

    problems: frozenset[Problem]
    title: str
    window: Window


@dataclass(frozen=True, slots=True)
class Layout:
    """The panels of the pictures of one condition, and how many problems they leave out."""

    panels: Sequence[Panel]
    left_out: int


def picture_layouts(cells: Cells, drives: Mapping[str, Sequence[Drive]]) -> dict[str, Layout]:
    """Return the layout of every condition in which something was driven; ``drives`` are by the cells' hashes."""
    by_condition: dict[str, list[Sequence[Drive]]] = {}
    for cell in cells.cells:
        if drives.get(cell.hash):
            by_condition.setdefault(cells.condition(cell), []).append(drives[cell.hash])
    return {condition: _condition_layout(rivals) for condition, rivals in by_condition.items()}


def _condition_layout(rivals: Sequence[Sequence[Drive]]) -> Layout:
    """Return a panel a problem where a planner drove one repeatedly, else one for all problems on one map
    among the same obstacles.
    """
    together = by_problem([drive for drives in rivals for drive in drives])
    repeated = any(len(group) > 1 for drives in rivals for group in by_problem(drives).values())
    groups: dict[Problem, list[Drive]] = {}
    for problem, drives in together.items():
        groups.setdefault(problem if repeated else problem.place, []).extend(drives)
    shown = list(groups.values())[:PANELS]
    problems = [frozenset(drive.problem for drive in drives) for drives in shown]
    titles = [
        problem_name(drives) if len(of) == 1 else f"{len(of)} problems"
        for drives, of in zip(shown, problems, strict=True)
    ]
    windows = _equalise_windows([_axis_limits(drives) for drives in shown])
    panels = [Panel(*panel) for panel in zip(problems, titles, windows, strict=True)]
    return Layout(panels, len(together) - sum(map(len, problems)))


def _axis_limits(drives: Sequence[Drive]) -> Window:
    """Return x and y limits that hold all trajectories, starts, goals and obstacles, m."""
    low = np.min([drive.low for drive in drives], axis=0) - MARGIN
    high = np.max([drive.high for drive in drives], axis=0) + MARGIN
    return float(low[0]), float(high[0]), float(low[1]), float(high[1])


def _equalise_windows(windows: Sequence[Window]) -> list[Window]:
    """Widen windows to one height over width, that of their mean, so that panels side by side leave no gaps."""
    sizes = np.array([(right - left, top - bottom) for left, right, bottom, top in windows])
    shape = float(np.clip(np.exp(np.log(sizes[:, 1] / sizes[:, 0]).mean()), FLATTEST, TALLEST))
    widths = np.maximum(sizes[:, 0], sizes[:, 1] / shape)
    middles = [(0.5 * (left + right), 0.5 * (bottom + top)) for left, right, bottom, top in windows]
    return [
        (x - 0.5 * w, x + 0.5 * w, y - 0.5 * shape * w, y + 0.5 * shape * w)
        for (x, y), w in zip(middles, widths.tolist(), strict=True)
    ]
