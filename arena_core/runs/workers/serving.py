"""A worker process, from within: it runs one job after the other, and ends with its parent, however that went."""

from __future__ import annotations

import ctypes
import os
import pickle
import signal
import sys
from contextlib import suppress
from multiprocessing.connection import Connection
from threading import Thread
from time import sleep
from typing import Any

from arena_core.base.errors import RunStopped, describe_error
from arena_core.base.pulse import Cell, pulse
from arena_core.runs.workers.messages import send_message
from arena_core.runs.workers.process_state import ProcessState
from arena_core.runs.workers.strays import adopt_orphans, mark_children

PARENT_ASKED_EVERY = 1.0  # s
# a terminal or a scheduler may send them to workers too
LEFT_TO_THE_PARENT = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
_PR_SET_PDEATHSIG = 1  # linux/prctl.h


def serve_jobs(connection: Connection, mark: bytes, cells: tuple[Cell, Cell], parent: int, children: str) -> None:
    """Answer every (work, job) that comes with (result, error, whether this process is as it was before), until nothing
    comes any more.

    Answers bear ``mark``, and what the process starts bears ``children``. A process that an episode has changed is not
    used again: the supervisor puts a new one in its place.
    """
    _prepare_process(parent)
    mark_children(children)
    pulse.share(*cells)
    os.register_at_fork(after_in_child=_be_a_child)
    worker = os.getpid()
    while (task := _receive_job(connection)) is not None:
        pulse.begin()
        before = ProcessState()
        result, error = _run_job(*task)
        if os.getpid() != worker:
            os._exit(0)  # a child that the episode forked has come back from it
        with suppress(Exception):
            sys.stdout.flush()  # what a killed process has not written is lost
        send_message(connection, mark, (result, error, before.is_kept()))
    os._exit(0)


def _prepare_process(parent: int) -> None:
    """Leave signals to the parent, take a process group of its own (to be ended with all
    children), and end when the parent does.
    """
    for number in LEFT_TO_THE_PARENT:
        signal.signal(number, signal.SIG_IGN)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, LEFT_TO_THE_PARENT)
    os.setpgid(0, 0)
    adopt_orphans()
    _die_with_parent()
    Thread(target=_watch_parent, args=(parent,), daemon=True).start()
    if os.getppid() != parent:
        os._exit(1)


def _die_with_parent() -> None:
    """Have the kernel end this process with its parent, where it can; ``_watch_parent`` does it elsewhere,
    unless compiled code hangs.
    """
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)


def _watch_parent(parent: int) -> None:
    while os.getppid() == parent:
        sleep(PARENT_ASKED_EVERY)
    os._exit(1)


def _be_a_child() -> None:
    pulse.detach()
    _die_with_parent()


def _receive_job(connection: Connection) -> tuple[Any, Any] | None:
    try:
        task: tuple[Any, Any] = connection.recv()
    except (EOFError, OSError):
        return None
    return task


def _run_job(work: Any, job: Any) -> tuple[Any, BaseException | None]:
    try:
        return work(job), None
    except BaseException as error:
        return None, _make_portable(error)


def _make_portable(error: BaseException) -> BaseException:
    """Return an exception that survives the way to another process."""
    try:
        pickle.loads(pickle.dumps(error))  # noqa: S301 - made a line above
    except Exception:
        return RunStopped(describe_error(error))
    return error
