"""``arena ladder``: among how many people a planner breaks."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

from arena_core import ConfigurationError
from arena_core.commands import Command, complete_overrides, print_notice, read_words
from arena_core.parameters import Positive, PositiveInt

if TYPE_CHECKING:
    from arena_core.commands import Words

USAGE = (
    "arena ladder planner=NAME robot=NAME [out=DIR] [resume=true] [cap=N] [precision=SHARE] [worlds=NAME,...] "
    "[crowds=NAME,...] [reference=clairvoyant] [KEY=VALUE ...], or arena ladder report DIR... [out=DIR]"
)
KEYS = ("out", "resume", "cap", "precision", "worlds", "crowds")
OWN = (
    "task.density",
    "task.rung",
    "seed",
    "episodes",
    "world",
    "people",
    "task",
    "experiment",
    "report",
)  # the ladder chooses them


class LadderCommand(Command):
    """Find the breaking density of a planner on a robot, or compare several."""

    help: ClassVar[str] = "among how many people a planner breaks: arena ladder planner=NAME robot=NAME"

    def run(self, arguments: Sequence[str]) -> int:
        """Drive a ladder, or report on some; print what came of it and return 0."""
        if not arguments or any(word in ("-h", "--help") for word in arguments):
            print(f"usage: {USAGE}")
            return 0
        if arguments[0] == "report":
            return _report(read_words(USAGE, arguments[1:], names=None, keys=("out",)))
        return _drive(read_words(USAGE, arguments, names=0, keys=KEYS, overrides=None))

    def complete(self, words: Sequence[str], word: str) -> Sequence[str]:
        """Return what configuration may follow; folders are the shell's."""
        return complete_overrides(words, word)


def _drive(words: Words) -> int:
    from arena_core.hosting import compose
    from arena_ladder.driving import EXPERIMENT, LadderFolder
    from arena_ladder.plan import make_plan

    given = {key: value for key, _, value in (word.partition("=") for word in words.overrides)}
    for key in ("planner", "robot"):
        if key not in given:
            raise ConfigurationError(f"{key} is missing; allowed: {USAGE}")
    for key in OWN:
        if key in given:
            raise ConfigurationError(f"{key} is given; allowed: keys that the ladder does not choose itself")
    plan = make_plan(
        words.keys.get("worlds"),
        words.keys.get("crowds"),
        words.value("cap", PositiveInt, None),
        words.value("precision", Positive, None),
    )
    place = words.keys.get("out", f"ladders/{_file_name(given['planner'])}_{_file_name(given['robot'])}")
    compose([*EXPERIMENT, *words.overrides])  # what is wrong with a word is said before anything is written
    ladder = LadderFolder(Path(place), plan, words.overrides)
    ladder.begin(resume=words.value("resume", bool, default=False))
    ladder.drive(_print_round)
    return _print_report([Path(place)], Path(place))


def _report(words: Words) -> int:
    if not words.names:
        raise ConfigurationError(f"DIR is missing; allowed: {USAGE}")
    folders = [Path(name) for name in words.names]
    return _print_report(folders, Path(words.keys.get("out", "ladder_report" if len(folders) > 1 else folders[0])))


def _print_report(folders: Sequence[Path], out: Path) -> int:
    from arena_ladder.page import write_page
    from arena_ladder.results import read_ladders

    ladders = read_ladders(folders)
    for line in write_page(ladders, out):
        print(line)
    return 0


def _print_round(number: int, due: Mapping[str, int]) -> None:
    print_notice(f"round {number + 1}: {len(due)} cells are open")


def _file_name(text: str) -> str:
    return re.sub(r"[^A-Za-z0-9_.-]+", "_", text)
