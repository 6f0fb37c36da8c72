"""The built-in executors: one after the other, or in warm and supervised worker processes."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import TypeVar

from arena_core.base.ctrl_c import interrupts
from arena_core.contracts.running import Executor, Job, Lost
from arena_core.runs.workers.budgets import Budgets
from arena_core.runs.workers.supervising import Supervisor
from arena_core.values.parameters import Workers

T = TypeVar("T")


class SerialExecutor(Executor):
    """Run one job after the other in this process. Whatever ends or hangs the process ends or hangs the run."""

    def map(self, work: Callable[[Job], T], jobs: Sequence[Job]) -> Iterator[T | Lost]:
        """Yield the answers in order."""
        return (work(job) for job in jobs)


class ProcessExecutor(Executor):
    """Run jobs in spawned processes that stay warm; ``workers`` null means one a core.

    A worker that dies costs the job that it was at, and so does one that is over its budgets; another takes its place.
    """

    def __init__(self, workers: Workers | None, budgets: Budgets) -> None:
        self.supervisor = Supervisor(workers, budgets)

    def map(self, work: Callable[[Job], T], jobs: Sequence[Job]) -> Iterator[T | Lost]:
        """Yield answers as they come, and ``Lost`` for a job that cannot be finished; raise what ``work`` raises."""
        return self._collect_answers(work, jobs, driven=True)

    def prepare(self, check: Callable[[Job], T], jobs: Sequence[Job]) -> Iterator[T | Lost]:
        """Run checks in the workers too, which keep what they build."""
        return self._collect_answers(check, jobs, driven=False)

    def close(self) -> None:
        """End the workers, and with them what they are at."""
        self.supervisor.close()

    def _collect_answers(self, work: Callable[[Job], T], jobs: Sequence[Job], *, driven: bool) -> Iterator[T | Lost]:
        self.supervisor.begin(jobs, driven=driven)
        try:
            while self.supervisor.unfinished:
                done = self.supervisor.look(work)
                interrupts.check()
                for one in done:
                    yield one.answer
        finally:
            self.supervisor.drop()
