"""Scalars of TensorBoard's event files, which trainings write: no more of the format than they need.

A file is a row of records, each of a length (8 bytes), its checksum (4), a message of that length and its checksum (4).
A message (protobuf) holds in field 2 the step and in field 5 a summary, whose values (field 1) have a tag (field 1) and
a number (field 2). What is being written at the end is no record yet.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from arena_core import InputFileError
from arena_core.files import LIMITS, read_bytes

ALLOWED = "an event file of TensorBoard"
STEP, SUMMARY = 2, 5
VALUE, TAG, NUMBER = 1, 1, 2
Scalars = dict[str, list[tuple[int, float]]]  # steps and values by tag


def read_scalars(path: Path) -> Scalars:
    """Return the scalars of an event file; raise InputFileError (one line) for anything else."""
    content = memoryview(read_bytes(path, LIMITS.table_bytes, ALLOWED, unpack=False))
    found: Scalars = {}
    try:
        for message in _messages(content):
            fields = dict(_fields(message))
            step, summary = fields.get(STEP, 0), fields.get(SUMMARY, b"")
            for number, value in _fields(summary):
                if number == VALUE:
                    _add_value(found, int(step), dict(_fields(value)))
    except (struct.error, IndexError, TypeError, ValueError, OverflowError):
        raise InputFileError(f"{path}: cannot be read (no events of TensorBoard); allowed: {ALLOWED}") from None
    return found


def join_scalars(parts: list[Scalars]) -> Scalars:
    """Return the scalars of a training's files, given in order of time; a later one counts from its first step on."""
    found: Scalars = {}
    for part in parts:
        for tag, points in part.items():
            found[tag] = [point for point in found.get(tag, []) if point[0] < points[0][0]] + points
    return found


def _add_value(found: Scalars, step: int, value: dict[int, Any]) -> None:
    tag, number = value.get(TAG), value.get(NUMBER)
    if isinstance(tag, memoryview) and isinstance(number, float):
        found.setdefault(bytes(tag).decode("utf-8"), []).append((step, number))


def _messages(content: memoryview) -> Iterator[memoryview]:
    place = 0
    while place + 12 <= len(content):
        (length,) = struct.unpack_from("<Q", content, place)
        end = place + 12 + length
        if end + 4 > len(content):
            return
        yield content[place + 12 : end]
        place = end + 4


def _fields(message: memoryview | bytes) -> Iterator[tuple[int, Any]]:
    """Yield the fields of a message by number: whole numbers, bytes, and numbers of single precision as floats."""
    place = 0
    while place < len(message):
        key, place = _varint(message, place)
        number, kind = key >> 3, key & 7
        if kind == 0:
            value, place = _varint(message, place)
            yield number, value
        elif kind == 1:
            place += 8
        elif kind == 2:
            length, place = _varint(message, place)
            if place + length > len(message):
                raise ValueError(length)
            yield number, message[place : place + length]
            place += length
        elif kind == 5:
            yield number, struct.unpack_from("<f", message, place)[0]
            place += 4
        else:
            raise ValueError(kind)


def _varint(message: memoryview | bytes, place: int) -> tuple[int, int]:
    """Return the whole number at a place and where it ends; seven bits a byte, the lowest first."""
    value = shift = 0
    while True:
        byte = message[place]
        value |= (byte & 0x7F) << shift
        place, shift = place + 1, shift + 7
        if byte < 0x80:
            return value, place
        if shift > 63:
            raise ValueError(shift)
