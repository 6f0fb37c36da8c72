"""Runs that are under way, from their folders alone: what has finished, where running episodes
are, how long it may take still.
"""

from __future__ import annotations

import json
import re
import time
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

from arena_core import ArenaError, InputFileError
from arena_core.commands import one_line
from arena_core.files import LIMITS, read_bytes, read_table
from arena_core.records import find_runs, read_grid
from arena_viewer.document import FREE, OCCUPIED, UNKNOWN, null_nonfinite, read_recorded, replay_document
from arena_viewer.time_left import RECENT, ActiveRun, end_times, episodes_of, read_run_start, time_left

LOOK_EVERY, RUNS_EVERY = 0.2, 5.0  # s between two looks at the folder, and for new runs
GRID = re.compile(r"worlds/[0-9a-f]+\.npz")  # as a run writes them
STALE = 10.0  # s after which a running episode that tells nothing counts as lost
SHOWN, DRAWN = 200, 12  # rows of finished episodes, the newest, and running episodes, that are told
OWN = ("ends", "config")  # what is kept of a run, and not told
ROW = ("episode", "preset", "robot", "world", "seed", "outcome", "success", "collisions", "time_to_goal", "error")


class LiveRuns:
    """The runs at or below a folder, which need not be there yet."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._runs: list[Path] = []
        self._tables: dict[Path, tuple[int, list[dict[str, str]]]] = {}
        self._sought = self._looked = -RUNS_EVERY
        self._state = b"{}"

    def state(self, asked: Mapping[str, str]) -> tuple[str, bytes]:
        """Return what is known now, JSON."""
        now = time.monotonic()
        if now - self._looked >= LOOK_EVERY:
            self._looked = now
            runs = [self._run_state(number, run) for number, run in enumerate(self._find_folders(now))]
            told = {
                "runs": [{key: value for key, value in run.items() if key not in OWN} for run in runs],
                **_run_totals(runs),
            }
            self._state = json.dumps(null_nonfinite(told)).encode()
        return "application/json", self._state

    def document(self, asked: Mapping[str, str]) -> tuple[str, bytes]:
        """Return the replay document of an episode that has finished."""
        return "application/octet-stream", replay_document(
            [read_recorded(self._requested_folder(asked), _read_number(asked, "episode"))]
        )

    def map(self, asked: Mapping[str, str]) -> tuple[str, bytes]:
        """Return a run's map, JSON: its cells row by row, 0 free, 1 occupied, 2 unknown, each a digit."""
        name = asked.get("grid", "")
        if not GRID.fullmatch(name):
            raise InputFileError(f"grid is {one_line(repr(name), 80)}; allowed: worlds/HASH.npz, as an episode says")
        grid = read_grid(self._requested_folder(asked) / name)
        cells = grid.data.copy()
        cells[:] = FREE
        cells[grid.data < 0] = UNKNOWN
        cells[grid.occupied] = OCCUPIED
        height, width = cells.shape
        said = {"width": width, "height": height, "resolution": grid.resolution, "origin": grid.origin.array().tolist()}
        return "application/json", json.dumps(
            {**said, "cells": (cells.astype("uint8") + ord("0")).tobytes().decode()}
        ).encode()

    def _find_folders(self, now: float) -> list[Path]:
        if now - self._sought >= RUNS_EVERY:
            self._sought = now
            with suppress(InputFileError):  # nothing is there yet
                # a run keeps its number
                self._runs += [run for run in find_runs(self._folder) if run not in self._runs]
        return self._runs

    def _requested_folder(self, asked: Mapping[str, str]) -> Path:
        number = _read_number(asked, "run")
        if number >= len(self._runs):
            raise InputFileError(f"run is {number}; allowed: less than {len(self._runs)}")
        return self._runs[number]

    def _run_state(self, number: int, folder: Path) -> dict[str, Any]:
        begun = read_run_start(folder)
        rows = self._read_rows(folder)
        return {
            "number": number,
            "name": str(folder.relative_to(self._folder)) if folder != self._folder else folder.name,
            "total": max(begun.episodes, len(rows)),
            "done": len(rows),
            "ends": end_times(folder, episodes_of(rows[-RECENT:]), begun.time),
            "config": begun.config,
            "succeeded": sum(row.get("success") in ("1", "1.0") for row in rows),
            "rows": [{name: row.get(name, "") for name in ROW} for row in rows[-SHOWN:]],
            "running": _running_episodes(folder, set(episodes_of(rows))),
        }

    def _read_rows(self, folder: Path) -> list[dict[str, str]]:
        path = folder / "episodes.csv"
        with suppress(OSError, ArenaError):  # where it is being replaced, the next look finds it
            written = path.stat().st_mtime_ns
            if self._tables.get(folder, (0,))[0] != written:
                self._tables[folder] = (
                    written,
                    [dict(row) for row in read_table(path, "a table that `arena run` wrote")[1]],
                )
        return self._tables.get(folder, (0, []))[1]


def _running_episodes(folder: Path, done: set[int]) -> list[dict[str, Any]]:
    """Return what running episodes told last."""
    found = []
    for path in sorted((folder / "live").glob("*.json"))[: 4 * DRAWN]:
        try:
            said, age = (
                json.loads(read_bytes(path, LIMITS.json_bytes, "what a running episode tells")),
                time.time() - path.stat().st_mtime,
            )
        except (ArenaError, OSError, ValueError):
            continue  # it has just ended
        if isinstance(said, dict) and said.get("episode") not in done and age < STALE:
            found.append(said)
    return found[:DRAWN]


def _run_totals(runs: list[dict[str, Any]]) -> dict[str, Any]:
    """Return sums over runs, and how many s it may take still: None where too little of this
    start has finished to say.
    """
    total, done, succeeded = (sum(run[name] for run in runs) for name in ("total", "done", "succeeded"))
    workers = len({said.get("worker") for run in runs for said in run["running"]})
    under_way = [ActiveRun(run["config"], run["total"] - run["done"], run["ends"]) for run in runs]
    left = 0.0 if runs and total == done else time_left(under_way, time.time())
    return {"total": total, "done": done, "succeeded": succeeded, "left": left, "workers": workers}


def _read_number(asked: Mapping[str, str], name: str) -> int:
    text = asked.get(name, "")
    if not text.isascii() or not text.isdecimal() or len(text) > 9:
        raise InputFileError(f"{name} is {text[:20]!r}; allowed: a number")
    return int(text)
