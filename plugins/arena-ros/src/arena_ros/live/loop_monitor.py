"""A second pair of eyes in the driver's process: it stops the robot when the control loop
hangs, and sees who else commands it.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from contextlib import suppress
from types import TracebackType

from arena_core import ArenaError

LOOK = 0.02  # s between two looks at the loop
ASK = 0.5  # s between two questions who else publishes


class LoopMonitor:
    """Calls ``stop`` again and again while no command was sent for ``limit`` s, from the first command of a drive to
    its end.

    A planner whose compiled code keeps Python's lock keeps this thread waiting, too: then only a watchdog in another
    process helps.
    """

    def __init__(self, stop: Callable[[], None], limit: float, rivals: Callable[[], list[str]] | None) -> None:
        self._stop, self._limit, self._ask = stop, limit, rivals
        self._sent: float | None = None
        self._over = threading.Event()
        self.rivals: list[str] = []
        watches = [self._watch_loop] + [self._watch_rivals] * (rivals is not None)
        self._threads = [threading.Thread(target=each, daemon=True) for each in watches]

    def note_command(self) -> None:
        """Note that a command was sent."""
        self._sent = time.monotonic()

    def note_standing(self) -> None:
        """Note that the robot stands and nothing more is sent for now."""
        self._sent = None

    def _watch_loop(self) -> None:
        while not self._over.wait(LOOK):
            sent = self._sent
            if sent is not None and time.monotonic() - sent > self._limit:
                self._stop()

    def _watch_rivals(self) -> None:
        while self._ask is not None:
            with suppress(ArenaError):  # a master that does not answer says nothing about rivals
                self.rivals = self._ask()
            if self._over.wait(ASK):
                return

    def __enter__(self) -> LoopMonitor:
        for thread in self._threads:
            thread.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._over.set()
        for thread in self._threads:
            thread.join(1.0)
