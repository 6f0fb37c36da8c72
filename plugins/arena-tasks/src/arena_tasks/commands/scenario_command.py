"""``arena scenario``: what can be done with scenario files beside running them."""

from __future__ import annotations

from collections.abc import Sequence
from importlib import import_module
from typing import ClassVar

from arena_core.commands import Command
from arena_core.hosting import UnknownComponent

SUBCOMMANDS = {  # each a class of its own with ``help`` and ``run``, imported when it is used
    "check": "arena_tasks.commands.checking:CheckCommand",
    "convert": "arena_tasks.commands.converting:ConvertCommand",
    "show": "arena_tasks.commands.showing:ShowCommand",
    "draw": "arena_tasks.commands.drawing:DrawCommand",
    "pack": "arena_tasks.commands.packing:PackCommand",
}


class ScenarioCommand(Command):
    """Work on scenario files and packs."""

    help: ClassVar[str] = f"work on scenario files: arena scenario {'|'.join(SUBCOMMANDS)} ..."

    def run(self, arguments: Sequence[str]) -> int:
        """Hand over to the subcommand."""
        if not arguments or arguments[0] in ("-h", "--help"):
            print(
                "\n".join(
                    [
                        "usage: arena scenario COMMAND ...",
                        "",
                        *(f"  {name:10} {_load_subcommand(name).help}" for name in SUBCOMMANDS),
                    ]
                )
            )
            return 0
        name, *rest = arguments
        if name not in SUBCOMMANDS:
            raise UnknownComponent(f"unknown command 'scenario {name}' (possible: {', '.join(SUBCOMMANDS)})")
        return _load_subcommand(name).run(rest)

    def complete(self, words: Sequence[str], word: str) -> Sequence[str]:
        """Return the subcommands, then what theirs return."""
        return (
            _load_subcommand(words[0]).complete(words[1:], word)
            if words and words[0] in SUBCOMMANDS
            else ()
            if words
            else [*SUBCOMMANDS]
        )


def _load_subcommand(name: str) -> Command:
    module, _, attribute = SUBCOMMANDS[name].partition(":")
    command: Command = getattr(import_module(module), attribute)()
    return command
