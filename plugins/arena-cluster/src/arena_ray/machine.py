"""What runs on each machine of a cluster: an actor with supervised workers, asked again and again for what is over."""

from __future__ import annotations

import os
import platform
from collections.abc import Callable, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from time import monotonic
from typing import Any

from arena_core.hosting import Budgets, Delivery, Job, Node

Work = Callable[[Job], Any]
THREADS = "OMP_NUM_THREADS"  # Ray sets it where no one has; numbers may depend on it


class Machine:
    """One machine's share; ``threads`` is what the environment says at home of threads of compiled libraries."""

    def __init__(self, workers: int, budgets: Budgets, threads: str | None) -> None:
        os.environ.pop(THREADS, None)
        if threads is not None:
            os.environ[THREADS] = threads
        self._folder = TemporaryDirectory(prefix="arena-node-")
        self._node = Node(workers, budgets, Path(self._folder.name))

    def name(self) -> str:
        """Return what people call the machine; the answer says that the actor is there."""
        return platform.node()

    def poll_work(self, work: Work, jobs: Sequence[Job], patience: float) -> list[Delivery]:
        """Take on jobs, and return what is over as soon as anything is, else after ``patience`` s, with nothing.

        Raises OtherCode where the machine has not the code of a job's run, and what ``work`` raised.
        """
        self._node.add(jobs)
        until = monotonic() + patience
        while self._node.unfinished:
            if done := self._node.look(work):
                return done
            if monotonic() > until:
                break
        return []

    def close(self) -> None:
        """End the workers."""
        self._node.close()
        self._folder.cleanup()
