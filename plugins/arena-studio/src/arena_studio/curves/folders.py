"""Which folders of a project hold a tuning, a ladder or a training, and whether it runs."""

from __future__ import annotations

import os
import time
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from arena_core.commands import one_line
from arena_studio.errors import Missing
from arena_studio.project import DEEPEST, RECORDED, Project

Kind = Literal["tuning", "ladder", "training"]
MARKS: dict[Kind, tuple[tuple[str, ...], ...]] = {  # files of each group of which one is there
    "tuning": (("settings.json",), ("episodes.jsonl", "study.db", "card.json")),
    "ladder": (("ladder_request.json", "ladder.json"),),
    "training": (("config.json",), ("code.json", "curve.json", "checkpoint.pt")),
}
WRITTEN: dict[Kind, tuple[str, ...]] = {  # what grows while it runs
    "tuning": ("settings.json", "episodes.jsonl", "study.db", "card.json"),
    "ladder": ("ladder_request.json", "*/[0-9][0-9][0-9]_*/episodes.csv", "ladder.json"),
    "training": (
        "config.json",
        "curve.json",
        "checkpoint.pt",
        "policy.json",
        "tensorboard/*/events*",
        "last/policy.json",
    ),
}
# what is written at the end
LAST: dict[Kind, str] = {"tuning": "card.json", "ladder": "ladder.json", "training": "last/policy.json"}
RUNNING = 300.0  # s without a written word after which it no longer counts as running
MOST = 500  # folders that are listed


@dataclass(frozen=True, slots=True)
class Study:
    """A folder, what is in it, whether it ``runs`` or is ``finished``, and the seconds since something was written."""

    path: str
    kind: Kind
    state: Literal["running", "finished", "stopped"]
    quiet: int


def find_studies(project: Project) -> list[Study]:
    """Return the studies of a project, those written to last first."""
    found = [look_at(project, place, kind) for place, kind in _walk(project.root)]
    return sorted(found, key=lambda one: one.quiet)


def study_at(project: Project, path: str) -> Study:
    """Return what is in a folder of a project; raise Missing where it is no study."""
    place = project.root if path == "." else project.path(path)
    names = {entry.name for entry in place.iterdir()} if place.is_dir() else set()
    kind = kind_of(names)
    if kind is None:
        raise Missing(
            f"{one_line(path, 80)}: is no tuning, ladder or training; allowed: a folder that one of them wrote"
        )
    return look_at(project, place, kind)


def kind_of(names: Iterable[str]) -> Kind | None:
    """Return what a folder with files of these names is, None where it is none of them."""
    there = set(names)
    return next((kind for kind, groups in MARKS.items() if all(there.intersection(some) for some in groups)), None)


def look_at(project: Project, place: Path, kind: Kind) -> Study:
    """Return how a study stands: finished once its last file is there and nothing was written after it."""
    newest = max((_changed(path) for pattern in WRITTEN[kind] for path in place.glob(pattern)), default=0.0)
    quiet = max(0.0, time.time() - newest)
    last = _changed(place / LAST[kind])
    grown = max((_changed(path) for path in place.glob(WRITTEN[kind][1])), default=0.0)
    finished = last > 0.0 and last >= grown
    path = project.relative(place) if place != project.root else "."
    return Study(path, kind, "finished" if finished else "running" if quiet < RUNNING else "stopped", int(quiet))


def _walk(root: Path) -> Iterator[tuple[Path, Kind]]:
    """Yield the folders that are studies; nothing below one is another."""
    count = 0
    for folder, folders, names in os.walk(root):
        place = Path(folder)
        kind = kind_of([*names, *folders])
        deep = len(place.relative_to(root).parts) >= DEEPEST
        is_run = "episodes.csv" in names
        folders[:] = (
            []
            if deep or kind is not None
            else sorted(f for f in folders if not f.startswith(".") and not (is_run and f in RECORDED))
        )
        if kind is not None:
            yield place, kind
            count += 1
        if count == MOST:
            return


def _changed(path: Path) -> float:
    """Return when a file was written, s since 1970; 0 where it is not there."""
    try:
        return path.stat().st_mtime
    except OSError:
        return 0.0
