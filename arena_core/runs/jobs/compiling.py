"""Compilation: said while it happens, and left to one worker at a time, whose kernels the others then find on disk.

While that one has the simulator compiled, others can have what they will need of the robots' brains compiled: that is a
rehearsal.
"""

from __future__ import annotations

import sys
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping
from importlib import import_module
from itertools import count
from typing import Any

from arena_core.base.notices import activity, print_notice
from arena_core.contracts.running import Job
from arena_core.runs.jobs.benchmark import BRAIN

NAVIGATOR = (*BRAIN, "planner")
COMPILED = ("simulator", "pedestrians", *NAVIGATOR)  # kinds with kernels
NOTICE = "compiling kernels for this machine; this happens once and can take minutes"
MANY = 5  # kernels; fewer are compiled within a second or two, and nothing is said
Parts = tuple[str, ...]
Waiting = deque[tuple[Job, int]]

_told: list[Callable[[], None]] = []


def announce_compilation(compiled: Callable[[], None]) -> None:
    """Have ``compiled`` called for every kernel that numba begins to compile in this process, if anything has imported
    numba; ``activity`` names it.
    """
    if "numba" not in sys.modules or compiled in _told:
        return
    event = import_module("numba.core.event")

    class Listener(event.Listener):  # type: ignore[misc, name-defined]
        def __init__(self) -> None:
            self._depth = 0  # a kernel compiles those that it calls

        def on_start(self, event: Any) -> None:
            self._depth += 1
            kernel = event.data["dispatcher"].py_func
            package = kernel.__module__.partition(".")[0]
            if package != "numba":
                activity.doing = f"compiling {package}: {kernel.__name__}"
            compiled()

        def on_end(self, event: Any) -> None:
            self._depth -= 1
            if self._depth == 0:
                activity.doing = ""

    event.register("numba:compile", Listener())
    _told.append(compiled)


def announce_compiling() -> None:
    """Say it, once, when this process has begun to compile more than a few kernels; of no use
    before numba is imported.
    """
    kernels = count(1)

    def compiled() -> None:
        if next(kernels) == MANY:
            print_notice(NOTICE)

    announce_compilation(compiled)


class Turns:
    """Whose turn it is: the first command with each combination of parts is given by one worker, and by one at a time.

    While that builds, loads or compiles, the others take up jobs with what has been driven before, or wait.
    """

    def __init__(self) -> None:
        self._driven: set[Parts] = {()}  # nothing to compile
        self._new: dict[Parts, Job] = {}
        self._rehearsed: set[Parts] = set()
        self._leader: tuple[object, Parts] | None = None

    @property
    def leader(self) -> object | None:
        """The worker that has something new to drive and has not given its first command."""
        return self._leader and self._leader[0]

    def expect(self, jobs: Iterable[Job]) -> None:
        """Take in what will be asked for; no one is at anything yet."""
        self._new = {}
        self._leader = None
        self.expect_more(jobs)

    def expect_more(self, jobs: Iterable[Job]) -> None:
        """Take in what will be asked for besides."""
        for job in jobs:
            if (parts := parts_of(job)) not in self._driven:
                self._new.setdefault(parts, job)

    def rehearsal(self) -> Job | None:
        """Return a job whose brain an idle worker can have compiled meanwhile, the leader's first; each brain once."""
        if self._leader is None:
            return None
        for job in (self._new[self._leader[1]], *self._new.values()):
            if (brain := parts_of(job, NAVIGATOR)) not in self._rehearsed:
                self._rehearsed.add(brain)
                return job
        return None

    def take(self, worker: object, waiting: Waiting) -> tuple[Job, int] | None:
        """Take a worker's next job, and the how manieth attempt at it, out of ``waiting``; None
        where it has to wait itself.
        """
        if not waiting or not self._new:
            return waiting.popleft() if waiting else None
        free = self._leader is None
        found = next((item for item in waiting if (parts_of(item[0]) in self._new) == free), None)
        if found is not None:
            waiting.remove(found)
            self._leader = (worker, parts_of(found[0])) if free else self._leader
        return found or (waiting.popleft() if free else None)

    def given(self, worker: object) -> None:
        """Take in that a worker has given its job's first command, or never will."""
        if self._leader is not None and self._leader[0] == worker:
            self._driven.add(self._leader[1])
            self._new.pop(self._leader[1], None)
            self._leader = None


def parts_of(job: Job, kinds: Iterable[str] = COMPILED) -> Parts:
    """Return the names of the components that may have to be compiled for a job, those within others too."""
    return tuple(name for kind in kinds for name in _component_names(job.config.get(kind)))


def _component_names(node: Any) -> Iterator[str]:
    if isinstance(node, Mapping):
        if "name" in node:
            yield str(node["name"])
        for value in node.values():
            yield from _component_names(value)
