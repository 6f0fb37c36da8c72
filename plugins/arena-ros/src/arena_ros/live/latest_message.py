"""The newest message of a topic and when it came; decoded by who asks, not by the thread that hears."""

from __future__ import annotations

import time
from typing import Any

from arena_ros.codec import BadMessage, Codec
from arena_ros.transport import Transport


class LatestMessage:
    """Hears one topic. ``faults`` counts messages that could not be read."""

    def __init__(self, transport: Transport, codec: Codec, topic: str, type: str, *, latched: bool = False) -> None:
        self.topic, self.type = topic, type
        self._codec = codec
        self._newest: tuple[bytes, float] | None = None
        self._read: tuple[bytes, Any] | None = None
        self.faults = 0
        transport.subscribe(topic, type, self._on_message, latched=latched)

    def _on_message(self, content: bytes) -> None:
        self._newest = content, time.monotonic()

    @property
    def age(self) -> float:
        """Return how long ago the newest message came, s; inf where none did."""
        newest = self._newest
        return float("inf") if newest is None else time.monotonic() - newest[1]

    @property
    def receive_time(self) -> float:
        """Return when the newest message came, s of the monotonic clock; -inf where none did."""
        newest = self._newest
        return float("-inf") if newest is None else newest[1]

    def take(self) -> Any | None:
        """Return the newest message if it is new since the last call, else None."""
        newest = self._newest
        if newest is None or (self._read is not None and self._read[0] is newest[0]):
            return None
        return self.newest()

    def newest(self) -> Any | None:
        """Return the newest message, None where there is none or it cannot be read."""
        newest = self._newest
        if newest is None:
            return None
        if self._read is None or self._read[0] is not newest[0]:
            try:
                self._read = newest[0], self._codec.decode(newest[0], self.type)
            except BadMessage:
                self.faults += 1
                self._read = newest[0], None
        return self._read[1]
