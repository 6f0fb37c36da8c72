"""The built-in executors: one after the other, or in warm worker processes."""

from __future__ import annotations

import multiprocessing
import os
import signal
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from typing import Any

from arena_core.errors import RunStopped
from arena_core.interfaces import Executor, Job
from arena_core.parameters import PositiveInt

Work = Callable[[Job], Mapping[str, Any]]


class SerialExecutor(Executor):
    """Run one job after the other in this process."""

    def map(self, work: Work, jobs: Sequence[Job]) -> Iterator[Mapping[str, Any]]:
        """Yield the rows in order."""
        return (work(job) for job in jobs)


class ProcessExecutor(Executor):
    """Run jobs in spawned processes that stay warm; ``workers`` null means one a core."""

    def __init__(self, workers: PositiveInt | None) -> None:
        self.workers = workers or os.cpu_count() or 1
        self._pool: ProcessPoolExecutor | None = None

    def map(self, work: Work, jobs: Sequence[Job]) -> Iterator[Mapping[str, Any]]:
        """Yield rows as they are finished; raise RunStopped when a worker process dies."""
        if self._pool is None:
            if min(self.workers, len(jobs)) <= 1:
                yield from SerialExecutor().map(work, jobs)
                return
            self._pool = ProcessPoolExecutor(self.workers, multiprocessing.get_context("spawn"), _quiet_interrupt)  # spawns as needed
        try:
            for future in as_completed([self._pool.submit(work, job) for job in jobs]):
                yield future.result()
        except BrokenProcessPool as error:
            raise RunStopped("a worker process died (out of memory?); finished episodes are kept, resume=true continues") from error

    def close(self) -> None:
        """End the workers, and with them what they are at."""
        if self._pool is not None:
            self._pool.shutdown(wait=True, cancel_futures=True)
            self._pool = None


def _quiet_interrupt() -> None:
    """Leave Ctrl-C to the main process."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
