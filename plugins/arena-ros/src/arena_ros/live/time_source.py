"""The clock that a drive lives by: the wall's, or that of ``/clock``, which may stand still while others think."""

from __future__ import annotations

import threading
import time
from abc import ABC, abstractmethod
from typing import Any

from arena_ros import conversions as to
from arena_ros.codec import BadMessage, get_codec, stamp_of
from arena_ros.transport import Transport

LOOK = 0.05  # s of wall time between two looks whether a drive is over, while a clock stands
SLACK = 1e-3  # s by which a step may come early: stamps are whole nanoseconds, periods are not


class TimeSource(ABC):
    """Seconds since some moment."""

    @abstractmethod
    def now(self) -> float:
        """Return the time, s."""

    @abstractmethod
    def wait(self, due: float) -> bool:
        """Wait until a time has come, or for a while; return whether it has."""

    @abstractmethod
    def measured(self, message: Any, received: float) -> float:
        """Return when a message counts as measured, s: it has a header, and was ``received`` at a time of the wall."""

    @abstractmethod
    def next_due(self, due: float, period: float) -> float:
        """Return when the step after that of ``due`` is due, now that this one begins."""


class WallTime(TimeSource):
    """The monotonic clock; messages count from when they come, so that other clocks may differ and jump."""

    def now(self) -> float:
        """Return the time, s."""
        return time.monotonic()

    def wait(self, due: float) -> bool:
        """Wait until a time has come."""
        time.sleep(max(due - time.monotonic(), 0.0))
        return True

    def measured(self, message: Any, received: float) -> float:
        """Return when a message came."""
        return received

    def next_due(self, due: float, period: float) -> float:
        """Return one period later; steps that were missed are left out."""
        return max(due + period, time.monotonic()) if time.monotonic() - due > period else due + period


class RosTime(TimeSource):
    """The clock of a simulator; messages count from their stamps.

    Where each command answers a step, ``answered`` is the stamp of the last one, ns: no second step is due at it.
    """

    def __init__(self, transport: Transport) -> None:
        self._codec, self._now, self._came = get_codec(transport.ros), 0.0, threading.Condition()
        self.stamp, self.answered = 0, -1
        transport.subscribe("/clock", to.CLOCK, self._on_clock)

    def _on_clock(self, content: bytes) -> None:
        try:
            stamp = stamp_of(self._codec.decode(content, to.CLOCK).clock)
        except BadMessage:
            return
        with self._came:
            self.stamp, self._now = stamp, stamp * 1e-9
            self._came.notify_all()

    def now(self) -> float:
        """Return the time, s; 0 before the first message."""
        return self._now

    def wait(self, due: float) -> bool:
        """Wait until a time has come, or for a while of the wall's."""
        with self._came:
            return self._came.wait_for(lambda: self._now >= due - SLACK and self.stamp != self.answered, LOOK)

    def measured(self, message: Any, received: float) -> float:
        """Return a message's stamp, s."""
        return stamp_of(message.header.stamp) * 1e-9

    def next_due(self, due: float, period: float) -> float:
        """Return one period later, from now on where steps were missed."""
        return (self._now if self._now - due > period else due) + period
