"""``executor=slurm``: shares of the episodes as Slurm jobs, a few at a time, and their answers as they come."""

from __future__ import annotations

import shutil
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from secrets import token_hex
from time import monotonic, sleep
from typing import Any, Literal, TypeVar

from arena_core import ConfigurationError
from arena_core.commands import describe_error, interrupts, print_notice
from arena_core.files import check_inside
from arena_core.hosting import Budgets, Executor, Job, Lost, OtherCode, ProcessExecutor, RunStopped, require_extra
from arena_core.parameters import PositiveInt, Workers
from arena_slurm.share import Share, fault_of, new_answers, starts_of

T = TypeVar("T")
LOOK_EVERY = 0.5  # s between two looks at the answers
ENDED_WITHIN = 10.0  # s
FOLDER = "slurm"  # in the first run's folder: what submitit and the jobs write
OTHERS = "slurm_"  # what may be said to sbatch besides
Waiting = deque[tuple[Job, int]]


@dataclass(slots=True, eq=False)
class SubmittedShare:
    """A share that a Slurm job is at: submitit's handle, the how manieth attempt each job is,
    and which answers are known.
    """

    share: Share
    handle: Any
    attempts: Sequence[int]
    known: set[int] = field(default_factory=set)

    def remaining_jobs(self) -> list[tuple[Job, int]]:
        """Return the jobs without an answer, with their attempts."""
        return [(job, self.attempts[i]) for i, job in enumerate(self.share.jobs) if i not in self.known]


