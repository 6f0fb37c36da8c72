"""``arena break``: problems in which a planner fails and the clairvoyant does not."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

from arena_core import ConfigurationError
from arena_core.commands import Command, align_columns, complete_overrides, print_notice, read_words
from arena_core.files import csv_text, write_text_whole
from arena_core.hosting import load_registry, lock_folder, require_extra
from arena_core.parameters import PositiveInt

if TYPE_CHECKING:
    from arena_break.request import Request
    from arena_core.hosting import Registry

USAGE = (
    "arena break planner=NAME robot=NAME [world=warehouse] [budget=480] [count=12] [seed=0] [bounds=FILE.yaml] "
    "[out=DIR] [resume=true] [KEY=VALUE ...], or arena break join DIR... out=DIR [share=N], "
    "or arena break table DIR... [out=FILE.csv]"
)
OWN = ("planner", "robot", "world", "budget", "count", "seed", "bounds", "out")
KEYS = (*OWN, "resume")
NEEDED = ("ribs",)
CANDIDATES = 4  # times as many as are wanted are confirmed: under its name in the pack a problem has other noise


class BreakCommand(Command):
    """Search hard problems against a planner."""

    help: ClassVar[str] = (
        "problems in which a planner fails and the clairvoyant does not: arena break planner=teb robot=jackal"
    )
    kept: ClassVar[str] = "finished episodes are kept, resume=true (with the same words) goes on from there"

    def run(self, arguments: Sequence[str]) -> int:
        """Search, shrink, confirm, certify, and write a scenario pack with its card."""
        if not arguments or any(word in ("-h", "--help") for word in arguments):
            print(f"usage: {USAGE}")
            return 0
        if arguments[0] in ACTIONS:
            for line in ACTIONS[arguments[0]](arguments[1:]):
                print(line)
            return 0
        require_extra("arena break", NEEDED, "arena-metrics[break]")
        from arena_break.request import open_folder, read_request

        words = read_words(USAGE, arguments, keys=KEYS, overrides=None)
        resume = words.value("resume", bool, False)
        registry = load_registry()
        request = read_request(words, registry)
        with lock_folder(request.folder):
            open_folder(request, resume=resume)
            search_and_prove(request, registry)
        return 0

    def complete(self, words: Sequence[str], word: str) -> Sequence[str]:
        """Return own keys and overrides; folders are the shell's."""
        if words and words[0] in ACTIONS:
            return ["out=", "share="] if words[0] == "join" else ["out="]
        if not words:
            return [*ACTIONS, *(f"{key}=" for key in KEYS), *complete_overrides(words, word)]
        return [*(f"{key}=" for key in KEYS), *complete_overrides(words, word)]


def _join(arguments: Sequence[str]) -> list[str]:
    """Join the packs of searches; return what to print."""
    from arena_break.joining import join_packs

    words = read_words(USAGE, arguments, names=None, keys=("out", "share"))
    if not words.names:
        raise ConfigurationError(f"DIR is missing; allowed: {USAGE}")
    return join_packs(
        list(map(Path, words.names)), Path(words.required("out")), words.value("share", PositiveInt, None)
    )


def _compare(arguments: Sequence[str]) -> list[str]:
    """Return how planners do on hard problems, and write it where that is asked for."""
    from arena_break.comparing import comparison_table, read_drives

    words = read_words(USAGE, arguments, names=None, keys=("out",))
    if not words.names:
        raise ConfigurationError(f"DIR is missing; allowed: {USAGE}")
    table = comparison_table(read_drives(list(map(Path, words.names))))
    if "out" in words.keys:
        write_text_whole(Path(words.keys["out"]), csv_text(table))
    return align_columns(table)


ACTIONS: Mapping[str, Callable[[Sequence[str]], list[str]]] = {"join": _join, "table": _compare}


def search_and_prove(request: Request, registry: Registry) -> None:
    """Carry out a request and write its results to its folder."""
    from arena_break.choosing import choose
    from arena_break.confirming import confirm, shrink
    from arena_break.driving import Site
    from arena_break.results import prove, renamed, write_ground, write_results
    from arena_break.searching import run_search

    bounds, folder = request.bounds, request.folder
    site = Site(write_ground(request), request.words, (bounds.margin.people, bounds.margin.walls))
    search = run_search(request.course, site, folder / "search", (request.budget, request.seed), print_notice)
    chosen = choose(search.hard, CANDIDATES * request.count)
    problems = renamed([one.draft.problem for one in chosen], request.name, request.seed)
    found_as = {one.name: each.draft.problem.name for one, each in zip(problems, chosen, strict=True)}
    keys, margin = bounds.keys, bounds.margin.people
    all_hard = list(confirm(site, folder / "confirmed", problems, keys, margin).values())
    print_notice(
        f"{len(all_hard)} of {len(problems)} chosen problems are hard under each of {len(keys)} seeds of noise"
    )
    hard = all_hard[: request.count]
    small = shrink(site, folder / "shrunk", [one.problem for one in hard], keys, margin)
    less = [small[one.problem.name] for one in hard if small[one.problem.name] is not one.problem]
    again = confirm(site, folder / "confirmed_small", less, keys, margin)
    kept = [again[one.problem.name].problem if one.problem.name in again else one.problem for one in hard]
    counts = {"chosen": len(problems), "confirmed": len(all_hard), "shrunk": len(again)}
    proven = prove(request, site, kept, found_as, registry) if kept else []
    for line in write_results(request, search, counts, proven):
        print(line)
    if not kept:
        print(f"{search.tried} problems, {search.failures} failures: no problem is hard; allowed: a greater budget")
        return
    print(
        f"written: {folder / 'pack'}; arena run planner={request.facts['preset']} robot={request.facts['robot']} "
        f"world=ros_map world.path={site.map_file} task=scenario "
        f"task.path={folder / 'pack' / 'scenarios' / request.name}.json episodes={len(kept)}"
    )
