"""What is compressed, as a whole or message by message: unpacked within limits."""

from __future__ import annotations

import bz2
import gzip
import lzma
import sys
import zlib
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from arena_core import InputFileError
from arena_ros.bags.stream import LARGEST_MESSAGE, TruncatedBag

if sys.version_info >= (3, 14):
    from compression import zstd
else:
    from backports import zstd

ENDINGS = (".zstd", ".zst", ".lz4", ".gz", ".bz2", ".xz")
BLOCK = 2**20  # bytes unpacked at a time
SURE_PARTS = 2**28  # bytes likewise, of all chunks of a file
SURE = 2**26  # bytes up to which any ratio is believed
DENSEST = 200  # times that a recording may grow beyond that; scans and text reach 20
ZSTD, LZ4 = b"\x28\xb5\x2f\xfd", b"\x04\x22\x4d\x18"
FAULTS = (OSError, RuntimeError, EOFError, ValueError, lzma.LZMAError, zlib.error, zstd.ZstdError)


def unpack_lz4(packed: bytes, size: int) -> bytes:
    """Return at most so many bytes of an LZ4 frame; raise Cut where it is damaged."""
    from lz4.frame import LZ4FrameDecompressor

    return _decompress_all(LZ4FrameDecompressor(), packed, size)


def unpack_zstd(packed: bytes, size: int) -> bytes:
    """Return at most so many bytes of a zstd frame; raise Cut where it is damaged."""
    return _decompress_all(zstd.ZstdDecompressor(), packed, size)


def unpack_bz2(packed: bytes, size: int) -> bytes:
    """Return at most so many bytes of what bzip2 wrote; raise Cut where it is damaged."""
    return _decompress_all(bz2.BZ2Decompressor(), packed, size)


def _decompress_all(decompressor: Any, packed: bytes, size: int) -> bytes:
    try:
        return bytes(decompressor.decompress(packed, size))
    except FAULTS as error:
        raise TruncatedBag(f"a damaged chunk ({type(error).__name__})") from None


class UnpackLimit:
    """How many bytes the parts of a file may unpack to, all together: a few bytes can say that
    they are thousands of millions.
    """

    def __init__(self, path: Path) -> None:
        self._left = SURE_PARTS + DENSEST * path.stat().st_size

    def take(self, size: int) -> None:
        """Use up some bytes; raise Cut where there are no more."""
        self._left -= size
        if self._left < 0:
            raise TruncatedBag(f"it unpacks to more than {DENSEST} times its size")

    def message(self, content: bytes) -> bytes:
        """Return a message of ROS 2, unpacked where it is compressed by itself (others begin with a zero);
        nothing where it is damaged.
        """
        if not content.startswith((ZSTD, LZ4)):
            return content
        try:
            whole = (unpack_zstd if content.startswith(ZSTD) else unpack_lz4)(content, LARGEST_MESSAGE)
        except TruncatedBag:
            return b""
        self.take(len(whole))
        return whole if len(whole) < LARGEST_MESSAGE else b""


@contextmanager
def unpack_file(path: Path) -> Iterator[Path]:
    """Lend an unpacked copy of a file that was compressed as a whole; raise InputFileError where it is
    damaged or grows too much.
    """
    with TemporaryDirectory(prefix="arena_ros_") as folder:
        target = Path(folder) / path.with_suffix("").name
        most, written = max(SURE, DENSEST * path.stat().st_size), 0
        try:
            with _open_compressed(path) as source, target.open("wb") as copy:
                while block := source.read(BLOCK):
                    written += copy.write(block)
                    if written > most:
                        raise InputFileError(
                            f"{path}: unpacks to more than {most} bytes; allowed: up to {DENSEST} times its size"
                        )
        except FAULTS as error:
            raise InputFileError(
                f"{path}: cannot be unpacked ({type(error).__name__}); allowed: {', '.join(ENDINGS)}"
            ) from None
        yield target


def _open_compressed(path: Path) -> AbstractContextManager[Any]:
    if path.suffix in (".zstd", ".zst"):
        return zstd.ZstdFile(path)
    if path.suffix == ".lz4":
        import lz4.frame

        opened: AbstractContextManager[Any] = lz4.frame.open(path)
        return opened
    kinds: dict[str, type[gzip.GzipFile | bz2.BZ2File | lzma.LZMAFile]] = {
        ".gz": gzip.GzipFile,
        ".bz2": bz2.BZ2File,
        ".xz": lzma.LZMAFile,
    }
    return kinds[path.suffix](path)