class SlurmExecutor(Executor):
    """Run jobs in supervised workers within Slurm jobs of up to ``share`` episodes, ``jobs`` of them at a time.

    Workers write to the runs' folders, so these have to be on a disk that all machines have. What a Slurm job that is
    preempted, timed out or lost has not answered is done by another, up to ``attempts`` times. Checks that come before
    a run are made in a process here.
    """

    def __init__(
        self,
        cluster: Literal["slurm", "local"],
        jobs: PositiveInt,
        share: PositiveInt,
        workers: Workers,
        minutes: PositiveInt,
        attempts: PositiveInt,
        partition: str | None,
        options: dict[str, Any],
        budgets: Budgets,
    ) -> None:
        require_extra("executor=slurm", ["submitit"], "arena-cluster[slurm]")
        strange = [key for key in options if not key.startswith(OTHERS)]
        if strange:
            raise ConfigurationError(
                f"executor.options has {strange[0]}; allowed: keys that begin with {OTHERS}, as submitit calls them"
            )
        self._cluster, self._jobs, self._share, self._workers = cluster, jobs, share, workers
        self._attempts, self._budgets = attempts, budgets
        self._words = {"timeout_min": minutes, **options, **({"slurm_partition": partition} if partition else {})}
        self._sent: list[SubmittedShare] = []
        self._ending: list[SubmittedShare] = []
        self._folder: Path | None = None
        self._count = 0
        self._failed = False

    def prepare(self, check: Callable[[Job], T], jobs: Sequence[Job]) -> Iterator[T | Lost]:
        """Run checks in a process of this machine."""
        at_home = ProcessExecutor(1, self._budgets)
        try:
            yield from at_home.prepare(check, jobs)
        finally:
            at_home.close()

    def map(self, work: Callable[[Job], T], jobs: Sequence[Job]) -> Iterator[T | Lost]:
        """Yield answers as their files come, and ``Lost`` for a job that cannot be finished;
        raise what ``work`` raises.
        """
        waiting: Waiting = deque((job, 1) for job in jobs)
        size = max(1, min(self._share, -(-len(waiting) // self._jobs)))  # all Slurm jobs have something to do
        done = False
        try:
            while waiting or self._sent:
                while waiting and len(self._sent) < self._jobs:
                    self._submit_share(work, [waiting.popleft() for _ in range(min(size, len(waiting)))])
                for sent in list(self._sent):
                    yield from self._collect_answers(sent, waiting)
                interrupts.check()
                sleep(LOOK_EVERY)
            done = True
        finally:
            if not done:
                self._failed = True
                self._cancel_jobs()

    def close(self) -> None:
        """Cancel what is under way; remove what submitit wrote, unless something went wrong."""
        self._cancel_jobs()
        if self._folder is not None and not self._failed:
            shutil.rmtree(self._folder.parent, ignore_errors=True)

    def _submit_share(self, work: Callable[[Job], Any], taken: Sequence[tuple[Job, int]]) -> None:
        """Submit a share."""
        folder = self._own_folder(taken[0][0])
        self._count += 1
        answers = folder / f"answers-{self._count:05d}"
        answers.mkdir(parents=True, exist_ok=True)
        jobs = [job for job, _ in taken]
        share = Share(work, jobs, self._workers, self._budgets, str(answers), starts_of({job.folder for job in jobs}))
        submitter = self._make_submitter(folder)
        try:
            handle = submitter.submit(share)
        # FailedJobError where sbatch refuses, and whatever submitit makes of strange options
        except Exception as error:
            raise RunStopped(
                f"Slurm takes no job: {describe_error(error)}; finished episodes are kept, resume=true continues"
            ) from error
        self._sent.append(SubmittedShare(share, handle, [attempt for _, attempt in taken]))

    def _collect_answers(self, sent: SubmittedShare, waiting: Waiting) -> Iterator[Any]:
        """Yield the answers that have come; where the Slurm job is over, put back what it has not done."""
        over = _is_over(sent.handle)  # before the answers are looked for: it may write one and end
        for _, answer in new_answers(sent.share, sent.known):
            yield answer
        if len(sent.known) == len(sent.share.jobs):
            self._sent.remove(sent)
            self._ending.append(sent)  # its answers are here, and it has only its workers to end
        elif over:
            self._sent.remove(sent)
            yield from self._requeue_jobs(sent, waiting)

    def _requeue_jobs(self, sent: SubmittedShare, waiting: Waiting) -> Iterator[Lost]:
        """Put the jobs of a Slurm job that ended early back, or lose them; raise what the work raised."""
        self._failed = True
        fault = fault_of(sent.share)
        if fault is not None and not isinstance(fault, OtherCode):
            raise fault
        reason = str(fault) if fault is not None else f"job {sent.handle.job_id} ended early ({sent.handle.state})"
        print_notice(f"Slurm: {reason}; its episodes are begun again")
        for job, attempt in reversed(sent.remaining_jobs()):
            if attempt >= self._attempts:
                yield Lost(job, f"{reason}, {attempt} times; {sent.handle.paths.stderr} says more")
            else:
                waiting.appendleft((job, attempt + 1))

    def _make_submitter(self, folder: Path) -> Any:
        try:
            import submitit

            executor = submitit.AutoExecutor(folder=folder, cluster=self._cluster)
            executor.update_parameters(name="arena", cpus_per_task=self._workers, **self._words)
        except Exception as error:  # submitit raises whatever strange options lead it to
            raise ConfigurationError(
                f"executor.cluster is {self._cluster}, and it cannot be used: {describe_error(error)}; "
                "allowed: slurm where sbatch is, local"
            ) from None
        return executor

    def _own_folder(self, job: Job) -> Path:
        """Return this start's folder: what an earlier start left is not read."""
        if self._folder is None:
            check_inside(Path(job.folder or "."), Path(job.folder or ".") / FOLDER)
            self._folder = Path(job.folder or ".") / FOLDER / token_hex(8)
        return self._folder

    def _cancel_jobs(self) -> None:
        """End what is under way, and wait a while for what ends by itself."""
        for sent in self._sent:
            with suppress(Exception):  # it may be over, or the site's controller away
                sent.handle.cancel(check=False)
        open_jobs, until = [*self._sent, *self._ending], monotonic() + ENDED_WITHIN
        self._sent.clear()
        self._ending.clear()
        while (open_jobs := [sent for sent in open_jobs if not _is_over(sent.handle)]) and monotonic() < until:
            sleep(LOOK_EVERY / 5)


def _is_over(handle: Any) -> bool:
    """Return whether a Slurm job has ended; not where the site cannot say so."""
    try:
        return bool(handle.done())
    except Exception:  # submitit raises what it cannot make of the words of sacct
        return False
