"""``arena world measure``: how difficult a map is."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import ClassVar

from arena_core.commands import Command, align_columns, read_words
from arena_core.parameters import Positive
from arena_worlds.commands.convert import DEFAULTS
from arena_worlds.commands.measures import Measures, measures_of
from arena_worlds.formats.site_file import site_grid

ROBOT_RADIUS = 0.35  # m, as in the YAML of generated worlds
USAGE = f"arena world measure MAP.yaml [robot_radius={ROBOT_RADIUS}]"


class MeasureCommand(Command):
    """Read a map and print its measures."""

    help: ClassVar[str] = f"how difficult a map is: {USAGE}"

    def run(self, arguments: Sequence[str]) -> int:
        """Print the measures of a world in any format that ``convert`` reads; raise ArenaError (one line)
        for a wrong file or word.
        """
        words = read_words(USAGE, arguments, names=1, keys=["robot_radius"])
        radius = words.value("robot_radius", Positive, ROBOT_RADIUS)
        grid = site_grid(Path(words.names[0]), DEFAULTS["resolution"], DEFAULTS["margin"])
        print(measures_table(measures_of(grid, radius)))
        return 0


def measures_table(measures: Measures) -> str:
    """Return the measures as aligned text."""
    rows = [
        (name, f"{value:.3g}" if value < 100 else f"{value:.0f}", unit, text)
        for name, value, unit, text in measures.rows()
    ]
    return "\n".join(align_columns(rows, right=[1]))
