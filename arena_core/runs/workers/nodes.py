"""One machine's share of a run that several machines drive: supervised workers, the right code, and what
goes home when a job is over.
"""

from __future__ import annotations

import json
import platform
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from hashlib import blake2b
from pathlib import Path
from typing import Any

from arena_core.base.errors import ArenaError, InputFileError, one_line
from arena_core.base.files import check_inside
from arena_core.base.whole_files import write_bytes_whole
from arena_core.config.registry import Registry, load_registry
from arena_core.contracts.running import Finished, Job, Lost
from arena_core.loop.record_places import OF_EPISODE, PARTS, record_path, timing_path
from arena_core.runs.jobs.code_digest import digest_code
from arena_core.runs.workers.budgets import Budgets
from arena_core.runs.workers.supervising import Supervisor
from arena_core.runs.workers.worker import Work

NAMES = re.compile(rf"({'|'.join(PARTS)})/{OF_EPISODE}|worlds/[0-9a-f]{{16}}\.npz")


class OtherCode(ArenaError):
    """A machine has other code than the one that the run was begun on; the message names the machine and the code."""

    exit_status = 1


@dataclass(frozen=True, slots=True, eq=False)
class Delivery:
    """What a node hands over: what came of a job, with its own folder as at home, and the job's
    files by their names below it.
    """

    answer: Any
    job: Job
    files: Mapping[str, bytes]


class Node:
    """A machine's share of runs; ``folder``, of its own, is where its workers write; None:
    straight to the runs' folders.
    """

    def __init__(self, workers: int | None, budgets: Budgets, folder: str | Path | None = None) -> None:
        self._supervisor = Supervisor(workers, budgets)
        self._folder = None if folder is None else Path(folder)
        self._homes: dict[str, str] = {}
        self._handed_over: set[Path] = set()
        self._checked: set[int] = set()
        self._registry: Registry | None = None
        self._supervisor.begin([])

    @property
    def workers(self) -> int:
        """Return how many jobs run at a time."""
        return self._supervisor.workers

    @property
    def unfinished(self) -> int:
        """Return how many jobs wait or are under way."""
        return self._supervisor.unfinished

    def add(self, jobs: Sequence[Job]) -> None:
        """Take on jobs; raise OtherCode where the code here is not that with which their runs were begun."""
        for job in jobs:
            self._check_code(job.config)
        self._supervisor.add([replace(job, folder=self._job_folder(job)) for job in jobs])

    def look(self, work: Work) -> list[Delivery]:
        """Wait a moment, and return what is over; raise what ``work`` raised."""
        return [self._make_delivery(one.job, one.answer) for one in self._supervisor.look(work)]

    def close(self) -> None:
        """End the workers."""
        self._supervisor.close()

    def _check_code(self, config: Mapping[str, Any]) -> None:
        wanted = config.get("code")
        key = hash(json.dumps(config, sort_keys=True)) if wanted else 0
        if not wanted or key in self._checked:
            return
        self._registry = self._registry or load_registry()
        code = digest_code(config, self._registry)
        if code.digest != wanted:
            parts = ", ".join(f"{name} {content}" for name, content in code.parts.items())
            raise OtherCode(
                f"{platform.node()} has other code, {code.digest} in place of {wanted}: {one_line(parts, 300)}"
            )
        self._checked.add(key)

    def _job_folder(self, job: Job) -> str:
        """Return the folder in which a job runs here."""
        if self._folder is None or not job.folder:
            return job.folder
        place = self._folder / blake2b(job.folder.encode(), digest_size=8).hexdigest()
        place.mkdir(parents=True, exist_ok=True)
        self._homes[str(place)] = job.folder
        return str(place)

    def _make_delivery(self, job: Job, answer: Any) -> Delivery:
        home = replace(job, folder=self._homes.get(job.folder, job.folder))
        told = _send_home(answer, home) if isinstance(answer, Finished | Lost) else answer
        return Delivery(told, home, self._job_files(job) if self._folder is not None and job.folder else {})

    def _job_files(self, job: Job) -> dict[str, bytes]:
        """Return a job's files, those of a whole team, and the maps that are new, and keep only the maps."""
        folder = Path(job.folder)
        episodes = range(job.episode, job.episode + job.robots)
        named = [place(folder, episode) for place in (timing_path, record_path) for episode in episodes]
        own = [path for path in named if path.exists()]
        maps = [path for path in sorted((folder / "worlds").glob("*.npz")) if path not in self._handed_over]
        content = {path.relative_to(folder).as_posix(): path.read_bytes() for path in (*maps, *own)}
        self._handed_over.update(maps)
        for path in own:
            path.unlink()
        return content


def _send_home(answer: Finished | Lost, home: Job) -> Finished | Lost:
    """Return what came of a job as that of the job in its own folder, with what came of the rest of a team."""
    if isinstance(answer, Lost):
        return replace(answer, job=home)
    team = tuple(replace(one, job=replace(home, episode=one.job.episode)) for one in answer.team)
    return replace(answer, job=home, team=team)


def store_delivery(delivery: Delivery) -> Any:
    """Write a delivery's files to its run's folder, its record last, and return what came of the job.

    Raises RunFolderError where one cannot be written, InputFileError for a file that no job has.
    """
    for name, content in delivery.files.items():
        if not NAMES.fullmatch(name):
            raise InputFileError(f"a node sent {one_line(name, 100)}; allowed: records, timing and worlds of a run")
        path = Path(delivery.job.folder) / name
        check_inside(Path(delivery.job.folder), path.parent)
        if not (name.startswith("worlds/") and path.exists()):
            write_bytes_whole(path, content)
    return delivery.answer
