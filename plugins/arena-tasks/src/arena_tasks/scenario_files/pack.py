"""Scenario packs: a folder whose pack.yaml names it and holds the SHA-256 of each of its files."""

from __future__ import annotations

from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path, PurePosixPath

from arena_core import InputFileError
from arena_core.files import LIMITS, check_inside, read_bytes
from arena_tasks.scenario_files.json_fields import Field
from arena_tasks.scenario_files.yaml_fields import read_yaml

PACK_FILE = "pack.yaml"
FORMAT = "arena-pack"
SHOWN = 12  # hexadecimal digits of a hash in an error


@dataclass(frozen=True, slots=True)
class Pack:
    """A pack in ``folder``; ``files`` are its maps and scenario files, by path relative to the
    folder, with their SHA-256.
    """

    folder: Path
    id: str
    version: str
    title: str
    licence: str
    files: dict[str, str]

    def check(self) -> None:
        """Raise InputFileError for the first file that is not there or not as it was when the pack was made."""
        for name, expected in self.files.items():
            check_inside(self.folder, self.folder / name)
            found = hash_of(self.folder / name)
            if found != expected:
                raise InputFileError(
                    f"{self.folder / name}: has changed: its SHA-256 is {found[:SHOWN]}..., "
                    f"and {expected[:SHOWN]}... in {PACK_FILE}; "
                    f"allowed: the file as packed, or a new version of the pack by `arena scenario pack {self.folder}`"
                )

    def check_lists(self, file: Path) -> None:
        """Raise InputFileError unless ``file`` belongs to the pack."""
        if file.resolve().relative_to(self.folder.resolve()).as_posix() not in self.files:
            raise InputFileError(
                f"{file}: is not listed in {self.folder / PACK_FILE}; `arena scenario pack {self.folder}` lists it"
            )

    def scenario_files(self) -> list[str]:
        """Return the names of the scenario files, sorted."""
        return sorted(name for name in self.files if name.endswith(".json"))


def verified_pack(folder: Path) -> Pack | None:
    """Return the pack of the files in a folder, all of them found as packed: its own pack, or that of the
    folder above; None in neither.
    """
    for place in (folder, folder.absolute().parent):
        if (place / PACK_FILE).is_file():
            pack = read_pack(place)
            pack.check()
            return pack
    return None


def read_pack(folder: Path) -> Pack:
    """Read a folder's pack.yaml; raise InputFileError with file and key. The files themselves are not looked at."""
    root = read_yaml(folder / PACK_FILE, "a pack's YAML file")
    root.check_keys("format", "id", "version", "title", "licence", "files")
    if root["format"].value != FORMAT:
        raise root["format"].rejection(FORMAT)
    name, version, title, licence = (root[key].text() for key in ("id", "version", "title", "licence"))
    if not name.isidentifier():
        raise root["id"].rejection("a name of letters, digits and _ that begins with no digit")
    return Pack(
        folder,
        name,
        version,
        title,
        licence,
        {name: _listed_digest(name, digest) for name, digest in root["files"].entries()},
    )


def hash_of(path: Path) -> str:
    """Return the SHA-256 of a file's bytes; raise InputFileError where it cannot be read."""
    return sha256(read_bytes(path, LIMITS.arrays_bytes, f"a file as {PACK_FILE} lists it", unpack=False)).hexdigest()


def _listed_digest(name: str, digest: Field) -> str:
    path = PurePosixPath(name) if isinstance(name, str) and "\0" not in name else PurePosixPath("/")
    if path.is_absolute() or ".." in path.parts:
        raise InputFileError(
            f"{digest.file}: {digest.key} lies outside the pack; allowed: a path relative to it, without .."
        )
    return digest.text()
