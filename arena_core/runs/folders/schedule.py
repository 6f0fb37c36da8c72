"""Runs under way: what each still has to run, and the rows that it has so far."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from time import monotonic
from typing import Any

from arena_core.base.errors import RunFolderError
from arena_core.base.folders import folder_identity
from arena_core.contracts.running import Finished, Job, Metric
from arena_core.runs.folders.kept_rows import KeptRow
from arena_core.runs.jobs.code_digest import Code
from arena_core.runs.jobs.rows import write_episodes
from arena_core.values.staging import Staging

WRITE_EVERY = 1.0  # s between two writes of a growing episodes.csv, at least
WRITE_SHARE = 0.05  # of the time that may go into them: a table of a million rows takes many seconds


@dataclass(frozen=True, slots=True)
class Block:
    """The episodes that a task which adapts runs on one level; ``ended`` once all of them have been run."""

    stage: int
    episodes: range
    ended: bool


@dataclass(slots=True, eq=False)
class OpenRun:
    """One run under way: what it is, what its planner says is ``untuned`` and how it learned, its rows by episode, and
    which were successes.

    ``superseded`` rows are of other code than ``code``, to be run again. ``place`` is the folder's identity once the
    run has begun. ``robots`` are in each of its scenarios, with an episode each.
    """

    config: Mapping[str, Any]
    folder: Path
    packs: Mapping[str, Sequence[Metric]]
    staging: Staging | None
    code: Code
    untuned: Sequence[str] = ()
    learned_by: str = ""
    robots: int = 1
    rows: dict[int, Mapping[str, Any]] = field(default_factory=dict)
    successes: dict[int, bool] = field(default_factory=dict)
    superseded: dict[int, Mapping[str, Any]] = field(default_factory=dict)
    place: tuple[int, int] | None = None
    written: float = 0.0
    write_took: float = 0.0
    unwritten: bool = True

    @property
    def failed(self) -> bool:
        """Return whether an episode ended with an error."""
        return any(row["outcome"] == "error" for row in self.rows.values())

    def take(self, finished: Finished) -> None:
        """Keep the row of a finished episode; raise RunFolderError where the folder is no longer the run's."""
        self.check_place()
        episode = int(finished.row["episode"])
        self.rows[episode], self.successes[episode] = KeptRow(finished.row), finished.succeeded
        self.unwritten = True
        if monotonic() - self.written > max(WRITE_EVERY, self.write_took / WRITE_SHARE):
            self.write()

    def write(self) -> None:
        """Write the table of what is finished; raise RunFolderError where it cannot be written, or the
        folder is no longer the run's.
        """
        self.check_place()
        began = monotonic()
        try:
            write_episodes(self.folder, {**self.superseded, **self.rows}.values(), self.packs)
        except RunFolderError:
            self.check_place()  # it may have gone since
            raise
        self.written = monotonic()
        self.write_took, self.unwritten = self.written - began, False

    def check_place(self) -> None:
        """Raise RunFolderError where another folder, or none, has the name that the run's folder had when it began."""
        if self.place not in (None, folder_identity(self.folder)):
            raise RunFolderError(
                f"{self.folder} was moved, removed or replaced while its run was under way; allowed: "
                "a folder that stays"
            )

    def left(self) -> int:
        """Return how many episodes have no row yet."""
        return sum(i not in self.rows for i in range(self.total))

    @property
    def total(self) -> int:
        """Return how many episodes there are: one for each robot of each scenario."""
        return int(self.config["episodes"]) * self.robots

    def due(self) -> list[Job]:
        """Return the episodes that can be run now: all that are left, or those of the
        first block that has not ended.
        """
        if self.staging is None:
            return [
                Job(self.config, str(self.folder), i, None, self.robots)
                for i in range(0, self.total, self.robots)
                if any(i + member not in self.rows for member in range(self.robots))
            ]
        open_blocks = [block for block in self.blocks() if not block.ended]
        return [
            Job(self.config, str(self.folder), i, b.stage)
            for b in open_blocks
            for i in b.episodes
            if not self._has_run(i, b.stage)
        ]

    def blocks(self) -> Iterator[Block]:
        """Yield the blocks of a task that adapts as far as their levels are known; they follow
        from the finished episodes alone.
        """
        if self.staging is None:
            return
        stage, episodes = self.staging.start, self.config["episodes"]
        for first in range(0, episodes, self.staging.block):
            block = range(first, min(first + self.staging.block, episodes))
            ended = all(self._has_run(i, stage) for i in block)
            yield Block(stage, block, ended)
            if not ended:
                return
            stage = self.staging.next(stage, [self.successes[i] for i in block])

    def _has_run(self, episode: int, stage: int) -> bool:
        """Return whether an episode was run on this level: one that was run on another does not count."""
        return episode in self.rows and self.rows[episode].get("stage") == stage


def job_rounds(runs: Sequence[OpenRun]) -> Iterator[list[Job]]:
    """Yield all jobs that can be run now, again and again, until nothing new is left; each round ends
    before the next is asked for.
    """
    asked: set[tuple[str, int, int | None]] = set()  # a job whose row never comes is not asked for twice
    while jobs := [job for run in runs for job in run.due() if (job.folder, job.episode, job.stage) not in asked]:
        asked.update((job.folder, job.episode, job.stage) for job in jobs)
        yield jobs
