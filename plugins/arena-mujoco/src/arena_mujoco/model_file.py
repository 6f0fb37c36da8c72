"""A model's file before MuJoCo sees it: no document type, no counts that take the machine's
memory, in it or in what it includes.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from pathlib import Path
from struct import unpack
from xml.parsers import expat

from arena_core import InputFileError
from arena_core.commands import one_line
from arena_core.files import LIMITS, read_text

FORMATS = "a MuJoCo model (MJCF) or URDF"
MOST_THINGS = 20_000  # elements, each as often as it is replicated: a humanoid with hands has a thousand
MOST_CELLS = 4_000_000  # of a height field, a texture, a composite, user data, and whatever else one element counts
MOST_FILES = 1_000  # that one model names
LARGEST = 100_000_000  # bytes of a mesh or a picture
COUNTS = (
    "nrow",
    "ncol",
    "count",
    "width",
    "height",
    "dim",
    "nuserdata",
    "nkey",
    "nsample",
    "offwidth",
    "offheight",
    "resolution",
)
FOLDERS = ("meshdir", "texturedir", "assetdir")
PNG = b"\x89PNG\r\n\x1a\n"


def check_model_file(path: Path) -> None:
    """Raise InputFileError (one line) for a model that takes more than a machine has, or that is no XML."""
    if not path.is_file():
        raise InputFileError(f"{path}: is missing; allowed: {FORMATS}")
    _Check().read(path, 1)


class _Check:
    """What was counted in a model and in the files that it includes."""

    def __init__(self) -> None:
        self._things = 0
        self._files: set[Path] = set()

    def read(self, path: Path, times: int) -> None:
        """Check one file, whose content is there so many ``times``."""
        if path in self._files:
            return
        self._files.add(path)
        if len(self._files) > MOST_FILES:
            raise InputFileError(f"{path}: is one of over {MOST_FILES} files; allowed: up to that")
        parser, stack, named, folders = expat.ParserCreate(), [times], list[tuple[str, str, int]](), {""}

        def start(tag: str, attributes: dict[str, str]) -> None:
            place = f"{path}: line {parser.CurrentLineNumber}"
            stack.append(
                stack[-1] * max(1, _numbers_product(attributes.get("count", "1"))) if tag == "replicate" else stack[-1]
            )
            self._things += stack[-1]
            if self._things > MOST_THINGS or len(stack) > LIMITS.xml_depth:
                raise InputFileError(
                    f"{place}: has over {MOST_THINGS} elements, or {LIMITS.xml_depth} inside "
                    "each other; allowed: up to that"
                )
            _check_counts(place, tag, attributes)
            folders.update(attributes[name] for name in FOLDERS if name in attributes)
            if "file" in attributes:
                named.append((tag, attributes["file"], stack[-1]))

        def refuse(*_: object) -> None:
            raise InputFileError(
                f"{path}: line {parser.CurrentLineNumber}: has a document type; allowed: XML without <!DOCTYPE ...>"
            )

        parser.StartElementHandler, parser.EndElementHandler = start, lambda tag: stack.pop()
        parser.StartDoctypeDeclHandler = refuse
        try:
            # MuJoCo takes the bytes of names for UTF-8, whatever XML says
            parser.Parse(read_text(path, LIMITS.xml_bytes, FORMATS), True)
        except (expat.ExpatError, ValueError, LookupError) as error:
            raise InputFileError(f"{path}: is no XML ({one_line(str(error), 120)}); allowed: {FORMATS}") from None
        for tag, name, often in named:
            for file in _candidate_paths(path, folders, name):
                self._check_named_file(tag, file, often)

    def _check_named_file(self, tag: str, file: Path, times: int) -> None:
        """Check a file that a model names: another model, a mesh or a picture."""
        if tag in ("include", "model"):
            self.read(file, times)
            return
        size = file.stat().st_size
        if size > LARGEST:
            raise InputFileError(f"{file}: is larger than {LARGEST} bytes; allowed: up to that")
        with file.open("rb") as content:
            head = content.read(24)
        if head.startswith(PNG) and len(head) == 24:
            width, height = unpack(">II", head[16:24])
            _check_cells(str(file), "width x height", width * height)


def _candidate_paths(path: Path, folders: set[str], name: str) -> Iterator[Path]:
    """Yield the files that a name may stand for."""
    for folder in sorted(folders):
        try:
            file = path.parent / folder / name
            if file.is_file():
                yield file.resolve()
        except (OSError, ValueError):  # a name that none can have: MuJoCo says so
            continue


def _check_counts(place: str, tag: str, attributes: Mapping[str, str]) -> None:
    """Raise InputFileError where an element asks for more cells than there may be."""
    if tag in ("size", "numeric"):
        own = {
            name: text
            for name, text in attributes.items()
            if name.startswith("n") or (tag == "numeric" and name == "size")
        }
        for name, text in own.items():
            if name != "name":
                _check_cells(place, name, _numbers_product(text))
    _check_cells(
        place,
        "its size",
        math.prod(max(1, _numbers_product(text)) for name, text in attributes.items() if name in COUNTS),
    )


def _check_cells(place: str, what: str, cells: int) -> None:
    if cells > MOST_CELLS:
        raise InputFileError(f"{place}: {what} is {cells:.4g}; allowed: {MOST_CELLS}")


def _numbers_product(text: str) -> int:
    """Return the product of the whole numbers that a text holds; 1 where it holds none: MuJoCo says what is wrong."""
    try:
        found = [float(word) for word in text.split()]
    except ValueError:
        return 1
    product = math.prod(abs(number) for number in found)
    return MOST_CELLS + 1 if not product <= MOST_CELLS else math.ceil(product)
