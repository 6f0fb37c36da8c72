"""How far a run is, as its folder says: a table that grows while episodes end."""

from __future__ import annotations

import csv
from collections import deque
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from time import monotonic
from typing import Any

from arena_core.files import is_file

TABLE = "episodes.csv"
SHOWN = ("planner", "preset", "robot", "world", "scenario", "episode", "outcome", "error", "success", "time_to_goal", "collisions")
LAST = 8  # rows that are shown
TAIL = 32_000  # bytes of a table that are read for them
WINDOW = 120.0  # s over which the rate is taken
PART = 2**20  # bytes


@dataclass(slots=True)
class Table:
    """A table on disk: how many rows it has, counted anew only when the file has changed."""

    path: Path
    stamp: tuple[int, int] = (0, 0)
    rows: int = 0
    tail: list[dict[str, str]] = field(default_factory=list)

    def look(self) -> None:
        """Count the rows and read the last ones; a table that is not there yet has none."""
        try:
            if not is_file(self.path):
                raise FileNotFoundError(self.path)
            status = self.path.stat()
            if (stamp := (status.st_mtime_ns, status.st_size)) == self.stamp:
                return
            self.rows, self.tail = _count(self.path), _tail(self.path, status.st_size)
            self.stamp = stamp
        except (OSError, ValueError, csv.Error):  # it is being replaced, or is none
            self.rows, self.tail = 0, []


@dataclass(slots=True)
class Progress:
    """The tables of an experiment's jobs, and when how many episodes were done."""

    folders: Sequence[Path]
    episodes: int
    tables: list[Table] = field(default_factory=list)
    seen: deque[tuple[float, int]] = field(default_factory=deque)

    def look(self) -> dict[str, Any]:
        """Return ``done`` of ``episodes``, the seconds that are left (None: nothing is known), and the last rows with their job."""
        self.tables = self.tables or [Table(folder / TABLE) for folder in self.folders]
        for table in self.tables:
            table.look()
        done = sum(table.rows for table in self.tables)
        last = [{**row, "job": number} for number, table in enumerate(self.tables) for row in table.tail]
        return {"done": done, "episodes": self.episodes, "left": self._left(done), "last": last[-LAST:]}

    def _left(self, done: int) -> int | None:
        now = monotonic()
        self.seen.append((now, done))
        while self.seen[0][0] < now - WINDOW:
            self.seen.popleft()
        seconds, ended = now - self.seen[0][0], done - self.seen[0][1]
        return round((self.episodes - done) * seconds / ended) if ended > 0 else None


def _count(path: Path) -> int:
    """Return the number of rows: cells hold no line breaks."""
    with path.open("rb") as file:
        return max(0, sum(part.count(b"\n") for part in iter(lambda: file.read(PART), b"")) - 1)


def _tail(path: Path, size: int) -> list[dict[str, str]]:
    with path.open("rb") as file:
        head = file.readline(TAIL).decode(errors="replace")
        file.seek(max(len(head.encode()), size - TAIL))
        text = file.read(TAIL).decode(errors="replace")
    lines = text.splitlines()[1:] if size - TAIL > len(head) else text.splitlines()
    return [_known(row) for row in csv.DictReader([head, *lines[-LAST:]])]


def _known(row: Mapping[str, Any]) -> dict[str, str]:
    return {name: str(row[name]) for name in SHOWN if row.get(name)}
