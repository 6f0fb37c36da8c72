"""MCAP files of ROS 1 and ROS 2 (mcap.dev/spec), read record by record: a summary is not needed, nor an
end, nor the order of time.
"""

from __future__ import annotations

import struct
from collections.abc import Collection, Iterator
from functools import partial
from io import BytesIO
from pathlib import Path
from typing import IO

from arena_core import InputFileError
from arena_ros.bags.decompression import UnpackLimit, unpack_lz4, unpack_zstd
from arena_ros.bags.stream import (
    LARGEST_CHUNK,
    LARGEST_RECORD,
    MOST_PIECES,
    Bag,
    Channel,
    Message,
    Piece,
    TruncatedBag,
    by_time,
    ros2_type_name,
)
from arena_ros.codec import Ros

MAGIC = b"\x89MCAP0\r\n"
FOOTER, SCHEMA, CHANNEL, MESSAGE, CHUNK, STATISTICS, DATA_END = 2, 3, 4, 5, 6, 11, 15
HEAD = struct.Struct("<BQ")
LEAST = {CHUNK: 40, MESSAGE: 22}  # bytes that are always there
FOOTER_BYTES = 9 + 20 + len(MAGIC)
LOOSE = 2**20  # bytes of records outside of chunks that are read as one piece
ENCODINGS: dict[str, Ros] = {"cdr": 2, "ros1": 1}
FAULTS = (KeyError, struct.error, ValueError)


class Mcap(Bag):
    """A ``.mcap``."""

    def __init__(self, path: Path, name: Path | None = None) -> None:
        super().__init__(path, name)
        self._known: _KnownChannels | None = None

    def channels(self) -> dict[Channel, int]:
        """Return the channels from the summary; from all of the file where it has none."""
        with self.path.open("rb") as file:
            _check_magic(file, self.name)
            try:
                known, counts = _read_summary(file)
            except (TruncatedBag, OSError, *FAULTS):
                known, counts = _KnownChannels(), {}
        counted = {} if known.channels else self.count_messages()
        self._known = known = known if known.channels or self._known is None else self._known
        if known.channels and not any(known.channels.values()):
            raise InputFileError(
                f"{self.name}: its messages are encoded as {known.encodings()}; allowed: cdr (ROS 2) and ros1"
            )
        found = counted
        for number, channel in known.channels.items() if not counted else ():
            if channel is not None:
                found[channel] = found.get(channel, 0) + counts.get(number, 1)
        return found

    def read(self, topics: Collection[str], *, in_time: bool) -> Iterator[Message]:
        """Yield the messages of these topics, of all where there are none; raise Cut where the file ends early."""
        if in_time and self._known is None:
            self.channels()  # a channel may be told of in a chunk that lies later in the file than in time
        known = self._known or _KnownChannels()
        known.allowance = UnpackLimit(self.path)
        with self.path.open("rb") as file:
            _check_magic(file, self.name)
            pieces, cut = _find_pieces(file, known, topics)
            self._known = known
            if in_time:
                yield from by_time(pieces)
            else:
                for piece in pieces:
                    yield from piece.read()
        if cut:
            raise TruncatedBag(cut)


class _KnownChannels:
    """Schemas and channels that have come so far; None stands for a channel in another encoding than those of ROS."""

    def __init__(self) -> None:
        self.schemas: dict[int, str] = {0: ""}
        self.channels: dict[int, Channel | None] = {}
        self.allowance: UnpackLimit | None = None
        self._others: set[str] = set()

    def encodings(self) -> str:
        return ", ".join(sorted(self._others)) or "nothing"

    def take(self, kind: int, data: bytes, topics: Collection[str]) -> Iterator[Message]:
        if kind == MESSAGE:
            number, _, stamp, _ = struct.unpack_from("<HIQQ", data)
            channel = self.channels[number]
            if channel is not None and (not topics or channel.topic in topics):
                content = data[22:]
                yield (
                    channel,
                    stamp,
                    self.allowance.message(content) if self.allowance and channel.ros == 2 else content,
                )
        elif kind == SCHEMA:
            self.schemas[struct.unpack_from("<H", data)[0]] = ros2_type_name(_read_text(data, 2)[0])
        elif kind == CHANNEL:
            number, schema = struct.unpack_from("<HH", data)
            topic, at = _read_text(data, 4)
            encoding, _ = _read_text(data, at)
            ros = ENCODINGS.get(encoding)
            self.channels[number] = Channel(topic, self.schemas[schema], ros) if ros else None
            self._others |= set() if ros else {encoding[:20]}


def _check_magic(file: IO[bytes], path: Path) -> None:
    if file.read(len(MAGIC)) != MAGIC:
        raise InputFileError(f"{path}: is no MCAP file; allowed: what `ros2 bag record -s mcap` wrote")


