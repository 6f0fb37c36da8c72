"""How long runs under way may take still, from their folders alone: by the core's pace, and
when their records were written.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Hashable, Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from arena_core import ArenaError
from arena_core.commands import Pace
from arena_core.files import read_json
from arena_core.records import record_path

PROVENANCE = "provenance.json"
RECENT = 200  # episodes of a run, the last ones of its table, whose ends are looked at
LONGEST = 9  # digits of an episode's number


@dataclass(frozen=True, slots=True)
class RunStart:
    """What a run's folder says of its latest start: when that was, s since 1970, of how many
    episodes and which configuration.
    """

    time: float = 0.0
    episodes: int = 0
    config: Mapping[str, Any] | None = None


@dataclass(frozen=True, slots=True)
class ActiveRun:
    """A run under way: its configuration (None: not known), episodes that are due, and when others of this
    start ended, s since 1970.
    """

    config: Mapping[str, Any] | None
    due: int
    ends: Sequence[float]


def read_run_start(folder: Path) -> RunStart:
    """Return what a run's folder says of its latest start, nothing where it has not begun."""
    path = folder / PROVENANCE
    try:
        facts = read_json(path, "what `arena run` wrote")
        return RunStart(path.stat().st_mtime, int(facts["episodes"]), dict(facts["config"]))
    except (ArenaError, OSError, ValueError, KeyError, TypeError, OverflowError):
        return RunStart()


def episodes_of(rows: Iterable[Mapping[str, str]]) -> list[int]:
    """Return the episodes' numbers of the rows of a table, of those that have one."""
    texts = [row.get("episode") or "" for row in rows]
    return [int(text) for text in texts if text.isascii() and text.isdecimal() and len(text) <= LONGEST]


def end_times(folder: Path, episodes: Iterable[int], since: float) -> list[float]:
    """Return when the records of these episodes were written, of those that were since then."""
    found = []
    for episode in episodes:
        with suppress(OSError):
            found.append(record_path(folder, episode).stat().st_mtime)
    return [end for end in found if end >= since]


def time_left(runs: Sequence[ActiveRun], now: float) -> float | None:
    """Return how long the episodes that are due may take, s; None where too few of this start have ended to say."""
    configs = [run.config for run in runs if run.config is not None]
    if not runs or len(configs) < len(runs):
        return None
    kinds, pace, due = [Pace.kind(config) for config in configs], Pace.of_run(configs[0]), Counter[Hashable]()
    for kind, run in zip(kinds, runs, strict=True):
        due[kind] += run.due
    for end, number in sorted((end, number) for number, run in enumerate(runs) for end in run.ends):
        pace.add(kinds[number], end)
    return pace.left(due, now)
