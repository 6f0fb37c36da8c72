"""``arena`` as a process of its own: started without a shell, in a group of its own, found
again after the studio was restarted.
"""

from __future__ import annotations

import errno
import os
import signal
import stat
import subprocess
import sys
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from arena_core import InputFileError

PROGRAM = (sys.executable, "-m", "arena_core.cli.main")
LOG_TAIL = 8_000  # bytes of what a run printed that are shown
# Windows sends Ctrl-Break alone to a group of processes, and has no such flags: links are looked for first
INTERRUPT: int = getattr(signal, "CTRL_BREAK_EVENT", signal.SIGINT)
NEW_GROUP: int = getattr(subprocess, "CREATE_NEW_PROCESS_GROUP", 0)
NO_LINK: int = getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0)
_children: dict[Process, subprocess.Popen[bytes]] = {}


@dataclass(frozen=True, slots=True)
class Process:
    """A process by its number and when it was created: numbers are given again."""

    pid: int
    created: float

    def is_alive(self) -> bool:
        """Return whether it runs; a process that this studio has started runs until its exit status is known."""
        if (child := _children.get(self)) is not None:
            # nothing else: one that is ending has no command line any more, and no exit status yet
            return child.poll() is None
        import psutil

        try:
            found = psutil.Process(self.pid)
            is_same = bool(abs(found.create_time() - self.created) < 1.0)
            return is_same and found.status() != psutil.STATUS_ZOMBIE and PROGRAM[2] in found.cmdline()
        except psutil.Error:
            return False

    def status(self) -> int | None:
        """Return the exit status of a process that this studio has started and that has ended."""
        child = _children.get(self)
        return None if child is None else child.poll()

    def workers(self) -> int:
        """Return how many worker processes it has."""
        import psutil

        try:
            return sum(_is_worker(child) for child in psutil.Process(self.pid).children())
        except psutil.Error:
            return 0

    def interrupt(self) -> None:
        """Send Ctrl-C, as a terminal would: what is finished is kept."""
        if self.is_alive():
            with suppress(OSError):
                os.kill(self.pid, INTERRUPT)


def start_process(words: Sequence[str], folder: Path, log: Path) -> Process:
    """Start ``arena WORDS`` in a folder; what it prints goes to ``log``."""
    import psutil

    log.parent.mkdir(parents=True, exist_ok=True)
    with os.fdopen(_open_log(log, os.O_WRONLY | os.O_APPEND | os.O_CREAT), "ab") as file:
        child = subprocess.Popen(  # noqa: S603 - the words are the composer's, and no shell reads them
            [*PROGRAM, *words],
            cwd=folder,
            stdin=subprocess.DEVNULL,
            stdout=file,
            stderr=subprocess.STDOUT,
            start_new_session=True,
            creationflags=NEW_GROUP,
            env={**os.environ, "PYTHONUNBUFFERED": "1"},
        )
    process = Process(child.pid, psutil.Process(child.pid).create_time())
    _children[process] = child
    return process


def log_tail(log: Path) -> list[str]:
    """Return the last lines of what a run printed."""
    try:
        with os.fdopen(_open_log(log, os.O_RDONLY), "rb") as file:
            size = file.seek(0, os.SEEK_END)
            file.seek(max(0, size - LOG_TAIL))
            return file.read(LOG_TAIL).decode(errors="replace").splitlines()[-40:]
    except (OSError, InputFileError):
        return []


def _open_log(log: Path, flags: int) -> int:
    """Open a log; raise InputFileError for a link, a pipe, or whatever else is no file of the studio's own."""
    try:
        if not NO_LINK and log.is_symlink():
            raise OSError(errno.ELOOP, os.strerror(errno.ELOOP))
        number = os.open(log, flags | NO_LINK, 0o666)
    except OSError as error:
        raise InputFileError(
            f"{log}: cannot be opened ({error.strerror}); allowed: a file that the studio wrote"
        ) from None
    if stat.S_ISREG(os.fstat(number).st_mode):
        return number
    os.close(number)
    raise InputFileError(f"{log}: is no file; allowed: a file that the studio wrote")


def _is_worker(child: object) -> bool:
    import psutil

    try:
        return "spawn_main" in " ".join(child.cmdline())  # type: ignore[attr-defined]
    except psutil.Error:
        return False
