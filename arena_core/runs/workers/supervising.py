"""One machine's workers: they stay warm, are watched, and are replaced; a job that cannot be
finished is lost and no more.
"""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from multiprocessing.connection import wait
from time import monotonic
from typing import Any

from arena_core.base.errors import describe_error
from arena_core.base.notices import activity, print_notice
from arena_core.contracts.running import Job, Lost
from arena_core.runs.jobs.compiling import MANY, NOTICE, Turns, Waiting
from arena_core.runs.jobs.working import compile_job
from arena_core.runs.workers.budgets import Budgets, Watch
from arena_core.runs.workers.strays import end_strays
from arena_core.runs.workers.worker import Task, Work, Worker

LOOK_EVERY = 0.1  # s between two looks at the workers
ATTEMPTS = 2  # of a job whose worker died unexplained: it may have been someone else's doing


@dataclass(frozen=True, slots=True, eq=False)
class Done:
    """A job that is over: what ``work`` returned of it, or ``Lost``."""

    job: Job
    answer: Any


class Supervisor:
    """Runs jobs in spawned processes on this machine; ``workers`` None means one a core.

    A worker that dies costs the job that it was at, and so does one that is over its budgets; another takes its place.
    Jobs may be added while others run. Whoever uses it looks again and again, in the process's main thread, and closes
    it at the end.
    """

    def __init__(self, workers: int | None, budgets: Budgets) -> None:
        self.workers = workers or os.cpu_count() or 1
        self._budgets = budgets
        self._staff: list[Worker] = []
        self._turns = Turns()
        self._waiting: Waiting = deque()
        self._looked = monotonic()

    @property
    def unfinished(self) -> int:
        """Return how many jobs wait or are under way."""
        return len(self._waiting) + len(self._awaited_workers())

    def begin(self, jobs: Sequence[Job], *, driven: bool = True) -> None:
        """Take the first jobs on; where nothing of them is ``driven``, no worker waits for another to compile."""
        self._turns.expect(jobs if driven else [])
        self._waiting.extend((job, 1) for job in jobs)
        self._looked = monotonic()

    def add(self, jobs: Sequence[Job]) -> None:
        """Take on more jobs."""
        self._turns.expect_more(jobs)
        self._waiting.extend((job, 1) for job in jobs)

    def look(self, work: Work) -> list[Done]:
        """Wait a moment for the workers, and return what is over; raise what ``work`` raised."""
        self._assign_jobs(work)
        self._compile_ahead()
        self._name_compilation()
        wait([worker.connection for worker in self._busy_workers()], LOOK_EVERY)
        now = monotonic()
        done = [one for worker in self._busy_workers() for one in self._check_worker(worker, now - self._looked)]
        self._looked = now
        self._assign_jobs(work)  # no one is idle while the answers are taken
        return done

    def drop(self) -> None:
        """Forget all jobs, and end the workers that are at one."""
        self._waiting.clear()
        self._dismiss_workers(*self._busy_workers())

    def close(self) -> None:
        """End the workers, and with them what they are at."""
        activity.doing = ""
        self._dismiss_workers(*self._staff)

    def _busy_workers(self) -> list[Worker]:
        return [worker for worker in self._staff if worker.task is not None]

    def _awaited_workers(self) -> list[Worker]:
        return [worker for worker in self._busy_workers() if not (worker.task and worker.task.rehearsal)]

    def _compile_ahead(self) -> None:
        """Let whoever has nothing to do compile what will be needed, while the leader is at its
        kernels for longer than a moment.
        """
        leader = self._turns.leader
        if not isinstance(leader, Worker) or leader.compiled() < MANY:
            return
        while (idle := self._idle_worker()) or len(self._staff) < self.workers:
            job = self._turns.rehearsal()
            if job is None:
                return
            if idle is None:
                idle = Worker()
                self._staff.append(idle)
            idle.begin(compile_job, Task(job, 1, Watch(self._budgets), rehearsal=True))

    def _name_compilation(self) -> None:
        """Say beside the bar for which planner the leader compiles, and how many kernels it has come to."""
        leader = self._turns.leader
        activity.doing = ""
        if isinstance(leader, Worker) and leader.task is not None and leader.compiled() >= MANY:
            name = leader.task.job.config.get("planner", {}).get("name", "a job")
            activity.doing = f"compiling what {name} runs with: kernel {leader.compiled()}"

    def _idle_worker(self) -> Worker | None:
        return next((worker for worker in self._staff if worker.task is None and not worker.death()), None)

    def _assign_jobs(self, work: Work) -> None:
        """Give every idle worker a job, and take on more where jobs are left."""
        for worker in [worker for worker in self._staff if worker.task is None]:
            if self._waiting and not self._begin_job(worker, work):
                self._dismiss_workers(worker)  # it died while it had nothing to do
        while len(self._staff) < min(self.workers, len(self._busy_workers()) + len(self._waiting)):
            self._staff.append(Worker())
            self._begin_job(self._staff[-1], work)

    def _begin_job(self, worker: Worker, work: Work) -> bool:
        """Give a worker what is its turn to do, if anything is; return whether it is alive."""
        if worker.death():
            return False
        found = self._turns.take(worker, self._waiting)
        if found is None:
            return True
        job, attempt = found
        if worker.begin(work, Task(job, attempt, Watch(self._budgets), leads=self._turns.leader is worker)):
            return True
        self._waiting.appendleft(found)
        return False

    def _check_worker(self, worker: Worker, passed: float) -> Iterator[Done]:
        """Yield what has become of a busy worker's job, if anything has; put it back where it
        deserves another attempt.
        """
        task, death = worker.task, worker.death()  # before the answer is looked for: one may answer and die
        assert task is not None
        if worker.has_commanded():
            self._turns.given(worker)
        if worker.compiled() >= MANY:
            print_notice(NOTICE)
        answer = worker.answer()
        if answer is not None:
            worker.task = None
            self._turns.given(worker)
            if not answer.unchanged or _uses_much_memory(worker, task):
                self._dismiss_workers(worker)
            if task.rehearsal:
                return
            if isinstance(answer.error, Exception):
                raise answer.error
            yield Done(
                task.job, answer.result if answer.error is None else Lost(task.job, describe_error(answer.error))
            )
        elif reason := death or worker.over_budget(passed):
            self._dismiss_workers(worker)
            if task.rehearsal:
                return
            if death and task.attempt < ATTEMPTS:
                self._waiting.appendleft((task.job, task.attempt + 1))
            else:
                yield Done(task.job, Lost(task.job, reason))

    def _dismiss_workers(self, *workers: Worker) -> None:
        for worker in workers:
            self._staff.remove(worker)
            self._turns.given(worker)
            worker.end()
        end_strays([worker.mark for worker in workers])


def _uses_much_memory(worker: Worker, task: Task) -> bool:
    """Return whether a worker holds what compiling took, twice as much as driving does; its
    successor reads the kernels from disk.
    """
    return (task.leads or task.rehearsal) and worker.compiled() >= MANY
