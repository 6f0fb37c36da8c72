"""A worker process, from outside: give it a job, see whether it is alive and what it takes, end it."""

from __future__ import annotations

import multiprocessing
import os
import signal
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from types import ModuleType
from typing import Any

import psutil

from arena_core.base.errors import RunStopped
from arena_core.base.portability import STOPPING, end_group, kept_from_children
from arena_core.base.pulse import FINISHING, STARTING
from arena_core.contracts.running import Job
from arena_core.runs.jobs.compiling import Parts, parts_of
from arena_core.runs.workers import strays
from arena_core.runs.workers.budgets import Watch
from arena_core.runs.workers.messages import Inbox, new_mark
from arena_core.runs.workers.serving import serve_jobs

Work = Callable[[Job], Any]
PATIENCE = 2.0  # s that a killed process may take to go; one that the kernel holds is left behind


@dataclass(frozen=True, slots=True, eq=False)
class Task:
    """A job under way: the how manieth attempt it is, and what it has taken; no one waits for the answer to a
    ``rehearsal``.

    ``leads`` says that no one has driven with its components before: what it needs may have to be compiled.
    """

    job: Job
    attempt: int
    watch: Watch
    leads: bool = False
    rehearsal: bool = False


@dataclass(frozen=True, slots=True)
class Answer:
    """What a worker sends back: what ``work`` returned, or the error that it raised, and whether
    the worker can be used again.
    """

    result: Any
    error: BaseException | None
    unchanged: bool


@contextmanager
def _no_script() -> Iterator[None]:
    """Keep new processes from importing the script that runs: they need nothing of it, and it may lack a main guard."""
    script, sys.modules["__main__"] = sys.modules["__main__"], ModuleType("__main__")
    try:
        yield
    finally:
        sys.modules["__main__"] = script


class Worker:
    """One spawned process; ``task`` is what it is at, ``mark`` what its own processes are known by."""

    def __init__(self) -> None:
        context = multiprocessing.get_context("spawn")
        self.task: Task | None = None
        self.connection, theirs = context.Pipe()
        self.mark, mark = strays.new_mark(), new_mark()
        self._inbox = Inbox(self.connection, mark)
        self._mute = False
        self._driven: set[Parts] = set()
        self._compiled_before = 0
        self._beats, self._compiled = context.RawValue("q", 0), context.RawValue("q", 0)
        cells = (self._beats, self._compiled)
        self._process = context.Process(
            target=serve_jobs, args=(theirs, mark, cells, os.getpid(), self.mark), name="arena worker"
        )
        try:
            with kept_from_children(STOPPING), _no_script():  # until the worker ignores them
                self._process.start()
        except OSError as error:
            raise RunStopped(
                f"no worker process can be started: {error.strerror or error}; finished episodes are kept"
            ) from error
        finally:
            theirs.close()

    def begin(self, work: Work, task: Task) -> bool:
        """Hand a job over; return whether the worker was there to take it."""
        self._beats.value = STARTING
        self._compiled_before = self.compiled()
        try:
            self.connection.send((work, task.job))
        except OSError:
            return False
        self.task = task
        return True

    def answer(self) -> Answer | None:
        """Return what the worker has sent, None if nothing is there."""
        try:
            sent = self._inbox.take()
            answer = None if sent is None else Answer(*sent)
        except Exception:  # closed, or no answer: nothing more will come
            self._mute = True
            return None
        if answer is not None and self.task is not None and self.has_commanded():
            self._driven.add(_job_components(self.task.job))
        return answer

    def death(self) -> str | None:
        """Return how the worker ended, None while it lives.

        Asks the kernel: a pipe may be held open by a forked child.
        """
        if self._mute:
            self._process.join(PATIENCE)
        code = self._process.exitcode
        if code is None:
            return "worker died: it closed its pipe" if self._mute else None
        return f"worker died: {_signal_name(-code) if code < 0 else f'exit status {code}'}"

    def has_commanded(self) -> bool:
        """Return whether the task's first command is given."""
        return int(self._beats.value) > 1 or int(self._beats.value) == FINISHING

    def compiled(self) -> int:
        """Return how many kernels the process has begun to compile."""
        return int(self._compiled.value)

    def over_budget(self, passed: float) -> str | None:
        """Return which budget of the task is at its end, ``passed`` seconds after the last look."""
        return (
            self.task.watch.look(self._beats.value, passed, self._used_memory(), warm=self._is_warm(self.task.job))
            if self.task
            else None
        )

    def _is_warm(self, job: Job) -> bool:
        """Return whether the process has given a first command with the same components, and has
        compiled nothing for this job.
        """
        return _job_components(job) in self._driven and self.compiled() == self._compiled_before

    def end(self) -> None:
        """End the process and all that it has started, at once, whatever they are at; ``end_strays`` finds
        what has left its parents.
        """
        below = strays.processes_below(self._process.pid)
        if self._process.pid:
            end_group(self._process.pid)
        self._process.kill()
        strays.end_all(below)
        self._process.join(PATIENCE)
        self.connection.close()

    def _used_memory(self) -> int:
        """Return the bytes that the process occupies."""
        try:
            return int(psutil.Process(self._process.pid).memory_info().rss)
        except psutil.Error:  # it has just died
            return 0


def _job_components(job: Job) -> Parts:
    return parts_of(job, job.config)


def _signal_name(number: int) -> str:
    try:
        return signal.Signals(number).name
    except ValueError:
        return f"signal {number}"
