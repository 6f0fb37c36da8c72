"""The built-in executors: one after the other, or in warm and supervised worker processes."""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from multiprocessing.connection import wait
from time import monotonic
from typing import Any, TypeVar

from arena_core.base.ctrl_c import interrupts
from arena_core.base.errors import described
from arena_core.base.notices import tell
from arena_core.contracts.interfaces import Executor, Job, Lost
from arena_core.runs.budgets import Budgets, Watch
from arena_core.runs.compiling import MANY, NOTICE, Turns, Waiting
from arena_core.runs.workers import Task, Work, Worker
from arena_core.runs.working import rehearse
from arena_core.values.parameters import Workers

T = TypeVar("T")
LOOK_EVERY = 0.1  # s between two looks at the workers
ATTEMPTS = 2  # of a job whose worker died unexplained: it may have been somebody else's doing


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
        self.workers = workers or os.cpu_count() or 1
        self._budgets = budgets
        self._staff: list[Worker] = []
        self._turns = Turns()

    def map(self, work: Callable[[Job], T], jobs: Sequence[Job]) -> Iterator[T | Lost]:
        """Yield answers as they come, and ``Lost`` for a job that cannot be finished; raise what ``work`` raises."""
        self._turns.expect(jobs)
        return self._answers(work, jobs)

    def prepare(self, check: Callable[[Job], T], jobs: Sequence[Job]) -> Iterator[T | Lost]:
        """Run checks in the workers too, which keep what they build."""
        self._turns.expect([])  # nothing is driven
        return self._answers(check, jobs)

    def close(self) -> None:
        """End the workers, and with them what they are at."""
        while self._staff:
            self._dismiss(self._staff[-1])

    def _answers(self, work: Callable[[Job], T], jobs: Sequence[Job]) -> Iterator[T | Lost]:
        waiting = deque((job, 1) for job in jobs)
        looked = monotonic()
        try:
            while waiting or self._awaited():
                self._employ(work, waiting)
                self._rehearse()
                wait([worker.connection for worker in self._busy()], LOOK_EVERY)
                interrupts.check()
                now = monotonic()
                done = [one for worker in self._busy() for one in self._look(worker, now - looked, waiting)]
                looked = now
                self._employ(work, waiting)  # nobody is idle while the answers are taken
                yield from done
        finally:
            for worker in self._busy():
                self._dismiss(worker)

    def _busy(self) -> list[Worker]:
        return [worker for worker in self._staff if worker.task is not None]

    def _awaited(self) -> list[Worker]:
        return [worker for worker in self._busy() if not (worker.task and worker.task.rehearsal)]

    def _rehearse(self) -> None:
        """Let whoever has nothing to do compile what will be needed, while the leader is at its kernels for longer than a moment."""
        leader = self._turns.leader
        if not isinstance(leader, Worker) or leader.compiled() < MANY:
            return
        while (idle := self._idle()) or len(self._staff) < self.workers:
            job = self._turns.rehearsal()
            if job is None:
                return
            if idle is None:
                idle = Worker()
                self._staff.append(idle)
            idle.begin(rehearse, Task(job, 1, Watch(self._budgets), rehearsal=True))

    def _idle(self) -> Worker | None:
        return next((worker for worker in self._staff if worker.task is None and not worker.death()), None)

    def _employ(self, work: Work, waiting: Waiting) -> None:
        """Give every idle worker a job, and take on more where jobs are left."""
        for worker in [worker for worker in self._staff if worker.task is None]:
            if waiting and not self._begin(worker, work, waiting):
                self._dismiss(worker)  # it died while it had nothing to do
        while len(self._staff) < min(self.workers, len(self._busy()) + len(waiting)):
            self._staff.append(Worker())
            self._begin(self._staff[-1], work, waiting)

    def _begin(self, worker: Worker, work: Work, waiting: Waiting) -> bool:
        """Give a worker what is its turn to do, if anything is; tell whether it is alive."""
        if worker.death():
            return False
        found = self._turns.take(worker, waiting)
        if found is None:
            return True
        job, attempt = found
        if worker.begin(work, Task(job, attempt, Watch(self._budgets))):
            return True
        waiting.appendleft(found)
        return False

    def _look(self, worker: Worker, passed: float, waiting: Waiting) -> Iterator[Any]:
        """Yield what has become of a busy worker's job, if anything has; put it back where it deserves another attempt."""
        task, death = worker.task, worker.death()  # before the answer is looked for: one may answer and die
        assert task is not None
        if worker.has_commanded():
            self._turns.given(worker)
        if worker.compiled() >= MANY:
            tell(NOTICE)
        answer = worker.answer()
        if answer is not None:
            worker.task = None
            self._turns.given(worker)
            if not answer.unchanged:
                self._dismiss(worker)
            if task.rehearsal:
                return
            if isinstance(answer.error, Exception):
                raise answer.error
            yield answer.result if answer.error is None else Lost(task.job, described(answer.error))
        elif reason := death or worker.over_budget(passed):
            self._dismiss(worker)
            if task.rehearsal:
                return
            if death and task.attempt < ATTEMPTS:
                waiting.appendleft((task.job, task.attempt + 1))
            else:
                yield Lost(task.job, reason)

    def _dismiss(self, worker: Worker) -> None:
        self._staff.remove(worker)
        self._turns.given(worker)
        worker.end()
