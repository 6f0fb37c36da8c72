"""Archives that anybody may have made: only files of known names and sizes are read out of
them, each against its digest.
"""

from __future__ import annotations

import re
import stat
import zipfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from hashlib import sha256
from pathlib import Path
from typing import IO

from arena_core import InputFileError
from arena_core.commands import one_line
from arena_core.files import LIMITS, write_whole

ALLOWED = "a file that `arena submit` wrote"
FACTS = "pack.json"
NAMES: Mapping[re.Pattern[str], int] = {  # what may be in an archive, and how many bytes of it at most, unpacked
    re.compile(re.escape(FACTS)): LIMITS.json_bytes,
    re.compile(r"runs/\d{1,6}/provenance\.json"): LIMITS.json_bytes,
    re.compile(r"runs/\d{1,6}/episodes\.csv"): LIMITS.table_bytes,
    # an hour among a hundred people has 10 MB
    re.compile(r"runs/\d{1,6}/(records|timing)/(\d{3,5}/)?\d{4,8}\.npz"): 50_000_000,
    re.compile(r"runs/\d{1,6}/worlds/[0-9a-f]{16}\.npz"): 60_000_000,
}
# of one archive: 40,000 episodes with their timing; pack.json has to name them all within its own limit
MOST_FILES = 80_000
MOST_BYTES = 20_000_000_000  # of all files, unpacked
PACKINGS = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)
PACKED_ALREADY = ".npz"
PART = 2**20  # bytes


def write_archive(path: Path, contents: Mapping[str, Path | bytes]) -> None:
    """Write files to an archive, whole or not at all; equal contents are equal archives."""

    def write(file: IO[bytes]) -> None:
        with zipfile.ZipFile(file, "w") as archive:
            for name, content in contents.items():
                member = zipfile.ZipInfo(name)  # dated 1980
                member.external_attr = 0o644 << 16
                member.compress_type = zipfile.ZIP_STORED if name.endswith(PACKED_ALREADY) else zipfile.ZIP_DEFLATED
                archive.writestr(member, content if isinstance(content, bytes) else content.read_bytes())

    write_whole(path, write)


class Archive:
    """An opened archive whose table of contents is in order; ``names`` are those of its files."""

    def __init__(self, path: Path, archive: zipfile.ZipFile) -> None:
        self._path, self._archive = path, archive
        self._members = _check_members(path, archive.infolist())

    @property
    def names(self) -> list[str]:
        """Return the names of all files, in the archive's order."""
        return list(self._members)

    def read(self, name: str) -> bytes:
        """Return one file; raise InputFileError where it is missing, damaged, or longer than it says."""
        if name not in self._members:
            raise InputFileError(f"{self._path}: lacks {name}; allowed: {ALLOWED}")
        try:
            with self._archive.open(self._members[name]) as file:
                content = file.read(self._members[name].file_size + 1)
        except Exception as error:  # zipfile and zlib raise whatever a damaged file leads them to
            raise InputFileError(
                f"{self._path}: {name} is damaged ({one_line(str(error), 100)}); allowed: {ALLOWED}"
            ) from None
        if len(content) != self._members[name].file_size:
            raise InputFileError(f"{self._path}: {name} has not the size that it says; allowed: {ALLOWED}")
        return content

    def unpack(self, names: list[str], folder: Path) -> None:
        """Write files below a folder, under their names: all of those were found to stay inside it."""
        for name in names:
            target = folder / name
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_bytes(self.read(name))

    def digest_of(self, name: str) -> str:
        """Return the SHA-256 of a file's content."""
        return sha256(self.read(name)).hexdigest()


@contextmanager
def open_archive(path: Path) -> Iterator[Archive]:
    """Open an archive to be read; raise InputFileError where it is none, or holds what none of ours does."""
    try:
        if not stat.S_ISREG(path.stat().st_mode):
            raise InputFileError(f"{path}: cannot be read (it is no file); allowed: {ALLOWED}")
        archive = zipfile.ZipFile(path)
    except (OSError, ValueError, NotImplementedError, zipfile.BadZipFile) as error:
        reason = getattr(error, "strerror", None) or one_line(str(error), 100)
        raise InputFileError(f"{path}: cannot be read ({reason}); allowed: {ALLOWED}") from None
    with archive:
        yield Archive(path, archive)


def _check_members(path: Path, members: list[zipfile.ZipInfo]) -> dict[str, zipfile.ZipInfo]:
    """Return the members by name; raise InputFileError for the first that is not to be there."""
    if len(members) > MOST_FILES or sum(member.file_size for member in members) > MOST_BYTES:
        raise InputFileError(
            f"{path}: holds too much; allowed: up to {MOST_FILES} files of {MOST_BYTES} bytes together"
        )
    found: dict[str, zipfile.ZipInfo] = {}
    for member in members:
        if wrong := _member_fault(member, found):
            raise InputFileError(f"{path}: {one_line(member.filename, 100)} {wrong}; allowed: {ALLOWED}")
        found[member.filename] = member
    return found


def _member_fault(member: zipfile.ZipInfo, before: Mapping[str, zipfile.ZipInfo]) -> str:
    """Return what is wrong with a member, empty where nothing is."""
    most = next((size for pattern, size in NAMES.items() if pattern.fullmatch(member.filename)), None)
    if most is None or member.orig_filename != member.filename:
        return "is no file of a pack"
    if member.filename in before:
        return "is there twice"
    if stat.S_IFMT(member.external_attr >> 16) not in (0, stat.S_IFREG):
        return "is a link or a device"
    if member.flag_bits & 0x1 or member.compress_type not in PACKINGS:
        return "is packed otherwise than by deflate"
    return f"has {member.file_size} bytes, at most {most} are read" if member.file_size > most else ""
