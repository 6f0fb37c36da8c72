"""Messages that a recording holds again: rows that were copied, or a second writer of the same topic."""

from __future__ import annotations

from collections import deque
from hashlib import blake2b

from arena_ros.bags.stream import Channel

APART = 10**9  # ns, within which a second writer writes what the first one wrote


class Repeats:
    """Tells them, of messages in the order of time."""

    def __init__(self) -> None:
        self._stamp = -1
        self._now: set[tuple[Channel, bytes]] = set()  # what has this stamp
        self._late: dict[Channel, deque[tuple[int, int, bytes]]] = {}  # stamp, writer and digest, each written once

    def holds(self, channel: Channel, writer: int, stamp: int, content: bytes) -> bool:
        """Return whether this message was there before: with the same stamp, or from another writer a moment ago."""
        digest = blake2b(content, digest_size=16).digest()
        if stamp != self._stamp:
            self._stamp = stamp
            self._now.clear()
        again = (channel, digest) in self._now or self._is_of_another(channel, writer, stamp, digest)
        self._now.add((channel, digest))
        return again

    def _is_of_another(self, channel: Channel, writer: int, stamp: int, digest: bytes) -> bool:
        late = self._late.setdefault(channel, deque())
        while late and stamp - late[0][0] > APART:
            late.popleft()
        for each in late:
            if each[1] != writer and each[2] == digest:
                late.remove(each)
                return True
        late.append((stamp, writer, digest))
        return False
