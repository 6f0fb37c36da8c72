"""MCAP files of ROS 2 (mcap.dev/spec), read record by record: a summary is not needed, nor an end."""

from __future__ import annotations

import struct
import sys
from collections.abc import Collection, Iterator
from io import BytesIO
from typing import IO, ClassVar

from arena_core import InputFileError
from arena_ros.bags.stream import LARGEST_CHUNK, LARGEST_RECORD, Bag, Channel, Cut, normalised
from arena_ros.codec import Ros

MAGIC = b"\x89MCAP0\r\n"
FOOTER, SCHEMA, CHANNEL, MESSAGE, CHUNK, STATISTICS, DATA_END = 2, 3, 4, 5, 6, 11, 15
FOOTER_BYTES = 9 + 20 + len(MAGIC)


class Mcap(Bag):
    """A ``.mcap``."""

    ros: ClassVar[Ros] = 2

    def channels(self) -> dict[Channel, int]:
        """Return the channels from the summary; from all of the file where it has none."""
        with self.path.open("rb") as file:
            _begin(file, self)
            try:
                found = _summary(file)
            except (Cut, OSError, struct.error, KeyError):
                found = {}
        return found or self._counted()

    def _counted(self) -> dict[Channel, int]:
        found: dict[Channel, int] = {}
        try:
            for channel, _, _ in self.read(()):
                found[channel] = found.get(channel, 0) + 1
        except Cut:
            pass
        return found

    def read(self, topics: Collection[str]) -> Iterator[tuple[Channel, int, bytes]]:
        """Yield the messages of these topics, of all where there are none; raise Cut where the file ends early."""
        known = _Known()
        with self.path.open("rb") as file:
            _begin(file, self)
            try:
                while True:
                    kind, data = _record(file)
                    if kind == CHUNK:
                        yield from _of_chunk(BytesIO(_unpacked(data)), known, topics)
                    elif kind in (DATA_END, FOOTER):
                        return
                    else:
                        yield from known.take(kind, data, topics)
            except (KeyError, struct.error, ValueError) as error:
                raise Cut(f"a damaged record at byte {file.tell()} ({type(error).__name__})") from None


class _Known:
    """Schemas and channels that have come so far."""

    def __init__(self) -> None:
        self.schemas: dict[int, tuple[str, str]] = {0: ("", "")}
        self.channels: dict[int, Channel] = {}

    def take(self, kind: int, data: bytes, topics: Collection[str]) -> Iterator[tuple[Channel, int, bytes]]:
        if kind == MESSAGE:
            number, _, stamp, _ = struct.unpack_from("<HIQQ", data)
            channel = self.channels[number]
            if not topics or channel.topic in topics:
                yield channel, stamp, data[22:]
        elif kind == SCHEMA:
            number = struct.unpack_from("<H", data)[0]
            name, at = _text(data, 2)
            encoding, at = _text(data, at)
            self.schemas[number] = normalised(name), _text(data, at)[0] if encoding == "ros2msg" else ""
        elif kind == CHANNEL:
            number, schema = struct.unpack_from("<HH", data)
            topic, _ = _text(data, 4)
            self.channels[number] = Channel(topic, *self.schemas[schema])


def _begin(file: IO[bytes], bag: Bag) -> None:
    if file.read(len(MAGIC)) != MAGIC:
        raise InputFileError(f"{bag.path}: is no MCAP file; allowed: what `ros2 bag record -s mcap` wrote")


def _summary(file: IO[bytes]) -> dict[Channel, int]:
    file.seek(-FOOTER_BYTES, 2)
    end = file.read(FOOTER_BYTES)
    start = struct.unpack_from("<Q", end, 9)[0] if end.endswith(MAGIC) and end[0] == FOOTER else 0
    if not start:
        return {}
    file.seek(start)
    known, counts = _Known(), dict[int, int]()
    while True:
        kind, data = _record(file)
        if kind == FOOTER:
            break
        if kind == STATISTICS:
            counts = dict(struct.iter_unpack("<HQ", data[46:]))
        elif kind in (SCHEMA, CHANNEL):
            list(known.take(kind, data, ()))
    found: dict[Channel, int] = {}
    for number, channel in known.channels.items():
        found[channel] = found.get(channel, 0) + counts.get(number, 1)
    return found


def _of_chunk(file: IO[bytes], known: _Known, topics: Collection[str]) -> Iterator[tuple[Channel, int, bytes]]:
    length = len(file.getvalue()) if isinstance(file, BytesIO) else 0
    while file.tell() < length:
        kind, data = _record(file)
        yield from known.take(kind, data, topics)


def _unpacked(data: bytes) -> bytes:
    size = struct.unpack_from("<Q", data, 16)[0]
    compression, at = _text(data, 28)
    packed = data[at + 8 :]
    if size > LARGEST_CHUNK:
        raise Cut(f"a chunk of {size} bytes; allowed: up to {LARGEST_CHUNK}")
    if not compression:
        return packed
    try:
        if compression == "lz4":
            from lz4.frame import LZ4FrameDecompressor

            return bytes(LZ4FrameDecompressor().decompress(packed, size))
        if compression == "zstd":
            return _zstd(packed, size)
    except (OSError, RuntimeError, EOFError) as error:
        raise Cut(f"a damaged chunk ({type(error).__name__})") from None
    raise Cut(f"chunks are compressed by {compression!r}; allowed: lz4, zstd")


def _zstd(packed: bytes, size: int) -> bytes:
    if sys.version_info >= (3, 14):
        from compression import zstd
    else:
        from backports import zstd
    try:
        return bytes(zstd.ZstdDecompressor().decompress(packed, size))
    except zstd.ZstdError as error:
        raise Cut(f"a damaged chunk ({type(error).__name__})") from None


def _record(file: IO[bytes]) -> tuple[int, bytes]:
    head = file.read(9)
    if len(head) < 9:
        raise Cut("it was never closed" if not head else "it ends within a record")
    kind, size = struct.unpack("<BQ", head)
    if size > LARGEST_RECORD:
        raise Cut(f"a record of {size} bytes; allowed: up to {LARGEST_RECORD}")
    data = file.read(size)
    if len(data) < size:
        raise Cut("it ends within a record")
    return kind, data


def _text(data: bytes, at: int) -> tuple[str, int]:
    size = struct.unpack_from("<I", data, at)[0]
    return data[at + 4 : at + 4 + size].decode(errors="replace"), at + 4 + size
