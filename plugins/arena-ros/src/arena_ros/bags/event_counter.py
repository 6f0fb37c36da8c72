"""Topics that count or tell of events: std_msgs of no content, of yes and no, or of whole numbers."""

from __future__ import annotations

from typing import Any

MOST = 1000  # events between two messages; a counter that leaps farther has none


class EventCounter:
    """Tells how many events each message of a topic stands for."""

    def __init__(self) -> None:
        self._before: int | None = None

    def take(self, message: Any, *, settled: bool) -> int:
        """Return the number of events since the message before.

        An empty message is one event, a yes after a no is one, a counter's rise is as many, and one that falls has
        begun again at 0. The first message of the others is one event only where it is ``settled``: one that comes at
        the begin tells of what was before.
        """
        value = getattr(message, "data", None)
        if value is None:
            return 1
        before, self._before = self._before, int(value)
        if before is None:
            return int(settled and value > 0)
        events = int(value) - before if value >= before else max(int(value), 0)
        return events if events <= MOST else 0

    def has_reset(self, message: Any, *, settled: bool) -> bool:
        """Return whether a message tells of a reset: as an event, or as a counter that falls."""
        before = self._before
        events = self.take(message, settled=settled)
        fell = (
            before is not None
            and self._before is not None
            and self._before < before
            and not isinstance(message.data, bool)
        )
        return bool(events) or fell
