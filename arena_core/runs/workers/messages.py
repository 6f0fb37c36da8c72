"""Messages of a worker to its supervisor, over a pipe that foreign code in the worker may write to as well.

Each message begins with a mark that only the two know. What is no message is skipped, and half a message keeps no one
waiting.
"""

from __future__ import annotations

import os
import pickle
import struct
from secrets import token_bytes
from typing import Any, Protocol

from arena_core.base.portability import PORTABLE

LENGTH = struct.Struct("!Q")
MARK = 16  # bytes
PART = 2**16  # bytes read at a time
LONGEST = 2**28  # bytes of one message: a row and its job take some ten thousand


class Pipe(Protocol):
    """One end of a pipe as ``multiprocessing`` makes it, whatever the system calls its class."""

    def fileno(self) -> int:
        """Return its descriptor, where pipes are files."""

    def poll(self) -> bool:
        """Return whether something can be read."""

    def recv_bytes(self) -> bytes:
        """Return the next message."""

    def send_bytes(self, buf: bytes) -> None:
        """Send a message whole."""


def new_mark() -> bytes:
    """Return a mark for one worker's messages."""
    return token_bytes(MARK)


def send_message(connection: Pipe, mark: bytes, value: Any) -> None:
    """Send a value; raise OSError where no one reads any more."""
    content = pickle.dumps(value)
    message = mark + LENGTH.pack(len(content)) + content
    if PORTABLE:
        connection.send_bytes(message)
        return
    left = memoryview(message)
    while left:
        left = left[os.write(connection.fileno(), left) :]


class Inbox:
    """What a worker has sent so far, as its supervisor reads it, which never waits."""

    def __init__(self, connection: Pipe, mark: bytes) -> None:
        self._connection, self._mark = connection, mark
        self._read = bytearray()

    def take(self) -> Any:
        """Return the next value that is there whole, None if none is; raise EOFError once the pipe is closed."""
        while (content := self._take_message()) is None:
            if not self._connection.poll():
                return None
            self._read += self._read_part()
        return pickle.loads(content)  # noqa: S301 - it has the worker's mark

    def _read_part(self) -> bytes:
        if PORTABLE:  # Windows keeps messages whole itself, and its pipes are no files
            return self._connection.recv_bytes()
        if part := os.read(self._connection.fileno(), PART):
            return part
        raise EOFError

    def _take_message(self) -> bytes | None:
        """Take the next whole message out of what was read."""
        begin = self._read.find(self._mark)
        del self._read[: begin if begin >= 0 else max(0, len(self._read) - MARK + 1)]
        if begin < 0 or len(self._read) < MARK + LENGTH.size:
            return None
        length = LENGTH.unpack_from(self._read, MARK)[0]
        if length > LONGEST:
            raise ValueError(f"a message of {length} bytes")
        end = MARK + LENGTH.size + length
        if len(self._read) < end:
            return None
        content = bytes(self._read[MARK + LENGTH.size : end])
        del self._read[:end]
        return content
