"""Bags of ROS 1, format 2.0 (wiki.ros.org/Bags/Format/2.0), read record by record: an index is not needed, nor an end."""

from __future__ import annotations

import bz2
import struct
from collections.abc import Collection, Iterator
from io import BytesIO
from typing import IO, ClassVar

from arena_core import InputFileError
from arena_ros.bags.stream import LARGEST_CHUNK, LARGEST_RECORD, Bag, Channel, Cut, normalised
from arena_ros.codec import Ros

MAGIC = b"#ROSBAG V2.0\n"
MESSAGE, BAG_HEADER, CHUNK, CHUNK_INFO, CONNECTION = 2, 3, 5, 6, 7
UINT32 = struct.Struct("<I")
Fields = dict[bytes, bytes]


class Ros1Bag(Bag):
    """A ``.bag``."""

    ros: ClassVar[Ros] = 1

    def channels(self) -> dict[Channel, int]:
        """Return the channels from the index; from all of the bag where it has none, as one that was cut off."""
        with self.path.open("rb") as file:
            _begin(file, self)
            try:
                fields = _record(file)[0]
                found = self._indexed(file, fields)
            except (Cut, KeyError, struct.error):
                found = {}
        return found or self._counted()

    def _indexed(self, file: IO[bytes], header: Fields) -> dict[Channel, int]:
        position = struct.unpack("<Q", header[b"index_pos"])[0]
        if not position:
            return {}
        file.seek(position)
        connections: dict[int, Channel] = {}
        counts: dict[int, int] = {}
        while (record := _next(file)) is not None:
            fields, data = record
            if fields[b"op"][0] == CONNECTION:
                connections[_uint32(fields, b"conn")] = _channel(fields, data)
            elif fields[b"op"][0] == CHUNK_INFO:
                for connection, count in struct.iter_unpack("<II", data):
                    counts[connection] = counts.get(connection, 0) + count
        found: dict[Channel, int] = {}
        for number, channel in connections.items():
            found[channel] = found.get(channel, 0) + counts.get(number, 0)
        return found

    def _counted(self) -> dict[Channel, int]:
        found: dict[Channel, int] = {}
        try:
            for channel, _, _ in self.read(()):
                found[channel] = found.get(channel, 0) + 1
        except Cut:
            pass
        return found

    def read(self, topics: Collection[str]) -> Iterator[tuple[Channel, int, bytes]]:
        """Yield the messages of these topics, of all where there are none; raise Cut where the bag ends early."""
        connections: dict[int, Channel] = {}
        with self.path.open("rb") as file:
            _begin(file, self)
            try:
                complete = _uint64(_record(file)[0], b"index_pos") != 0
                while (record := _next(file)) is not None:
                    fields, data = record
                    if fields[b"op"][0] == CHUNK:
                        yield from _messages(BytesIO(_unpacked(fields, data)), connections, topics)
                    elif fields[b"op"][0] == CONNECTION:
                        connections[_uint32(fields, b"conn")] = _channel(fields, data)
                    elif fields[b"op"][0] == MESSAGE:
                        yield from _messages_of(fields, data, connections, topics)
            except (KeyError, struct.error, IndexError, ValueError) as error:
                raise Cut(f"a damaged record at byte {file.tell()} ({type(error).__name__})") from None
        if not complete:
            raise Cut("it was never closed")


def _begin(file: IO[bytes], bag: Bag) -> None:
    if file.read(len(MAGIC)) != MAGIC:
        raise InputFileError(f"{bag.path}: is no bag of ROS 1, version 2.0; allowed: what `rosbag record` wrote")


def _messages(file: IO[bytes], connections: dict[int, Channel], topics: Collection[str]) -> Iterator[tuple[Channel, int, bytes]]:
    while (record := _next(file)) is not None:
        fields, data = record
        if fields[b"op"][0] == CONNECTION:
            connections[_uint32(fields, b"conn")] = _channel(fields, data)
        elif fields[b"op"][0] == MESSAGE:
            yield from _messages_of(fields, data, connections, topics)


def _messages_of(
    fields: Fields, data: bytes, connections: dict[int, Channel], topics: Collection[str]
) -> Iterator[tuple[Channel, int, bytes]]:
    channel = connections[_uint32(fields, b"conn")]
    if not topics or channel.topic in topics:
        seconds, nanoseconds = struct.unpack("<II", fields[b"time"])
        yield channel, seconds * 10**9 + nanoseconds, data


def _unpacked(fields: Fields, data: bytes) -> bytes:
    """Return the content of a chunk."""
    size, compression = _uint32(fields, b"size"), fields[b"compression"]
    if size > LARGEST_CHUNK:
        raise Cut(f"a chunk of {size} bytes; allowed: up to {LARGEST_CHUNK}")
    if compression == b"none":
        return data
    try:
        if compression == b"bz2":
            return bz2.BZ2Decompressor().decompress(data, size)
        if compression == b"lz4":
            from lz4.frame import LZ4FrameDecompressor

            return bytes(LZ4FrameDecompressor().decompress(data, size))
    except (OSError, RuntimeError, EOFError) as error:
        raise Cut(f"a damaged chunk ({type(error).__name__})") from None
    raise Cut(f"chunks are compressed by {compression!r}; allowed: none, bz2, lz4")


def _channel(fields: Fields, data: bytes) -> Channel:
    own = _fields(data)
    topic = fields[b"topic"].decode(errors="replace")
    definition = own[b"message_definition"].decode(errors="replace")
    return Channel("/" + "/".join(part for part in topic.split("/") if part), normalised(own[b"type"].decode(errors="replace")), definition)


def _next(file: IO[bytes]) -> tuple[Fields, bytes] | None:
    """Return the next record, None at the end; raise Cut within one."""
    begun = file.read(4)
    if not begun:
        return None
    return _record(file, begun)


def _record(file: IO[bytes], begun: bytes = b"") -> tuple[Fields, bytes]:
    fields = _fields(_sized(file, begun or file.read(4)))
    return fields, _sized(file, file.read(4))


def _sized(file: IO[bytes], length: bytes) -> bytes:
    if len(length) < 4:
        raise Cut("it ends within a record")
    size = UINT32.unpack(length)[0]
    if size > LARGEST_RECORD:
        raise Cut(f"a record of {size} bytes; allowed: up to {LARGEST_RECORD}")
    data = file.read(size)
    if len(data) < size:
        raise Cut("it ends within a record")
    return data


def _fields(data: bytes) -> Fields:
    fields, at = Fields(), 0
    while at < len(data):
        size = UINT32.unpack_from(data, at)[0]
        name, _, value = data[at + 4 : at + 4 + size].partition(b"=")
        fields[name] = value
        at += 4 + size
    return fields


def _uint32(fields: Fields, name: bytes) -> int:
    return int(UINT32.unpack(fields[name])[0])


def _uint64(fields: Fields, name: bytes) -> int:
    return int(struct.unpack("<Q", fields[name])[0])
