"""Bags of ROS 1, format 2.0 (wiki.ros.org/Bags/Format/2.0), read record by record: no index is
needed, no end, no order of time.
"""

from __future__ import annotations

import struct
from collections.abc import Collection, Iterator
from functools import partial
from io import BytesIO
from pathlib import Path
from typing import IO

from arena_core import InputFileError
from arena_ros.bags.decompression import UnpackLimit, unpack_bz2, unpack_lz4
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

MAGIC = b"#ROSBAG V2.0\n"
MESSAGE, INDEX_DATA, CHUNK, CHUNK_INFO, CONNECTION = 2, 4, 5, 6, 7
UINT32 = struct.Struct("<I")
Fields = dict[bytes, bytes]
Connections = dict[int, Channel]
FAULTS = (KeyError, struct.error, IndexError, ValueError)


class Ros1Bag(Bag):
    """A ``.bag``."""

    def __init__(self, path: Path, name: Path | None = None) -> None:
        super().__init__(path, name)
        self._known: Connections | None = None

    def channels(self) -> dict[Channel, int]:
        """Return the channels from the index; from all of the bag where it has none, as one that was cut off."""
        with self.path.open("rb") as file:
            _check_magic(file, self.name)
            try:
                known, counts = _read_index(file, _read_record(file)[0])
            except (TruncatedBag, *FAULTS):
                known, counts = {}, {}
        if not known:
            return self.count_messages()
        self._known = known
        found: dict[Channel, int] = {}
        for number, channel in known.items():
            found[channel] = found.get(channel, 0) + counts.get(number, 0)
        return found

    def read(self, topics: Collection[str], *, in_time: bool) -> Iterator[Message]:
        """Yield the messages of these topics, of all where there are none; raise Cut where the bag ends early."""
        if in_time and self._known is None:
            self.channels()  # a connection may be told of in a chunk that lies later in the file than in time
        known: Connections = dict(self._known or {})
        with self.path.open("rb") as file:
            _check_magic(file, self.name)
            try:
                complete = _uint64_field(_read_record(file)[0], b"index_pos") != 0
            except FAULTS as error:
                raise TruncatedBag(f"a damaged header ({type(error).__name__})") from None
            pieces, cut = _find_pieces(file, known, topics, UnpackLimit(self.path))
            if in_time:
                yield from by_time(pieces)
            else:
                for piece in pieces:
                    yield from piece.read()
        self._known = known
        if cut or not complete:
            raise TruncatedBag(cut or "it was never closed")


def _read_index(file: IO[bytes], header: Fields) -> tuple[Connections, dict[int, int]]:
    """Return the connections that the index at the end names, and the numbers of their messages."""
    position, known, counts = _uint64_field(header, b"index_pos"), Connections(), dict[int, int]()
    if not position:
        return {}, {}
    file.seek(position)
    while (record := _next_record(file)) is not None:
        fields, data = record
        if fields[b"op"][0] == CONNECTION:
            known[_uint32_field(fields, b"conn")] = _make_channel(fields, data)
        elif fields[b"op"][0] == CHUNK_INFO:
            for connection, count in struct.iter_unpack("<II", data):
                counts[connection] = counts.get(connection, 0) + count
    return known, counts


def _find_pieces(
    file: IO[bytes], known: Connections, topics: Collection[str], allowance: UnpackLimit
) -> tuple[list[Piece], str]:
    """Return the chunks of a bag, and messages that lie outside of any, by their heads alone; and why it ends early."""
    size, found = file.seek(0, 2), list[Piece]()
    file.seek(len(MAGIC))
    # chunks since the last index of one: of one that was cut off before its own, it is not known when it begins
    untimed = 0
    try:
        _skip_record(file, size)
        while file.tell() < size:
            if len(found) == MOST_PIECES:
                raise TruncatedBag(f"more than {MOST_PIECES} chunks")
            at = file.tell()
            fields = _parse_fields(_read_sized(file, file.read(4)))
            kind = fields[b"op"][0]
            if kind == CHUNK:
                found.append(Piece(0, partial(_read_chunk, file, at, known, topics, allowance)))
                untimed = 1
                _skip_part(file, size)
            elif kind == INDEX_DATA and untimed:
                found[-1] = _correct_begin(found[-1], _read_sized(file, file.read(4)), alone=bool(untimed == 1))
                untimed += 1
            elif kind in (MESSAGE, CONNECTION):
                untimed = 0
                file.seek(at)
                found.append(
                    Piece(
                        _record_time(fields) if kind == MESSAGE else 0, partial(_read_single, file, at, known, topics)
                    )
                )
                _skip_record(file, size)
            else:
                untimed = 0
                _skip_part(file, size)
    except TruncatedBag as cut:
        return found, str(cut)
    except FAULTS as error:
        return found, f"a damaged record at byte {file.tell()} ({type(error).__name__})"
    return found, ""


