"""Ctrl-C between control steps, not within one.

A KeyboardInterrupt may come up anywhere. Where a compiled kernel takes its arguments it ends the process (a fault of numba with named
tuples), and where a library closes a file half-written it turns into another exception, so that an interrupted episode would look
like a failed one. While an episode runs, Ctrl-C is therefore noted, and raised between two control steps.
"""

from __future__ import annotations

import signal
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType


class Interrupts:
    """What became of Ctrl-C in this process; signals are the process's, so there is one object of this class."""

    def __init__(self) -> None:
        self._came = False
        self._held = False

    @contextmanager
    def heard(self) -> Iterator[None]:
        """Take Ctrl-C over from Python within the block, if Python has it; nothing changes in a worker that ignores it."""
        usual = signal.getsignal(signal.SIGINT)
        try:
            if usual is signal.default_int_handler:
                signal.signal(signal.SIGINT, self._take)
        except ValueError:  # not in the main thread, where no signal arrives
            usual = None
        try:
            yield
        finally:
            self._came = False
            if usual is signal.default_int_handler:
                signal.signal(signal.SIGINT, usual)

    @contextmanager
    def held(self) -> Iterator[None]:
        """Only note the first Ctrl-C within the block, for ``check``; a second one is raised at once."""
        self._held = True
        try:
            yield
        finally:
            self._held = False

    def check(self) -> None:
        """Raise KeyboardInterrupt if Ctrl-C came."""
        if self._came:
            raise KeyboardInterrupt

    def _take(self, signum: int, frame: FrameType | None) -> None:
        waits = self._held and not self._came
        self._came = True
        if not waits:
            raise KeyboardInterrupt


interrupts = Interrupts()
