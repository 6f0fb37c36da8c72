"""Processes that an episode has begun, and that would outlive its worker: those in a session of their own too."""

from __future__ import annotations

import os
from collections.abc import Collection
from contextlib import suppress
from secrets import token_hex

import psutil

MARK = "ARENA_WORKER"  # the environment variable by which the processes of a worker are known


def new_mark() -> str:
    """Return the mark of one worker."""
    return token_hex(8)


def mark_children(mark: str) -> None:
    """Let the programs that this process starts, and all that these start, bear a mark."""
    os.environ[MARK] = mark


def processes_below(pid: int | None) -> list[psutil.Process]:
    """Return the processes that one has started, and those that they have."""
    try:
        return psutil.Process(pid).children(recursive=True) if pid else []
    except psutil.Error:
        return []


def end_all(processes: Collection[psutil.Process]) -> None:
    """End processes at once."""
    for process in processes:
        with suppress(psutil.Error):
            process.kill()


def end_strays(marks: Collection[str]) -> None:
    """End all processes that bear one of these marks; those whose environment cannot be read are others'."""
    if marks:
        end_all([process for process in psutil.process_iter() if _mark_of(process) in marks])


def _mark_of(process: psutil.Process) -> str | None:
    try:
        found: str | None = process.environ().get(MARK)
    except (psutil.Error, OSError):
        return None
    return found