def _correct_begin(piece: Piece, index: bytes, *, alone: bool) -> Piece:
    """Return a chunk that begins no later than the messages which its index names."""
    firsts = [seconds * 10**9 + nanoseconds for seconds, nanoseconds, _ in struct.iter_unpack("<III", index)]
    first = min(firsts, default=piece.first)
    return Piece(first if alone else min(first, piece.first), piece.read)


def _skip_record(file: IO[bytes], size: int) -> None:
    """Go behind a record."""
    _skip_part(file, size)
    _skip_part(file, size)


def _skip_part(file: IO[bytes], size: int) -> None:
    """Go behind a part that begins with its length; raise Cut where the file ends before."""
    length = file.read(4)
    if len(length) < 4 or file.tell() + UINT32.unpack(length)[0] > size:
        raise TruncatedBag("it ends within a record")
    file.seek(UINT32.unpack(length)[0], 1)


def _check_magic(file: IO[bytes], path: Path) -> None:
    if file.read(len(MAGIC)) != MAGIC:
        raise InputFileError(f"{path}: is no bag of ROS 1, version 2.0; allowed: what `rosbag record` wrote")


def _read_chunk(
    file: IO[bytes], begin: int, known: Connections, topics: Collection[str], allowance: UnpackLimit
) -> Iterator[Message]:
    file.seek(begin)
    try:
        content = BytesIO(_unpack_chunk(*_read_record(file), allowance))
        while (record := _next_record(content)) is not None:
            yield from _take_record(*record, known, topics)
    except FAULTS as error:
        raise TruncatedBag(f"a damaged chunk at byte {begin} ({type(error).__name__})") from None


def _read_single(file: IO[bytes], begin: int, known: Connections, topics: Collection[str]) -> Iterator[Message]:
    file.seek(begin)
    try:
        yield from _take_record(*_read_record(file), known, topics)
    except FAULTS as error:
        raise TruncatedBag(f"a damaged record at byte {begin} ({type(error).__name__})") from None


def _take_record(fields: Fields, data: bytes, known: Connections, topics: Collection[str]) -> Iterator[Message]:
    """Yield the message of a record, if it is one of these topics; keep what a record says of a connection."""
    if fields[b"op"][0] == CONNECTION:
        known[_uint32_field(fields, b"conn")] = _make_channel(fields, data)
    elif fields[b"op"][0] == MESSAGE:
        channel = known[_uint32_field(fields, b"conn")]
        if not topics or channel.topic in topics:
            yield channel, _record_time(fields), data


def _record_time(fields: Fields) -> int:
    seconds, nanoseconds = struct.unpack("<II", fields[b"time"])
    return int(seconds * 10**9 + nanoseconds)


def _unpack_chunk(fields: Fields, data: bytes, allowance: UnpackLimit) -> bytes:
    """Return the content of a chunk."""
    size, compression = _uint32_field(fields, b"size"), fields[b"compression"]
    if size > LARGEST_CHUNK:
        raise TruncatedBag(f"a chunk of {size} bytes; allowed: up to {LARGEST_CHUNK}")
    if compression == b"none":
        return data
    allowance.take(size)
    if compression == b"bz2":
        return unpack_bz2(data, size)
    if compression == b"lz4":
        return unpack_lz4(data, size)
    raise TruncatedBag(f"chunks are compressed by {compression[:20]!r}; allowed: none, bz2, lz4")


def _make_channel(fields: Fields, data: bytes) -> Channel:
    own = _parse_fields(data)
    topic = fields[b"topic"].decode(errors="replace")
    return Channel(
        "/" + "/".join(part for part in topic.split("/") if part),
        ros2_type_name(own[b"type"].decode(errors="replace")),
        1,
    )


def _next_record(file: IO[bytes]) -> tuple[Fields, bytes] | None:
    """Return the next record, None at the end; raise Cut within one."""
    begun = file.read(4)
    if not begun:
        return None
    return _read_record(file, begun)


def _read_record(file: IO[bytes], begun: bytes = b"") -> tuple[Fields, bytes]:
    fields = _parse_fields(_read_sized(file, begun or file.read(4)))
    return fields, _read_sized(file, file.read(4))


def _read_sized(file: IO[bytes], length: bytes) -> bytes:
    if len(length) < 4:
        raise TruncatedBag("it ends within a record")
    size = UINT32.unpack(length)[0]
    if size > LARGEST_RECORD:
        raise TruncatedBag(f"a record of {size} bytes; allowed: up to {LARGEST_RECORD}")
    data = file.read(size)
    if len(data) < size:
        raise TruncatedBag("it ends within a record")
    return data


def _parse_fields(data: bytes) -> Fields:
    fields, at = Fields(), 0
    while at < len(data):
        size = UINT32.unpack_from(data, at)[0]
        name, _, value = data[at + 4 : at + 4 + size].partition(b"=")
        fields[name] = value
        at += 4 + size
    return fields


def _uint32_field(fields: Fields, name: bytes) -> int:
    return int(UINT32.unpack(fields[name])[0])


def _uint64_field(fields: Fields, name: bytes) -> int:
    return int(struct.unpack("<Q", fields[name])[0])
