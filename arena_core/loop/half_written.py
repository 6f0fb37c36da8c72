"""What killed writers leave in a run's folder, and the room on the disk that is kept for its table."""

from __future__ import annotations

import re
from contextlib import suppress
from pathlib import Path

from arena_core.loop.record_places import NUMBERED, PARTS

HALF_WRITTEN = re.compile(r"\..+\.[0-9a-f]{8}")  # the names that write_whole gives
ROOM = ".room.00000000"  # goes wherever half-written files go


def keep_room(folder: Path, size: int) -> None:
    """Keep so many bytes of the disk free for a table, as far as they are there:
    ``remove_half_written`` gives them back.
    """
    with suppress(OSError), (folder / ROOM).open("xb") as file:
        file.write(bytes(size))


def remove_half_written(folder: Path) -> None:
    """Remove what killed writers left in a run's folder, and the room that was kept; no one may be writing there."""
    parts = [folder / name for name in PARTS]
    shards = [
        place for part in parts if part.is_dir() for place in sorted(part.iterdir()) if NUMBERED.fullmatch(place.name)
    ]
    for place in (folder, folder / "worlds", *parts, *shards):
        for path in place.glob(".*") if place.is_dir() and place.resolve().is_relative_to(folder.resolve()) else ():
            if HALF_WRITTEN.fullmatch(path.name) and path.is_file():
                with suppress(OSError):  # where nothing can be removed, it stays and harms no one
                    path.unlink()
