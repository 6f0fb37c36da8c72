"""How far a run is, as its folder says: a table that grows while episodes end."""

from __future__ import annotations

import csv
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from time import time
from typing import Any

from arena_core.files import is_file
from arena_viewer.time_left import RECENT, ActiveRun, RunStart, end_times, episodes_of, read_run_start, time_left

TABLE = "episodes.csv"
SHOWN = (
    "planner",
    "preset",
    "robot",
    "world",
    "scenario",
    "episode",
    "outcome",
    "error",
    "success",
    "time_to_goal",
    "collisions",
)
LAST = 8  # rows that are shown
TAIL = 128_000  # bytes of a table that are read for them, and for when the last episodes ended
PART = 2**20  # bytes


@dataclass(slots=True)
class RunTable:
    """The table of a run: how many rows it has, and when episodes ended, looked at again only
    when the file has changed.
    """

    folder: Path
    stamp: tuple[int, int] = (0, 0)
    rows: int = 0
    tail: list[dict[str, str]] = field(default_factory=list)
    ends: list[float] = field(default_factory=list)
    begun: RunStart = field(default_factory=RunStart)

    def refresh(self) -> None:
        """Count the rows and read the last ones; a table that is not there yet has none."""
        path = self.folder / TABLE
        try:
            if not is_file(path):
                raise FileNotFoundError(path)
            status = path.stat()
            if (stamp := (status.st_mtime_ns, status.st_size)) == self.stamp:
                return
            rows = _last_rows(path, status.st_size)
            self.rows, self.tail, self.begun = (
                _count_rows(path),
                [_known_values(row) for row in rows[-LAST:]],
                read_run_start(self.folder),
            )
            self.ends = end_times(self.folder, episodes_of(rows[-RECENT:]), self.begun.time)
            self.stamp = stamp
        except (OSError, ValueError, csv.Error):  # it is being replaced, or is none
            self.rows, self.tail, self.ends = 0, [], []

    def under_way(self) -> ActiveRun:
        """Return how its run stands; of one that has no table yet nothing is known."""
        return ActiveRun(self.begun.config, max(0, self.begun.episodes - self.rows), self.ends)


@dataclass(slots=True)
class Progress:
    """The tables of an experiment's jobs."""

    folders: Sequence[Path]
    episodes: int
    tables: list[RunTable] = field(default_factory=list)

    def refresh(self) -> dict[str, Any]:
        """Return ``done`` of ``episodes``, and the last rows with their job."""
        self.tables = self.tables or [RunTable(folder) for folder in self.folders]
        for table in self.tables:
            table.refresh()
        last = [{**row, "job": number} for number, table in enumerate(self.tables) for row in table.tail]
        return {"done": sum(table.rows for table in self.tables), "episodes": self.episodes, "last": last[-LAST:]}

    def left(self) -> int | None:
        """Return the seconds that are left, at the last look; None: nothing is known."""
        left = time_left([table.under_way() for table in self.tables], time())
        return None if left is None else round(left)


def _count_rows(path: Path) -> int:
    """Return the number of rows: cells hold no line breaks."""
    with path.open("rb") as file:
        return max(0, sum(part.count(b"\n") for part in iter(lambda: file.read(PART), b"")) - 1)


def _last_rows(path: Path, size: int) -> list[dict[str, str]]:
    with path.open("rb") as file:
        head = file.readline(TAIL).decode(errors="replace")
        file.seek(max(len(head.encode()), size - TAIL))
        text = file.read(TAIL).decode(errors="replace")
    lines = text.splitlines()[1:] if size - TAIL > len(head) else text.splitlines()
    return list(csv.DictReader([head, *lines[-RECENT:]]))


def _known_values(row: Mapping[str, Any]) -> dict[str, str]:
    return {name: str(row[name]) for name in SHOWN if row.get(name)}
