"""Where runs lie, and the files of an episode in its run: a thousand beside each other, later ones in a
folder for each thousand.
"""

from __future__ import annotations

import re
from pathlib import Path

from arena_core.base.errors import InputFileError, one_line
from arena_core.base.files import AnyPath, reason_of

SHARD = 1000  # episodes of one folder: file systems, and people, are slow in folders of a hundred thousand files
PARTS = ("records", "timing")
OF_EPISODE = r"(?:\d{3,5}/)?\d{4,8}\.npz"  # below a part's folder
NUMBERED = re.compile(r"\d{3,5}")


def record_path(folder: AnyPath, episode: int) -> Path:
    """Return where the record of an episode lies in its run's folder: ``records/0007.npz``,
    ``records/012/12345.npz``.
    """
    return part_path(folder, "records", episode)


def timing_path(folder: AnyPath, episode: int) -> Path:
    """Return where an episode's wall-clock times lie."""
    return part_path(folder, "timing", episode)


def part_path(folder: AnyPath, part: str, episode: int) -> Path:
    """Return where a part of an episode lies, one of ``PARTS``."""
    folder, name = Path(folder), f"{episode:04d}.npz"
    return folder / part / name if episode < SHARD else folder / part / f"{episode // SHARD:03d}" / name


def record_paths(folder: AnyPath) -> list[Path]:
    """Return the records that a run's folder holds, in order of episode."""
    return part_paths(folder, "records")


def timing_paths(folder: AnyPath) -> list[Path]:
    """Return the files of wall-clock times that a run's folder holds, in order of episode."""
    return part_paths(folder, "timing")


def part_paths(folder: AnyPath, part: str) -> list[Path]:
    """Return the files of one part, one of ``PARTS``, in order of episode."""
    folder = Path(folder)
    found = [*(folder / part).glob("[0-9]*.npz"), *(folder / part).glob("[0-9][0-9][0-9]*/[0-9]*.npz")]
    return sorted((path for path in found if path.stem.isdecimal()), key=lambda path: int(path.stem))


def run_folder_of(record: Path) -> Path:
    """Return the run's folder in which a record lies."""
    above = record.parent
    return above.parent.parent if NUMBERED.fullmatch(above.name) and above.parent.name == "records" else above.parent


def timing_of(record: Path) -> Path:
    """Return where the times of a record's episode lie."""
    folder = run_folder_of(record)
    return folder / "timing" / record.relative_to(folder / record.relative_to(folder).parts[0])


def find_runs(directory: AnyPath) -> list[Path]:
    """Return every run's folder at or below ``directory``, sorted; raise InputFileError when there is none."""
    directory = Path(directory)
    try:
        there = directory.is_dir()
    except (OSError, ValueError) as error:  # a name that is too long, or that none can have
        raise InputFileError(f"{one_line(str(directory), 200)}: cannot be read ({reason_of(error)})") from None
    if not there:
        raise InputFileError(f"{directory}: no such folder; allowed: a folder that `arena run` wrote, or one above it")
    runs = sorted(path.parent for path in directory.rglob("episodes.csv"))
    if not runs:
        raise InputFileError(
            f"{directory}: no run below it (no episodes.csv); allowed: a folder that `arena run` wrote, or one above it"
        )
    return runs
