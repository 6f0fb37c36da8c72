"""What the run cost: CPU time of whole episodes, planner by planner, and the planner's own share of it."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np

from arena_metrics.pooling.cells import Cell, Cells
from arena_metrics.tables.tables import Table

EPISODE_CPU, EPISODE_WALL, STEP_CPU = "planning_episode_cpu", "planning_episode_time", "planning_cpu_mean"  # s, s, ms
HEAD = (
    "planner",
    "n",
    "CPU time an episode [s]",
    "of it 90 % below [s]",
    "wall time an episode [s]",
    "planner a control step [ms]",
    "CPU time in all",
)
TOTAL = "all"


def cost_table(cells: Cells) -> Table | None:
    """Return a line for each planner, the costliest first, and one for all; None where no
    episode was timed as a whole.
    """
    names = dict.fromkeys(cells.planner(cell) for cell in cells.cells)
    by_planner = {name: [cell for cell in cells.cells if cells.planner(cell) == name] for name in names}
    known = {name: members for name, members in by_planner.items() if len(_timed_values(members, EPISODE_CPU))}
    if not known:
        return None
    ordered = sorted(known.items(), key=lambda item: -_timed_values(item[1], EPISODE_CPU).sum())
    rows = [_cost_row(name, members) for name, members in ordered]
    if len(rows) > 1:
        rows.append(_cost_row(TOTAL, [cell for members in known.values() for cell in members]))
    return Table(
        "What it cost: time of whole episodes, from the scenario to the record, on the machines that drove them",
        HEAD,
        rows,
    )


def _cost_row(name: str, members: Iterable[Cell]) -> list[str]:
    members = list(members)
    cpu, wall, step = (_timed_values(members, column) for column in (EPISODE_CPU, EPISODE_WALL, STEP_CPU))
    figures = (f"{cpu.mean():.2f}", f"{np.percentile(cpu, 90):.2f}", f"{wall.mean():.2f}")
    return [
        name,
        str(len(cpu)),
        *figures,
        f"{step.mean():.2f}" if len(step) else "–",
        format_duration(float(cpu.sum())),
    ]


def _timed_values(members: Iterable[Cell], column: str) -> np.ndarray:
    """Return a column's values where there are any, (n,)."""
    values = [value for cell in members for value in cell.values(column)]
    return np.array([value for value in values if math.isfinite(value)])


def format_duration(seconds: float) -> str:
    """Return a time as a reader says it: 42 s, 12 min, 3.4 h."""
    if seconds < 120.0:
        return f"{seconds:.0f} s"
    return f"{seconds / 60.0:.0f} min" if seconds < 7200.0 else f"{seconds / 3600.0:.1f} h"
