"""``arena world``: the work on worlds that needs no run; each subcommand is a command of its own."""

from __future__ import annotations

import importlib
from collections.abc import Sequence
from typing import ClassVar

from arena_core import ConfigurationError
from arena_core.commands import Command

SUBCOMMANDS = {
    "convert": "arena_worlds.commands.convert:ConvertCommand",
    "generate": "arena_worlds.commands.generate:GenerateCommand",
    "measure": "arena_worlds.commands.measure:MeasureCommand",
}


class WorldCommand(Command):
    """Hand the arguments to one of the subcommands."""

    help: ClassVar[str] = f"make and describe worlds: arena world {'|'.join(SUBCOMMANDS)} ..."

    def run(self, arguments: Sequence[str]) -> int:
        """Run the subcommand that the first argument names; raise ConfigurationError when there is none such."""
        if not arguments or arguments[0] in ("-h", "--help"):
            print(_usage_text())
            return 0
        name, *rest = arguments
        if name not in SUBCOMMANDS:
            raise ConfigurationError(f"arena world has no subcommand {name!r} (possible: {', '.join(SUBCOMMANDS)})")
        if "-h" in rest or "--help" in rest:
            print(load_subcommand(name).help)
            return 0
        return load_subcommand(name).run(rest)

    def complete(self, words: Sequence[str], word: str) -> Sequence[str]:
        """Return the subcommands, then what theirs return."""
        return (
            load_subcommand(words[0]).complete(words[1:], word)
            if words and words[0] in SUBCOMMANDS
            else ()
            if words
            else [*SUBCOMMANDS]
        )


def load_subcommand(name: str) -> Command:
    """Import and return a subcommand."""
    module, _, attribute = SUBCOMMANDS[name].partition(":")
    return getattr(importlib.import_module(module), attribute)()  # type: ignore[no-any-return]


def _usage_text() -> str:
    lines = [f"  {name:10} {load_subcommand(name).help}" for name in SUBCOMMANDS]
    return "\n".join(["usage: arena world SUBCOMMAND ...", "", *lines])
