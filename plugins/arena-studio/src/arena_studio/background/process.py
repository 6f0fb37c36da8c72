"""A process beside the server that composes, checks and simulates: one request after the other, each within a time."""

from __future__ import annotations

import json
import os
import select
import subprocess
import sys
import threading
import time
from contextlib import suppress
from functools import lru_cache
from pathlib import Path
from typing import Any, NamedTuple

from arena_core import ArenaError
from arena_studio.background.requests import WorkRequest

SOON, LONG = 60.0, 300.0  # s that a request may take; what is used for the first time is compiled
LINE_BYTES = 1 << 20  # read at once
MOST_BYTES = 256 << 20  # of an answer


class SideProcess:
    """Answers requests by the functions that they name, in the folder ``root``; it is started when first asked, and
    again after its end.

    Composing a configuration is not safe among threads, and a planner may do anything: so neither happens in the
    server.
    """

    def __init__(self, root: Path) -> None:
        self._root = root.resolve()
        self._lock = threading.Lock()
        self._process: subprocess.Popen[bytes] | None = None

    def ask(self, request: WorkRequest, within: float) -> Any:
        """Return an answer; raise ArenaError with its line where the work fails or takes longer than ``within`` s."""
        sent = {"request": type(request).__name__, "given": request.model_dump()}
        line = json.dumps(sent).encode() + b"\n"
        with self._lock:
            process = self._running_process()
            try:
                assert process.stdin is not None
                process.stdin.write(line)
                process.stdin.flush()
                answer = _read_line(process, time.monotonic() + within)
            except TimeoutError:
                self._end_process()
                raise ArenaError(
                    f"{request.what} took longer than {within:g} s and was ended; allowed: something smaller"
                ) from None
            except OSError:
                self._end_process()
                raise ArenaError(
                    f"{request.what}: the process that does this ended; the next try starts it again"
                ) from None
        found = json.loads(answer)
        if "error" in found:
            raise ArenaError(str(found["error"]).replace(f"{self._root}{os.sep}", ""))
        return found["answer"]

    def start(self) -> None:
        """Start the process, so that who asks first waits less."""
        with self._lock:
            self._running_process()

    def close(self) -> None:
        """End the process."""
        with self._lock:
            self._end_process()

    def _running_process(self) -> subprocess.Popen[bytes]:
        if self._process is None or self._process.poll() is not None:
            self._end_process()
            command = [sys.executable, "-m", "arena_studio.background.worker"]
            pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "stderr": subprocess.DEVNULL}
            options = {"cwd": self._root, "start_new_session": True, **pipes}
            # this Python, a module of ours
            self._process = subprocess.Popen(command, **options)  # type: ignore[call-overload]  # noqa: S603
        assert self._process is not None
        return self._process

    def _end_process(self) -> None:
        if self._process is None:
            return
        self._process.kill()
        self._process.wait()
        for pipe in (self._process.stdin, self._process.stdout):
            if pipe is not None:
                with suppress(OSError):  # what could not be written to a dead process is lost anyway
                    pipe.close()
        self._process = None


class SideProcesses(NamedTuple):
    """A project's processes: for files, which must be answered at once; for checks and worlds; for what
    simulates; and for composing.
    """

    files: SideProcess
    checks: SideProcess
    long: SideProcess
    runs: SideProcess


@lru_cache(maxsize=16)
def side_processes(root: Path) -> SideProcesses:
    """Return the processes of a project."""
    return SideProcesses(*(SideProcess(root) for _ in SideProcesses._fields))


def _read_line(process: subprocess.Popen[bytes], until: float) -> bytes:
    """Return the next line that a process writes; raise TimeoutError, or OSError where it ended."""
    assert process.stdout is not None
    found = bytearray()
    while not found.endswith(b"\n"):
        ready, _, _ = select.select([process.stdout], [], [], max(until - time.monotonic(), 0.0))
        if not ready:
            raise TimeoutError
        part = os.read(process.stdout.fileno(), LINE_BYTES)
        if not part or len(found) > MOST_BYTES:
            raise OSError
        found += part
    return bytes(found)
