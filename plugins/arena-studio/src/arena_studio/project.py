"""The project folder: the only place of the disk that the studio reads and writes."""

from __future__ import annotations

import os
from collections.abc import Collection, Iterator
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path, PurePosixPath
from threading import Lock

from arena_core import ArenaError, InputFileError
from arena_core.commands import one_line
from arena_core.files import LIMITS, read_bytes, write_bytes_whole
from arena_studio.errors import Conflict, Missing, TooLarge

LARGEST = 100_000_000  # bytes of a file that is read or written; the image of a map of 10,000 by 10,000 cells
LONGEST_NAME = 400  # characters of a path
MOST_FILES = 5000  # that are listed
DEEPEST = 12  # folders inside each other that are looked into
# folders of a run, which hold no documents of the user's
RECORDED = frozenset({"records", "timing", "worlds", "report"})


@dataclass(frozen=True, slots=True)
class Document:
    """A file as it was read: its content, and its version, the SHA-256 of the content in hexadecimal digits."""

    content: bytes
    version: str


class Project:
    """A folder. Paths in it are relative, with slashes; hidden files are none of the studio's business."""

    def __init__(self, root: Path) -> None:
        if not root.is_dir():
            raise InputFileError(f"{root}: no such folder; allowed: a folder that is there")
        self.root = root.resolve()
        self._writing = Lock()

    def path(self, relative: str) -> Path:
        """Return where a file lies or would lie; raise ArenaError for a path that leads out of the folder,
        by .., a link or otherwise.
        """
        parts = PurePosixPath(relative).parts
        shown = one_line(relative, 80)
        if not parts or len(relative) > LONGEST_NAME or any(c < " " or c == "\\" for c in relative):
            raise ArenaError(
                f"path is {shown!r}; allowed: a relative path of up to {LONGEST_NAME} characters, with slashes"
            )
        if len(parts) > LIMITS.folder_parts:
            raise ArenaError(f"path is {shown!r}; allowed: up to {LIMITS.folder_parts} folders inside each other")
        if "${" in relative:  # Hydra would read something else in it wherever the file is named
            raise ArenaError(f"path is {shown!r}, which holds an interpolation; allowed: a path as it is")
        if parts[0] == "/" or any(part.startswith(".") for part in parts):
            raise ArenaError(f"path is {shown!r}; allowed: a path inside the project folder, without hidden parts")
        try:
            real = (self.root / relative).resolve()
        except (OSError, RuntimeError, ValueError):  # links in a circle, a name that no file can have
            raise ArenaError(f"path is {shown!r}; allowed: a name that a file can have") from None
        if not real.is_relative_to(self.root) or real == self.root:
            raise ArenaError(f"path is {shown!r}, which leads out of the project folder; allowed: a path inside it")
        return real

    def relative(self, path: Path) -> str:
        """Return how a path in the folder is called in it."""
        return path.relative_to(self.root).as_posix()

    def read(self, relative: str) -> Document:
        """Read a file; raise Missing where it is not there, InputFileError where it cannot be read."""
        path = self.path(relative)
        if not _is_file(path):
            raise Missing(f"{one_line(relative, 80)}: no such file")
        content = read_bytes(path, LARGEST, "a file", unpack=False)
        return Document(content, version_of(content))

    def write(self, relative: str, content: bytes, version: str | None) -> str:
        """Write a file whole and return its version.

        ``version`` is that of the file as it was read (None: it must not exist yet); raises Conflict, and writes
        nothing, where the file has another one by now.
        """
        path = self.path(relative)
        if len(content) > LARGEST:
            raise TooLarge(f"{one_line(relative, 80)} has {len(content)} bytes; allowed: up to {LARGEST}")
        with self._writing:
            self._check_version(relative, path, version)
            write_bytes_whole(path, content)
        return version_of(content)

    def _check_version(self, relative: str, path: Path, version: str | None) -> None:
        shown = one_line(relative, 80)
        if not _is_file(path):
            if path.exists():
                raise ArenaError(f"{shown} is no file; allowed: the name of a file")
            if version is not None:
                raise Conflict(f"{shown} was removed since it was read")
        elif version is None:
            raise Conflict(f"{shown} is there already")
        elif self.read(relative).version != version:
            raise Conflict(f"{shown} was changed by someone else since it was read")

    def files(self, suffixes: Collection[str]) -> list[str]:
        """Return the files with one of the suffixes (``.yaml``), sorted: those of the user, not
        those that runs have written.
        """
        found = []
        for path in self._walk_files():
            if path.suffix.lower() in suffixes:
                found.append(self.relative(path))
                if len(found) == MOST_FILES:
                    break
        return sorted(found)

    def _walk_files(self) -> Iterator[Path]:
        for folder, folders, names in os.walk(self.root):
            inside = Path(folder)
            is_run = "episodes.csv" in names
            deep = len(inside.relative_to(self.root).parts) >= DEEPEST
            folders[:] = (
                [] if deep else sorted(f for f in folders if not f.startswith(".") and not (is_run and f in RECORDED))
            )
            yield from (inside / name for name in sorted(names) if not name.startswith("."))


def version_of(content: bytes) -> str:
    """Return the version of a file with this content."""
    return sha256(content).hexdigest()


def _is_file(path: Path) -> bool:
    try:
        return path.is_file()
    except OSError:  # a name that is too long
        return False
