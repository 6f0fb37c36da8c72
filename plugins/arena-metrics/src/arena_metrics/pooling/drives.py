"""Episodes as their records tell them: which problem was driven, along which path;
without what only a picture needs.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from arena_core import EpisodeRecord
from arena_core.records import read_record
from arena_core.scenes import furniture_of, furniture_shapes
from arena_metrics.packs.motion import resample_by_length
from arena_metrics.pooling.cells import Cell, Cells
from arena_metrics.pooling.runs import Episode

FloatArray = NDArray[np.float64]
STEP = 0.1  # m of arc length between the points of a path that is compared with others


@dataclass(frozen=True, slots=True)
class Problem:
    """What makes two episodes the same problem, apart from people: the map (its name says what is in it),
    start, goal and obstacles.
    """

    grid: str
    start: tuple[float, ...]
    goal: tuple[float, ...]
    obstacles: str

    @staticmethod
    def of(record: EpisodeRecord) -> Problem:
        """Return the problem of a record; its obstacles as JSON text."""
        scenario = record.meta["scenario"]
        doors = [
            {"vertices_xy": door["vertices_xy"], "radius": 0.0, "door": True} for door in scenario.get("doors", [])
        ]
        return Problem(
            str(record.meta["world"].get("grid", "worlds")),
            tuple(scenario["start"]),
            tuple(scenario["goal"]),
            json.dumps([*scenario.get("obstacles", []), *furniture_shapes(furniture_of(scenario)), *doors]),
        )

    @property
    def place(self) -> Problem:
        """Return the same map and obstacles for any start and goal."""
        return Problem(self.grid, (), (), self.obstacles)


@dataclass(frozen=True, slots=True, eq=False)
class Drive:
    """One episode: its number as pictures and tables show it, its problem, whether it succeeded, and its path.

    ``path_xy`` (K, 2) has a point every 0.1 m, ``end_xy`` is where the robot was at the end; ``low`` and ``high`` are
    the corners of all that happened, m.
    """

    episode: Episode
    label: str
    problem: Problem
    success: bool
    path_xy: FloatArray
    end_xy: FloatArray
    low: FloatArray
    high: FloatArray


def drives_of(cells: Cells, cell: Cell) -> list[Drive]:
    """Read the drives of a cell, in the order of its episodes; those without a record are left out."""
    return [
        _make_drive(read_record(episode.record_path), episode, label)
        for episode, label in number_episodes(cells, cell)
        if episode.record_path.exists()
    ]


def number_episodes(cells: Cells, cell: Cell) -> Iterator[tuple[Episode, str]]:
    """Yield every episode of a cell with its number, the seed ahead of it where the cells have several."""
    several = len({episode.row["seed"] for shown in cells.cells for episode in shown.episodes}) > 1
    for episode in cell.episodes:
        yield episode, f"{episode.row['seed']}:{episode.row['episode']}" if several else str(episode.row["episode"])


def _make_drive(record: EpisodeRecord, episode: Episode, label: str) -> Drive:
    positions = record["pose"][:, :2]
    problem = Problem.of(record)
    points = np.vstack((positions, problem.start[:2], problem.goal[:2], *_obstacle_corners(problem)))
    path = resample_by_length(positions, STEP)
    return Drive(
        episode,
        label,
        problem,
        episode.row.get("success") == 1.0,
        path,
        positions[-1].copy(),
        points.min(axis=0),
        points.max(axis=0),
    )


def _obstacle_corners(problem: Problem) -> Iterator[FloatArray]:
    """Yield the corners of the obstacles' outlines."""
    for obstacle in json.loads(problem.obstacles):
        vertices = np.asarray(obstacle["vertices_xy"], dtype=float)
        yield vertices - obstacle["radius"]
        yield vertices + obstacle["radius"]


def problem_name(drives: Sequence[Drive]) -> str:
    """Return what a problem is called: the name that its episodes share, without the number of a repetition."""
    names = dict.fromkeys(str(drive.episode.row["scenario"]) for drive in drives)
    stems = dict.fromkeys(name.rpartition("/")[0] or name for name in names)
    return next(iter(names if len(names) == 1 else stems), "")
