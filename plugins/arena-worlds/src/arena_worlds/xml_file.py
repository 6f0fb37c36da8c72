"""XML from files that anybody may have written: plain or gzip, limited in size, without entities."""

from __future__ import annotations

import gzip
import math
import zlib
from pathlib import Path
from xml.etree import ElementTree
from xml.parsers import expat

from arena_core import InputFileError

LARGEST_FILE = 20_000_000  # bytes, unpacked; BARN's worlds have 0.5 million
DEEPEST = 100  # elements inside each other
FARTHEST = 1e4  # m


def read_xml(path: Path, allowed: str) -> ElementTree.Element:
    """Read an XML file, unpacked if its name ends in .gz; raise InputFileError, which names ``allowed`` as what may be there."""
    return parse_xml(path, unpacked(path, allowed), allowed)


def unpacked(path: Path, allowed: str) -> bytes:
    """Return a file's content, unpacked if its name ends in .gz; raise InputFileError."""
    try:
        with gzip.open(path) if path.suffix == ".gz" else path.open("rb") as file:
            content = file.read(LARGEST_FILE + 1)
    except (gzip.BadGzipFile, EOFError, zlib.error) as error:
        raise InputFileError(f"{path}: is no gzip file ({error}); allowed: {allowed}") from None
    except (OSError, ValueError) as error:  # ValueError: a name with a null in it
        reason = getattr(error, "strerror", None) or error
        raise InputFileError(f"{path}: cannot be read ({reason}); allowed: {allowed}") from None
    if len(content) > LARGEST_FILE:
        raise InputFileError(f"{path}: is larger than {LARGEST_FILE} bytes unpacked; allowed: up to that")
    return content


def parse_xml(path: Path, content: bytes, allowed: str) -> ElementTree.Element:
    """Parse XML without document types, and so without entities of its own or from outside; raise InputFileError."""
    builder, parser = ElementTree.TreeBuilder(), expat.ParserCreate()
    depth = 0

    def start(tag: str, attributes: dict[str, str]) -> None:
        nonlocal depth
        depth += 1
        if depth > DEEPEST:
            raise InputFileError(f"{path}: line {parser.CurrentLineNumber}: nests deeper than {DEEPEST} elements; allowed: up to that")
        builder.start(tag, attributes)

    def end(tag: str) -> None:
        nonlocal depth
        depth -= 1
        builder.end(tag)

    def refuse(*_: object) -> None:
        raise InputFileError(f"{path}: line {parser.CurrentLineNumber}: has a document type; allowed: XML without <!DOCTYPE ...>")

    parser.StartElementHandler, parser.EndElementHandler = start, end
    parser.CharacterDataHandler = builder.data
    parser.StartDoctypeDeclHandler = refuse
    try:
        parser.Parse(content, True)
    except (expat.ExpatError, ValueError, LookupError) as error:
        raise InputFileError(f"{path}: is no XML ({error}); allowed: {allowed}") from None
    return builder.close()


def numbers(text: str) -> list[float] | None:
    """Return the finite numbers within 10 km that a text holds, None if anything else is in it."""
    try:
        found = [float(word) for word in text.split()]
    except ValueError:
        return None
    return found if all(math.isfinite(number) and abs(number) <= FARTHEST for number in found) else None


def shown(text: str) -> str:
    """Return a text as an error may quote it: on one line, and not for ever."""
    return repr(" ".join(text.split())[:60])
