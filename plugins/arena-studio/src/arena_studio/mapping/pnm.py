"""PGM and PPM images that are changed cell by cell: header, comments, and every byte that
no one drew over stay as they are.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from arena_core import InputFileError
from arena_core.files import LIMITS

GAP = rb"(?:\s|#[^\n]*\n)+"
HEADER = re.compile(rb"(P[2356])" + GAP + rb"(\d{1,9})" + GAP + rb"(\d{1,9})" + GAP + rb"(\d{1,5})(?:\s*#[^\n]*\n|\s)")
TOKEN = re.compile(rb"#[^\n]*|\d+")
PLAIN, COLOUR = (b"P2", b"P3"), (b"P3", b"P6")
ALLOWED = "PGM or PPM, plain or binary"
Samples: TypeAlias = NDArray[np.uint8] | NDArray[np.uint16]  # of up to 255, and of more


@dataclass(frozen=True, slots=True, eq=False)
class Pnm:
    """An image as it lies in its file: ``samples`` (H, W, C) up to ``highest``, row 0 at the top; the
    pixels begin at byte ``begin``.
    """

    content: bytes
    kind: bytes
    highest: int
    begin: int
    samples: Samples

    def encode_samples(self, samples: Samples) -> bytes:
        """Return the file with these samples: it differs from the old one where they do, of
        another size also in its size.
        """
        if samples.shape != self.samples.shape:
            return self._format_header(*samples.shape[:2]) + self._encode_body(samples)
        if self.kind in PLAIN:
            return self._encode_plain(samples)
        end = self.begin + self.samples.size * self._sample_width
        return self.content[: self.begin] + self._encode_body(samples) + self.content[end:]

    def _format_header(self, rows: int, columns: int) -> bytes:
        """Return the header with another size, its comments as they are."""
        found = HEADER.match(self.content)
        assert found is not None
        (left, right), (top, bottom) = found.span(2), found.span(3)
        content = self.content
        return content[:left] + b"%d" % columns + content[right:top] + b"%d" % rows + content[bottom : self.begin]

    @property
    def _sample_width(self) -> int:
        return 2 if self.highest > 255 else 1

    def _encode_body(self, samples: Samples) -> bytes:
        if self.kind in PLAIN:
            return (
                b"\n".join(
                    b" ".join(b"%d" % value for value in row) for row in samples.reshape(len(samples), -1).tolist()
                )
                + b"\n"
            )
        return samples.astype(">u2" if self._sample_width == 2 else np.uint8, copy=False).tobytes()

    def _encode_plain(self, samples: Samples) -> bytes:
        """Replace the numbers of a plain file that are others now."""
        tokens = _find_numbers(self.content, self.begin)
        parts, last = [], 0
        for number in np.flatnonzero(samples.ravel() != self.samples.ravel()).tolist():
            parts += [self.content[last : tokens[number].start()], b"%d" % int(samples.ravel()[number])]
            last = tokens[number].end()
        return b"".join([*parts, self.content[last:]])


def is_pnm(content: bytes) -> bool:
    """Return whether a file is one of those that ``read_pnm`` reads."""
    return content[:2] in (b"P2", b"P3", b"P5", b"P6")


def read_pnm(content: bytes, name: str) -> Pnm:
    """Read an image; raise InputFileError, which calls it ``name``."""
    found = HEADER.match(content)
    if not found:
        raise InputFileError(f"{name}: is no image that can be read (its header is damaged); allowed: {ALLOWED}")
    kind, columns, rows, highest = found[1], *(int(found[group]) for group in (2, 3, 4))
    if columns * rows > LIMITS.cells:
        raise InputFileError(f"{name}: has {columns} x {rows} pixels; allowed: {LIMITS.cells} in all")
    if not columns or not rows or not 0 < highest < 65536:
        raise InputFileError(
            f"{name}: has {columns} x {rows} pixels up to {highest}; allowed: at least one, up to 65535"
        )
    shape = (rows, columns, 3 if kind in COLOUR else 1)
    samples = _parse_samples(content, kind, highest, found.end(), int(np.prod(shape)))
    if samples is None:
        raise InputFileError(f"{name}: is no image that can be read (it ends too early); allowed: {ALLOWED}")
    return Pnm(content, kind, highest, found.end(), samples.reshape(shape))


def _parse_samples(content: bytes, kind: bytes, highest: int, begin: int, count: int) -> Samples | None:
    if kind in PLAIN:
        tokens = _find_numbers(content, begin)
        values = [int(token[0][:6]) for token in tokens[:count]]
        return np.array(values, np.uint16) if len(values) == count and max(values) < 65536 else None
    layout = np.dtype(">u2" if highest > 255 else np.uint8)
    if len(content) - begin < count * layout.itemsize:
        return None
    found = np.frombuffer(content, layout, count, begin)
    return found.astype(np.uint16) if highest > 255 else found.view(np.uint8)


def _find_numbers(content: bytes, begin: int) -> list[re.Match[bytes]]:
    return [token for token in TOKEN.finditer(content, begin) if not token[0].startswith(b"#")]
