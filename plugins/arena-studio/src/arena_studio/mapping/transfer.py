"""Maps on their way between page and server: a header in JSON, then one byte a cell."""

from __future__ import annotations

import json
import zlib
from collections.abc import Mapping
from typing import Any

from arena_core import InputFileError
from arena_core.files import LIMITS
from arena_studio.errors import TooLarge

HEAD = 4  # bytes of the header's length, little-endian
HEADER_BYTES = 1_000_000
GZIP = b"\x1f\x8b"
SHAPE = "four bytes with the length of a header, the header in JSON, cells"


def pack_cells(header: Mapping[str, Any], cells: bytes) -> bytes:
    """Return a header and cells as one body."""
    text = json.dumps(header, allow_nan=False).encode()
    return len(text).to_bytes(HEAD, "little") + text + cells


def unpack_cells(body: bytes) -> tuple[dict[str, Any], bytes]:
    """Return the header and the cells of a body, gzip or not; raise InputFileError for anything
    else, TooLarge for too much.
    """
    content = _inflate_body(body) if body.startswith(GZIP) else body
    length = int.from_bytes(content[:HEAD], "little")
    if len(content) < HEAD + length or length > HEADER_BYTES:
        raise InputFileError(f"the request is cut off; allowed: {SHAPE}")
    try:
        header = json.loads(content[HEAD : HEAD + length])
    except (ValueError, RecursionError):
        header = None
    if not isinstance(header, dict):
        raise InputFileError(f"the request has no header; allowed: {SHAPE}")
    return header, content[HEAD + length :]


def _inflate_body(body: bytes) -> bytes:
    most = LIMITS.cells + HEADER_BYTES + HEAD
    inflater = zlib.decompressobj(16 + zlib.MAX_WBITS)
    try:
        content = inflater.decompress(body, most + 1)
    except zlib.error:
        raise InputFileError(f"the request is no gzip; allowed: {SHAPE}, as gzip or not") from None
    if len(content) > most:
        raise TooLarge(f"the request unpacks to more than {most} bytes; allowed: up to that")
    return content
