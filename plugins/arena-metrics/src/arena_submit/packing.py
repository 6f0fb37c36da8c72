"""Packs: finished runs in one archive, with a digest of every file and one of all."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from arena_core import InputFileError
from arena_core.commands import one_line
from arena_core.files import check_inside, read_json, read_table
from arena_core.records import find_runs, read_provenance, record_paths, timing_paths
from arena_submit.archive import ALLOWED, FACTS, Archive, open_archive, write_archive

FORMAT, VERSION = "arena-submission", 1
TABLES = ("episodes.csv", "provenance.json")


@dataclass(frozen=True, slots=True, eq=False)
class PackedRun:
    """One run of a pack: its ``name`` within it, the rows of its table as texts, its provenance,
    and the files that belong to it.
    """

    name: str
    rows: Sequence[Mapping[str, str]]
    provenance: Mapping[str, Any]
    files: Sequence[str]

    @property
    def config(self) -> dict[str, Any]:
        """Return the composed configuration."""
        return dict(self.provenance["config"])

    @property
    def seed(self) -> int:
        """Return the seed."""
        return int(self.provenance["config"]["seed"])


@dataclass(frozen=True, slots=True, eq=False)
class Pack:
    """A pack whose files are those that were packed: its archive, its digest and its runs."""

    path: Path
    archive: Archive
    digest: str
    runs: Sequence[PackedRun]


def write_pack(folders: Sequence[Path], target: Path) -> str:
    """Pack all runs at or below the folders; return the pack's digest.

    Raises InputFileError where a run is not finished.
    """
    contents: dict[str, Path | bytes] = {}
    for number, run in enumerate(sorted({run.resolve() for folder in folders for run in find_runs(folder)})):
        contents |= {f"runs/{number}/{path.relative_to(run).as_posix()}": path for path in _run_files(run)}
    digests = {name: sha256(path.read_bytes()).hexdigest() for name, path in contents.items() if isinstance(path, Path)}
    facts = {"format": FORMAT, "version": VERSION, "digest": digest_of(digests), "files": digests}
    write_archive(target, {FACTS: (json.dumps(facts, indent=1, sort_keys=True) + "\n").encode(), **contents})
    return str(facts["digest"])


def digest_of(digests: Mapping[str, str]) -> str:
    """Return the digest of a pack from those of its files, 64 hexadecimal digits."""
    return sha256(json.dumps(digests, sort_keys=True).encode()).hexdigest()


@contextmanager
def read_pack(path: Path) -> Iterator[Pack]:
    """Open a pack, hold each file against its digest, and read its tables; raise InputFileError for
    whatever is not as it was packed.
    """
    with open_archive(path) as archive, TemporaryDirectory(prefix="arena-pack-") as folder:
        tables = [name for name in archive.names if name == FACTS or name.rpartition("/")[2] in TABLES]
        archive.unpack(tables, Path(folder))
        digest = _check_digests(path, archive, read_json(Path(folder, FACTS), ALLOWED) if FACTS in tables else None)
        names = sorted(
            {name.rpartition("/")[0] for name in tables if name != FACTS}, key=lambda name: int(name.rpartition("/")[2])
        )
        if not names:
            raise InputFileError(f"{path}: holds no run; allowed: {ALLOWED}")
        yield Pack(path, archive, digest, [_read_run(path, archive, Path(folder), name) for name in names])


def seeing_parts(facts: Mapping[str, Any], rows: Sequence[Mapping[str, str]]) -> str:
    """Return which parts saw the truth in a run, by its provenance and its table; empty where none did."""
    told = facts.get("privileged") or []
    names = {str(name) for name in (told if isinstance(told, list) else [told])}
    names |= {name for row in rows if row.get("privileged") for name in row["privileged"].split(", ")}
    return one_line(", ".join(sorted(names)), 200)


def _run_files(run: Path) -> list[Path]:
    """Return the files of a finished run that belong in a pack: tables first."""
    facts = read_provenance(run)
    rows, wanted = (
        read_table(run / "episodes.csv", "a table that `arena run` wrote")[1],
        facts["config"].get("episodes"),
    )
    if seeing := seeing_parts(facts, rows):
        raise InputFileError(f"{run}: {seeing} saw the truth; allowed: runs of what sees sensors alone")
    if len(rows) != wanted:
        raise InputFileError(
            f"{run}: holds {len(rows)} episodes of a run of {wanted}; allowed: finished runs, resume=true finishes one"
        )
    parts = [*record_paths(run), *timing_paths(run), *sorted((run / "worlds").glob("[0-9a-f]*.npz"))]
    found = [run / "episodes.csv", run / "provenance.json", *parts]
    for path in found:
        check_inside(run, path)
    return found


def _check_digests(path: Path, archive: Archive, facts: Any) -> str:
    """Return the pack's digest; raise InputFileError unless every file is as it was when it was packed."""
    if not isinstance(facts, dict) or (facts.get("format"), facts.get("version")) != (FORMAT, VERSION):
        raise InputFileError(f"{path}: {FACTS} is not that of a pack; allowed: format {FORMAT}, version {VERSION}")
    digests = facts.get("files")
    if (
        not isinstance(digests, dict)
        or set(digests) != set(archive.names) - {FACTS}
        or digest_of(digests) != facts.get("digest")
    ):
        raise InputFileError(f"{path}: holds other files than it says; allowed: {ALLOWED}")
    for name, digest in digests.items():
        if archive.digest_of(name) != digest:
            raise InputFileError(f"{path}: {name} is not as it was packed; allowed: {ALLOWED}")
    return str(facts["digest"])


def _read_run(path: Path, archive: Archive, folder: Path, name: str) -> PackedRun:
    place = folder / name
    lacking = [file for file in TABLES if not (place / file).exists()]
    if lacking:
        raise InputFileError(f"{path}: lacks {name}/{lacking[0]}; allowed: {ALLOWED}")
    facts, rows = read_provenance(place), read_table(place / "episodes.csv", ALLOWED)[1]
    if seeing := seeing_parts(facts, rows):
        raise InputFileError(f"{path}: {one_line(name)} is a run in which {seeing} saw the truth; allowed: {ALLOWED}")
    mappings = [facts.get("config"), facts.get("versions"), facts.get("machine"), facts.get("code")]
    numbers = [str(facts["config"]["seed"]), *(row.get("episode", "") for row in rows)]
    if not all(isinstance(part, dict) for part in mappings) or not all(number.isdecimal() for number in numbers):
        raise InputFileError(f"{path}: {one_line(name)} is no run; allowed: {ALLOWED}")
    return PackedRun(name, rows, facts, [file for file in archive.names if file.startswith(f"{name}/")])
