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

    def map(self, work: Work, jobs: Sequence[Job]) -> Iterator[Mapping[str, Any]]:
        """Yield rows as they are finished; raise RunStopped when a worker process dies."""
        workers = min(self.workers, len(jobs))
        if workers <= 1:
            yield from SerialExecutor().map(work, jobs)
            return
        pool = ProcessPoolExecutor(workers, multiprocessing.get_context("spawn"), _quiet_interrupt)
        try:
            for future in as_completed([pool.submit(work, job) for job in jobs]):
                yield future.result()
        except BrokenProcessPool as error:
            raise RunStopped("a worker process died (out of memory?); finished episodes are kept, resume=true continues") from error
        finally:
            pool.shutdown(wait=True, cancel_futures=True)


def _quiet_interrupt() -> None:
    """Leave Ctrl-C to the main process."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
