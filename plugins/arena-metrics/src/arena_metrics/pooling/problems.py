"""Which problem an episode was: repeats of one are no new problems."""

from __future__ import annotations

from collections.abc import Hashable

from arena_metrics.pooling.cells import Cell
from arena_metrics.pooling.runs import Row

FIXED = ("scenario", "barn", "dynabarn")  # tasks whose problems are those of files, the same for every seed


def problem_key(row: Row) -> Hashable:
    """Return what tells an episode's problem from others: its name in its file, else seed and scenario;
    without one, the episode.
    """
    if not row["scenario"]:
        return (row["seed"], row["episode"])
    name = file_problem(row)
    return (row.get("scenario_hash", ""), name) if name else (row["seed"], row["scenario"])


def file_problem(row: Row) -> str:
    """Return the name of the file's problem that was run; empty where problems are drawn."""
    name = str(row["scenario"]).rpartition("/")[0]
    # the task barn in a world that is drawn
    drawn = row["task"] not in FIXED or (row["task"] != "scenario" and "/" not in name)
    return "" if drawn else name


def problem_keys(cell: Cell) -> list[Hashable]:
    """Return the problem of every episode of a cell."""
    return [problem_key(episode.row) for episode in cell.episodes]


def problem_count(cell: Cell) -> int:
    """Return how many problems a cell's episodes were."""
    return len(set(problem_keys(cell)))
