"""What POSIX or Linux alone can do, in one place; on other systems each function does what can be done without.

The environment variable ``ARENA_PORTABLE`` (1) takes these other ways on any system: so Linux tries what Windows does.
"""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from time import sleep
from typing import Any

PORTABLE = os.name != "posix" or os.environ.get("ARENA_PORTABLE", "0") not in ("", "0")
PARENT_ASKED_EVERY = 1.0  # s
# linux/prctl.h
_PR_SET_PDEATHSIG = 1
_PR_SET_CHILD_SUBREAPER = 36


def known_signals(*names: str) -> tuple[signal.Signals, ...]:
    """Return those of some signals that this system has."""
    return tuple(getattr(signal, name) for name in names if hasattr(signal, name))


# that a terminal or a scheduler ends a program with
STOPPING = known_signals("SIGINT", "SIGTERM", "SIGHUP", "SIGBREAK")


@contextmanager
def kept_from_children(signals: Sequence[signal.Signals]) -> Iterator[None]:
    """Keep signals from processes that begin within the block, until they call ``let_in``; nothing elsewhere."""
    if sys.platform == "win32" or PORTABLE:
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, signals)
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def let_in(signals: Sequence[signal.Signals]) -> None:
    """Take signals that were kept from this process."""
    if sys.platform != "win32" and not PORTABLE:
        signal.pthread_sigmask(signal.SIG_UNBLOCK, signals)


def lead_group() -> None:
    """Let this process lead a group of its own, to be ended with all its children; nothing elsewhere."""
    if sys.platform != "win32" and not PORTABLE:
        os.setpgid(0, 0)


def end_group(leader: int) -> None:
    """End a process and its group at once, where there are groups and it still lives."""
    if sys.platform != "win32" and not PORTABLE:
        with suppress(OSError):
            os.killpg(leader, signal.SIGKILL)


def call_in_forks(function: Callable[[], object]) -> None:
    """Call a function in every process that this one forks, where there are forks."""
    if sys.platform != "win32" and not PORTABLE:
        os.register_at_fork(after_in_child=function)


def die_with_parent() -> None:
    """Have the kernel end this process with its parent, where it can; ``wait_for_parent`` does it elsewhere, unless
    compiled code hangs.
    """
    if sys.platform == "linux" and not PORTABLE:
        _control_process(_PR_SET_PDEATHSIG, signal.SIGKILL)


def adopt_orphans() -> None:
    """Have the kernel hand over to this process what its children leave, so that it stays below it, where the kernel
    can.
    """
    if sys.platform == "linux" and not PORTABLE:
        _control_process(_PR_SET_CHILD_SUBREAPER, 1)


def wait_for_parent(parent: int) -> None:
    """Return when the process that spawned this one is gone."""
    if sys.platform != "win32" and not PORTABLE:
        while os.getppid() == parent:
            sleep(PARENT_ASKED_EVERY)
        return
    from multiprocessing import parent_process

    if (found := parent_process()) is not None:
        found.join()  # the number of a parent that is gone stays what it was


def process_settings() -> tuple[Any, ...]:
    """Return the limits, priority, timers and masks of this process, to be compared; what this system has of them."""
    if sys.platform == "win32" or PORTABLE:
        return ()
    import resource

    limits = [getattr(resource, name) for name in dir(resource) if name.startswith("RLIMIT_")]
    return (
        signal.pthread_sigmask(signal.SIG_BLOCK, ()),
        signal.getitimer(signal.ITIMER_REAL)[0] > 0.0,
        [resource.getrlimit(limit) for limit in limits],
        os.getpriority(os.PRIO_PROCESS, 0),
        frozenset(os.sched_getaffinity(0)) if sys.platform == "linux" else frozenset(),
    )


def most_open_files() -> int:
    """Return how many descriptors this process may have open; a number beyond all where the system does not say."""
    if sys.platform == "win32" or PORTABLE:
        return sys.maxsize
    import resource

    return resource.getrlimit(resource.RLIMIT_NOFILE)[0]


def let_others_read(descriptor: int) -> None:
    """Give a file of this program's the usual rights: all may read it, its owner may write it."""
    if sys.platform != "win32" and not PORTABLE:
        os.fchmod(descriptor, 0o644)


def _control_process(option: int, value: int) -> None:
    import ctypes

    ctypes.CDLL(None).prctl(option, value)
