"""A worker process, from within: it runs one job after the other, and ends with its parent, however that went."""

from __future__ import annotations

import os
import pickle
import signal
import sys
from contextlib import suppress
from multiprocessing.connection import Connection
from threading import Thread
from typing import Any

from arena_core.base.errors import RunStopped, describe_error
from arena_core.base.portability import (
    STOPPING,
    adopt_orphans,
    call_in_forks,
    die_with_parent,
    lead_group,
    let_in,
    wait_for_parent,
)
from arena_core.base.pulse import Cell, pulse
from arena_core.runs.workers.messages import send_message
from arena_core.runs.workers.process_state import ProcessState
from arena_core.runs.workers.strays import mark_children


def serve_jobs(connection: Connection, mark: bytes, cells: tuple[Cell, Cell], parent: int, children: str) -> None:
    """Answer every (work, job) that comes with (result, error, whether this process is as it was before), until nothing
    comes any more.

    Answers bear ``mark``, and what the process starts bears ``children``. A process that an episode has changed is not
    used again: the supervisor puts a new one in its place.
    """
    _prepare_process(parent)
    mark_children(children)
    pulse.share(*cells)
    call_in_forks(_be_a_child)
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
    for number in STOPPING:  # a terminal or a scheduler may send them to workers too
        signal.signal(number, signal.SIG_IGN)
    let_in(STOPPING)
    lead_group()
    adopt_orphans()
    die_with_parent()
    Thread(target=_follow_parent, args=(parent,), daemon=True).start()
    if os.getppid() != parent:
        os._exit(1)


def _follow_parent(parent: int) -> None:
    wait_for_parent(parent)
    os._exit(1)


def _be_a_child() -> None:
    pulse.detach()
    die_with_parent()


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
