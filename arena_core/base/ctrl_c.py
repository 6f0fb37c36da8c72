"""Ctrl-C between control steps, not within one; a scheduler's SIGTERM and a closed terminal's SIGHUP likewise.

A KeyboardInterrupt may come up anywhere. Where a compiled kernel takes its arguments it ends the process (a fault of
numba with named tuples), and where a library closes a file half-written it turns into another exception, so that an
interrupted episode would look like a failed one. While an episode runs, Ctrl-C is therefore noted, and raised between
two control steps.
"""

from __future__ import annotations

import os
import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Any

from arena_core.base.portability import STOPPING

SIGNAL_STATUS = 128  # a shell reports this and the signal's number for a process that a signal ended
# what each does as long as no one has taken it
_TAKEN = {**dict.fromkeys(STOPPING, signal.SIG_DFL), signal.SIGINT: signal.default_int_handler}


class Interrupts:
    """What became of Ctrl-C in this process; signals are the process's, so there is one object of this class."""

    def __init__(self) -> None:
        self._came: list[int] = []
        self._held = False

    @contextmanager
    def heard(self) -> Iterator[None]:
        """Take the signals over within the block, those that no one else has taken or ignores."""
        before = self._take_over()
        try:
            yield
        finally:
            self._came = []
            for number, usual in before.items():
                signal.signal(number, usual)

    @contextmanager
    def held(self) -> Iterator[None]:
        """Only note the first signal within the block, for ``check``; a second one is raised at once."""
        before, self._held = self._held, True
        try:
            yield
        finally:
            self._held = before

    @contextmanager
    def let_go(self) -> Iterator[None]:
        """Raise a signal at once within the block, whatever holds it around: for what
        may take long and breaks nothing.
        """
        before, self._held = self._held, False
        try:
            self.check()
            yield
        finally:
            self._held = before

    def check(self) -> None:
        """Raise KeyboardInterrupt, with the signal's number, if one came."""
        if self._came:
            raise KeyboardInterrupt(self._came[0])

    def raised(self, error: BaseException) -> bool:
        """Return whether an exception is a signal's doing; a planner may raise KeyboardInterrupt too."""
        return isinstance(error, KeyboardInterrupt) and (
            bool(self._came) or signal.getsignal(signal.SIGINT) is signal.default_int_handler
        )

    def _take_over(self) -> dict[signal.Signals, Any]:
        usual: dict[signal.Signals, Callable[..., Any] | int | None] = {}
        try:
            for number, handler in _TAKEN.items():
                if signal.getsignal(number) is handler:
                    usual[number] = signal.signal(number, self._take_signal)
        except ValueError:  # not in the main thread, where no signal arrives
            return {}
        return usual

    def _take_signal(self, signum: int, frame: FrameType | None) -> None:
        """Note the first one where it is held, raise it elsewhere; end at once where even that has not helped."""
        self._came.append(signum)
        if len(self._came) > 2:
            os._exit(SIGNAL_STATUS + signum)
        if not (self._held and len(self._came) == 1):
            raise KeyboardInterrupt(signum)


interrupts = Interrupts()