def _read_summary(file: IO[bytes]) -> tuple[_KnownChannels, dict[int, int]]:
    """Return what the summary says of channels, and the numbers of their messages."""
    file.seek(-FOOTER_BYTES, 2)
    end = file.read(FOOTER_BYTES)
    start = struct.unpack_from("<Q", end, 9)[0] if end.endswith(MAGIC) and end[0] == FOOTER else 0
    known, counts = _KnownChannels(), dict[int, int]()
    file.seek(start)
    while start:
        kind, data = _read_record(file)
        if kind == FOOTER:
            break
        if kind == STATISTICS:
            counts = dict(struct.iter_unpack("<HQ", data[46:]))
        elif kind in (SCHEMA, CHANNEL):
            list(known.take(kind, data, ()))
    return known, counts


def _find_pieces(file: IO[bytes], known: _KnownChannels, topics: Collection[str]) -> tuple[list[Piece], str]:
    """Return the chunks of a file, and what lies between them, by their heads alone; and why it ends early."""
    size, found, loose, first = file.seek(0, 2), list[Piece](), len(MAGIC), 0
    at = file.seek(loose)

    def close(end: int) -> None:
        if end > loose:
            found.append(Piece(first, partial(_read_loose, file, loose, end, known, topics)))

    while True:
        head = file.read(25)
        if len(head) < HEAD.size:
            close(at)
            return found, "it ends within a record" if head else "it was never closed"
        kind, length = HEAD.unpack_from(head)
        end = at + HEAD.size + length
        if (
            why := _end_reason(kind, length, beyond=end > size)
            if len(found) < MOST_PIECES
            else f"more than {MOST_PIECES} chunks"
        ):
            close(at)
            return found, why.strip()
        if kind == CHUNK or end - loose > LOOSE:
            close(at)
            loose, first = at, 0
        if kind == CHUNK:
            found.append(Piece(struct.unpack_from("<Q", head, 9)[0], partial(_read_chunk, file, at, known, topics)))
            loose = end
        elif kind == MESSAGE:
            stamp = struct.unpack_from("<Q", head, 15)[0]
            first = min(first, stamp) if first else stamp
        at = file.seek(end)


def _end_reason(kind: int, length: int, *, beyond: bool) -> str:
    """Return why a file is read no farther than to a record, a blank where that ends it, nothing where it goes on."""
    if kind in (DATA_END, FOOTER):
        return " "
    if beyond:
        return "it ends within a record"
    if kind in (CHUNK, MESSAGE) and not LEAST[kind] <= length <= LARGEST_RECORD:
        return f"a record of {length} bytes; allowed: up to {LARGEST_RECORD}"
    return ""


def _read_loose(
    file: IO[bytes], begin: int, end: int, known: _KnownChannels, topics: Collection[str]
) -> Iterator[Message]:
    try:
        file.seek(begin)
        while (at := file.tell()) < end:
            kind, length = HEAD.unpack(file.read(HEAD.size))
            if kind in (SCHEMA, CHANNEL, MESSAGE):
                file.seek(at)
                yield from known.take(*_read_record(file), topics)
            file.seek(at + HEAD.size + length)
    except FAULTS as error:
        raise TruncatedBag(f"a damaged record at byte {file.tell()} ({type(error).__name__})") from None


def _read_chunk(file: IO[bytes], begin: int, known: _KnownChannels, topics: Collection[str]) -> Iterator[Message]:
    file.seek(begin)
    try:
        content = BytesIO(_unpack_chunk(_read_record(file)[1], known.allowance))
        end = len(content.getbuffer())
        while content.tell() < end:
            kind, data = _read_record(content)
            if kind == 0:
                raise TruncatedBag(f"a damaged chunk at byte {begin}")
            yield from known.take(kind, data, topics)
    except FAULTS as error:
        raise TruncatedBag(f"a damaged chunk at byte {begin} ({type(error).__name__})") from None


def _unpack_chunk(data: bytes, allowance: UnpackLimit | None) -> bytes:
    size = struct.unpack_from("<Q", data, 16)[0]
    compression, at = _read_text(data, 28)
    packed = data[at + 8 :]
    if size > LARGEST_CHUNK:
        raise TruncatedBag(f"a chunk of {size} bytes; allowed: up to {LARGEST_CHUNK}")
    if not compression:
        return packed
    if allowance is not None:
        allowance.take(size)
    if compression == "lz4":
        return unpack_lz4(packed, size)
    if compression == "zstd":
        return unpack_zstd(packed, size)
    raise TruncatedBag(f"chunks are compressed by {compression[:20]!r}; allowed: lz4, zstd")


def _read_record(file: IO[bytes]) -> tuple[int, bytes]:
    head = file.read(HEAD.size)
    if len(head) < HEAD.size:
        raise TruncatedBag("it ends within a record")
    kind, size = HEAD.unpack(head)
    if size > LARGEST_RECORD:
        raise TruncatedBag(f"a record of {size} bytes; allowed: up to {LARGEST_RECORD}")
    data = file.read(size)
    if len(data) < size:
        raise TruncatedBag("it ends within a record")
    return kind, data


def _read_text(data: bytes, at: int) -> tuple[str, int]:
    size = struct.unpack_from("<I", data, at)[0]
    return data[at + 4 : at + 4 + size].decode(errors="replace"), at + 4 + size
