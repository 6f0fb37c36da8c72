"""``arena world measure``: how difficult a map is."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import ClassVar

from arena_core import Command, ConfigurationError
from arena_worlds.convert import DEFAULTS
from arena_worlds.measures import Measures, measures_of
from arena_worlds.site_file import site_grid
from arena_worlds.words import key_values, measure

ROBOT_RADIUS = 0.35  # m, as in the YAML of generated worlds


class MeasureCommand(Command):
    """Read a map and print its measures."""

    help: ClassVar[str] = f"how difficult a map is: arena world measure MAP.yaml [robot_radius={ROBOT_RADIUS}]"

    def run(self, arguments: Sequence[str]) -> int:
        """Print the measures of a world in any format that ``convert`` reads; raise ArenaError (one line) for a wrong file or word."""
        files = [Path(word) for word in arguments if "=" not in word]
        words = key_values([word for word in arguments if "=" in word])
        unknown = sorted(words.keys() - {"robot_radius"})
        if len(files) != 1 or unknown:
            wrong = f"no key {unknown[0]}" if unknown else f"{len(files)} files"
            raise ConfigurationError(f"arena world measure has {wrong}; allowed: MAP.yaml [robot_radius=M]")
        grid = site_grid(files[0], DEFAULTS["resolution"], DEFAULTS["margin"])
        print(table(measures_of(grid, measure(words, "robot_radius", ROBOT_RADIUS))))
        return 0


def table(measures: Measures) -> str:
    """Return the measures as aligned text."""
    rows = [(name, f"{value:.3g}" if value < 100 else f"{value:.0f}", unit, text) for name, value, unit, text in measures.rows()]
    width = max(len(name) for name, *_ in rows)
    return "\n".join(f"{name:{width}}  {value:>6} {unit:2}  {text}" for name, value, unit, text in rows)
