"""Tables of what single episodes cannot show: how far repeats of one problem scatter, and how
far apart planners drive.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import combinations, islice

import numpy as np

from arena_metrics.pooling.cells import Cell, Cells
from arena_metrics.pooling.drives import Drive, Problem, problem_name
from arena_metrics.pooling.path_similarity import discrete_frechet, mean_frechet, standard_distance
from arena_metrics.tables.tables import Table

PATHS = 12  # most repeats of one problem whose paths are compared in pairs: their number grows with the square
SHARED = 50  # most scenarios on which the paths of two planners are compared


def repeats_table(cells: Cells, drives: Mapping[str, Sequence[Drive]]) -> Table | None:
    """Return one line a cell and problem that was driven twice or more;

    None where none was. ``drives`` are by the cells' hashes.
    """
    rows = [
        [
            cells.name(cell),
            problem_name(repeats),
            str(len(repeats)),
            f"{sum(d.success for d in repeats)} of {len(repeats)}",
            *_scatter_texts(repeats),
        ]
        for cell in cells.cells
        for repeats in by_problem(drives.get(cell.hash, ())).values()
        if len(repeats) > 1
    ]
    head = ["cell", "problem", "repeats", "succeeded", "scatter of ends [m]", "between paths [m]"]
    caption = (
        "Repeats of one problem: standard distance of the end positions, mean discrete Fréchet distance between paths"
    )
    return Table(caption, head, rows) if rows else None


def _scatter_texts(repeats: Sequence[Drive]) -> list[str]:
    ends = np.array([drive.end_xy for drive in repeats])
    return [f"{standard_distance(ends):.3f}", f"{mean_frechet([drive.path_xy for drive in repeats[:PATHS]]):.3f}"]


def by_problem(drives: Sequence[Drive]) -> dict[Problem, list[Drive]]:
    """Group drives by their problem, in order."""
    groups: dict[Problem, list[Drive]] = {}
    for drive in drives:
        groups.setdefault(drive.problem, []).append(drive)
    return groups


def distances_table(cells: Cells, drives: Mapping[str, Sequence[Drive]]) -> Table | None:
    """Return one line a pair of planners under one condition: how far apart their paths on the same
    scenarios are; None without any.
    """
    conditions = any(cells.condition(cell) for cell in cells.cells)  # a single one needs no column
    rows = []
    for first, second in _cell_pairs(cells):
        shared = list(islice(_drive_pairs(drives.get(first.hash, ()), drives.get(second.hash, ())), SHARED))
        if shared:
            names = [cells.condition(first), f"{cells.planner(first)}, {cells.planner(second)}"]
            rows.append(
                [
                    *names[0 if conditions else 1 :],
                    *_distance_texts(shared),
                    *_distance_texts([(a, b) for a, b in shared if a.success and b.success]),
                ]
            )
    head = [
        *["condition"] * conditions,
        "planners",
        "scenarios",
        "mean [m]",
        "greatest [m]",
        "both succeeded",
        "mean [m]",
        "greatest [m]",
    ]
    return (
        Table("Discrete Fréchet distance between two planners' paths on the same scenarios", head, rows)
        if rows
        else None
    )


def _distance_texts(pairs: Sequence[tuple[Drive, Drive]]) -> list[str]:
    """Return how many pairs there are, and the mean and greatest distance between their paths."""
    found = [discrete_frechet(a.path_xy, b.path_xy) for a, b in pairs]
    return [str(len(found)), f"{np.mean(found):.3f}", f"{np.max(found):.3f}"] if found else ["0", "–", "–"]


def _cell_pairs(cells: Cells) -> Iterator[tuple[Cell, Cell]]:
    """Yield the pairs of cells under one condition."""
    return ((a, b) for a, b in combinations(cells.cells, 2) if cells.condition(a) == cells.condition(b))


def _drive_pairs(first: Sequence[Drive], second: Sequence[Drive]) -> Iterator[tuple[Drive, Drive]]:
    """Yield the drives of one scenario and seed."""
    theirs = {(drive.episode.row["seed"], drive.episode.row["scenario"]): drive for drive in second}
    for drive in first:
        rival = theirs.get((drive.episode.row["seed"], drive.episode.row["scenario"]))
        if rival is not None and rival.problem == drive.problem:
            yield drive, rival
