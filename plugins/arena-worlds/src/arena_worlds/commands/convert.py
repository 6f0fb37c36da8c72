"""``arena world convert``: a world from one file format into another."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

from arena_core.commands import Command, read_words
from arena_core.parameters import Positive
from arena_worlds.formats.site_file import check_ending, read_site, write_site

USAGE = "arena world convert IN out=FILE [height=2.0] [resolution=0.05] [margin=1.0]"
DEFAULTS = {"height": 2.0, "resolution": 0.05, "margin": 1.0}  # m; walls as high as doors, cells as map_saver's


class ConvertCommand(Command):
    """Read a world and write it in the format that the ending of the second file tells."""

    help: ClassVar[str] = f"convert a world: {USAGE}"

    def run(self, arguments: Sequence[str]) -> int:
        """Write the file and print its name; raise ArenaError (one line) where a file or a word is wrong."""
        words = read_words(USAGE, arguments, names=None, keys=("out", *DEFAULTS))
        source, target = words.source_and_target()
        height, resolution, margin = (words.value(key, Positive, default) for key, default in DEFAULTS.items())
        check_ending(target)
        site = read_site(source, resolution)
        for written in write_site(target, site, resolution, margin, height):
            print(f"written: {written}")
        return 0
