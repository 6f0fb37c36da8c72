"""XML from files that anybody may have written: plain or gzip, limited in size, without entities."""

from __future__ import annotations

import math
from pathlib import Path
from xml.etree import ElementTree
from xml.parsers import expat

from arena_core import InputFileError
from arena_core.files import LIMITS, read_bytes

FARTHEST = 1e4  # m


def read_xml(path: Path, allowed: str) -> ElementTree.Element:
    """Read an XML file, unpacked if its name ends in .gz; raise InputFileError, which names
    ``allowed`` as what may be there.
    """
    return parse_xml(path, read_bytes(path, LIMITS.xml_bytes, allowed), allowed)


def parse_xml(path: Path, content: bytes, allowed: str) -> ElementTree.Element:
    """Parse XML without document types, and so without entities of its own or from outside; raise InputFileError."""
    builder, parser = ElementTree.TreeBuilder(), expat.ParserCreate()
    depth = elements = 0

    def start(tag: str, attributes: dict[str, str]) -> None:
        nonlocal depth, elements
        depth, elements = depth + 1, elements + 1
        if depth > LIMITS.xml_depth or elements > LIMITS.xml_elements:
            deep = depth > LIMITS.xml_depth
            wrong = (
                f"nests deeper than {LIMITS.xml_depth} elements" if deep else f"has over {LIMITS.xml_elements} elements"
            )
            raise InputFileError(f"{path}: line {parser.CurrentLineNumber}: {wrong}; allowed: up to that")
        builder.start(tag, attributes)

    def end(tag: str) -> None:
        nonlocal depth
        depth -= 1
        builder.end(tag)

    def refuse(*_: object) -> None:
        raise InputFileError(
            f"{path}: line {parser.CurrentLineNumber}: has a document type; allowed: XML without <!DOCTYPE ...>"
        )

    parser.StartElementHandler, parser.EndElementHandler = start, end
    parser.CharacterDataHandler = builder.data
    parser.StartDoctypeDeclHandler = refuse
    try:
        parser.Parse(content, True)
    except (expat.ExpatError, ValueError, LookupError) as error:
        raise InputFileError(f"{path}: is no XML ({error}); allowed: {allowed}") from None
    return builder.close()


def parse_numbers(text: str) -> list[float] | None:
    """Return the finite numbers within 10 km that a text holds, None if anything else is in it."""
    try:
        found = [float(word) for word in text.split()]
    except ValueError:
        return None
    return found if all(math.isfinite(number) and abs(number) <= FARTHEST for number in found) else None


def quote_text(text: str) -> str:
    """Return a text as an error may quote it: on one line, and not for ever."""
    return repr(" ".join(text.split())[:60])
