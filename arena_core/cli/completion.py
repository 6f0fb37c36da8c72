"""``arena completion``: the script by which a shell completes `arena`, and the words that it asks for."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from importlib.resources import files
from typing import ClassVar

from arena_core.base.errors import ArenaError
from arena_core.config.registry import load_registry
from arena_core.contracts.running import Command

SHELLS = ("bash", "zsh")
CANDIDATES = "candidates"  # what the scripts ask for: the words after `arena`, the unfinished one last


class CompletionCommand(Command):
    """Print the script that completes `arena` in a shell: eval "$(arena completion bash)"."""

    help: ClassVar[str] = 'completion by TAB: eval "$(arena completion bash|zsh)"'

    def run(self, arguments: Sequence[str]) -> int:
        """Print a shell's script, or for such a script what may stand at the end of a line."""
        if arguments and arguments[0] == CANDIDATES:
            sys.stdout.writelines(f"{candidate}\n" for candidate in next_words(arguments[1:]))
            return 0
        parser = argparse.ArgumentParser("arena completion", description=self.__doc__)
        parser.add_argument("shell", choices=SHELLS)
        shell = parser.parse_args(list(arguments)).shell
        print((files("arena_core") / "shells" / f"arena.{shell}").read_text(encoding="utf-8"), end="")
        return 0

    def complete(self, words: Sequence[str], word: str) -> Sequence[str]:
        """Return the shells."""
        return SHELLS if not words else ()


def next_words(words: Sequence[str]) -> list[str]:
    """Return what the last of the words after `arena` can become, sorted; nothing where the
    words ahead of it are wrong.
    """
    registry = load_registry()
    *before, word = words or [""]
    try:
        command = registry.component("command", before[0]).resolve()() if before else None
        possible = command.complete(before[1:], word) if command else registry.names("command")
        return sorted(candidate for candidate in set(possible) if candidate.startswith(word))
    except ArenaError:
        return []
