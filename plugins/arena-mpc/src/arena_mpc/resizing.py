"""Grid resizing: minimum-time plans gain and lose intervals, so that their length stays near the wanted one."""

from __future__ import annotations

from arena_mpc.parameters import Grid
from arena_mpc.plan import Plan


def resize_grid(plan: Plan, grid: Grid) -> tuple[int, float]:
    """Return number and length (s) of the intervals to divide a plan into, its duration kept (Rösmann et al. 2021,
    section IV).

    The number changes by ``resize_by`` when the length is off by more than the hysteresis, so few problems need be
    compiled.
    """
    stages, change = len(plan.states) - 1, 0
    if plan.step > grid.step * (1.0 + grid.hysteresis):
        change = grid.resize_by
    elif plan.step < grid.step * (1.0 - grid.hysteresis):
        change = -grid.resize_by
    fitting = min(max(stages + change, grid.stages_min), grid.stages_max)
    return fitting, min(max(plan.step * stages / fitting, grid.step_min), grid.step_max)


def reachable_sizes(grid: Grid) -> set[int]:
    """Return every number of intervals that resizing can lead to."""
    sizes, fresh = set[int](), {grid.stages}
    while fresh:
        sizes |= fresh
        changed = {size + change for size in fresh for change in (-grid.resize_by, grid.resize_by)}
        fresh = {min(max(size, grid.stages_min), grid.stages_max) for size in changed} - sizes
    return sizes
