"""``arena world convert``: a world from one file format into another."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import ClassVar

from arena_core import Command, ConfigurationError
from arena_worlds.site_file import check_ending, read_site, write_site
from arena_worlds.words import key_values, measure

DEFAULTS = {"height": 2.0, "resolution": 0.05, "margin": 1.0}  # m; walls as high as doors, cells as map_saver's


class ConvertCommand(Command):
    """Read a world and write it in the format that the ending of the second file tells."""

    help: ClassVar[str] = "convert a world: arena world convert IN OUT [height=2.0] [resolution=0.05] [margin=1.0]"

    def run(self, arguments: Sequence[str]) -> int:
        """Write OUT and print its name; raise ArenaError (one line) where a file or a word is wrong."""
        files = [Path(word) for word in arguments if "=" not in word]
        if len(files) != 2:
            raise ConfigurationError(f"arena world convert has {len(files)} files; allowed: IN OUT, then height=, resolution=, margin=")
        words = key_values([word for word in arguments if "=" in word])
        unknown = sorted(words.keys() - DEFAULTS.keys())
        if unknown:
            raise ConfigurationError(f"{unknown[0]} is no key of arena world convert; allowed: {', '.join(DEFAULTS)}")
        height, resolution, margin = (measure(words, key, default) for key, default in DEFAULTS.items())
        check_ending(files[1])
        site = read_site(files[0], resolution)
        for written in write_site(files[1], site, resolution, margin, height):
            print(f"written: {written}")
        return 0
