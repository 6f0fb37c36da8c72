"""``arena submit``, ``arena verify`` and ``arena leaderboard``."""

from __future__ import annotations

import secrets
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from shutil import copyfileobj
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, ClassVar

from arena_core import ConfigurationError
from arena_core.commands import Command, complete_overrides, read_words
from arena_core.files import write_text_whole, write_whole
from arena_core.hosting import compose, load_registry, to_plain
from arena_core.parameters import NonNegativeInt, PositiveInt

if TYPE_CHECKING:
    from arena_core.commands import Words
    from arena_submit.seasons import Sealed
    from arena_submit.verification import Verification

SUBMIT = "arena submit RUN... [season=NAME value=HEX] out=FILE.zip"
VERIFY = "arena verify FILE.zip [sample=20] [seed=N] [executor.workers=N]"
LEADERBOARD = "arena leaderboard FILE.zip... [reference=DIR] [season=NAME value=HEX entries=FILE.yaml] [out=FILE.md]"
SEASON = "arena leaderboard season NAME [value=HEX] [planner=NAME and other overrides]"
SEASONS_OF = "arena_v2"  # the standing benchmark that has seasons
SAMPLE = 20  # episodes that are driven again
SHOWN = 20  # lines of what is wrong


def _print_help(arguments: Sequence[str], usage: str) -> bool:
    wanted = not arguments or any(word in ("-h", "--help") for word in arguments)
    if wanted:
        print(f"usage: {usage}")
    return wanted


class SubmitCommand(Command):
    """Pack finished runs into one file that anybody can verify."""

    help: ClassVar[str] = f"pack runs so that anybody can verify them: {SUBMIT}"

    def run(self, arguments: Sequence[str]) -> int:
        """Write the pack; print its digest and, where it is of a standing benchmark, its score card.

        One that is refused leaves no file, nor another in the place of one that is there.
        """
        if _print_help(arguments, SUBMIT):
            return 0
        words = read_words(SUBMIT, arguments, names=None, keys=("out", "season", "value"))
        target = Path(words.required("out"))
        if not words.names or target.suffix != ".zip":
            raise ConfigurationError(f"arguments are {' '.join(arguments)}; allowed: {SUBMIT}")
        there = next(folder for folder in target.absolute().parents if folder.is_dir())
        with TemporaryDirectory(prefix=".arena-submit-", dir=there) as draft:
            said = _pack_runs([Path(name) for name in words.names], Path(draft, target.name), target, _sealed(words))
            with Path(draft, target.name).open("rb") as file:
                write_whole(target, lambda written: copyfileobj(file, written))
        print(said)
        return 0


def _sealed(words: Words) -> Sealed | None:
    """Return the season that the words name, None where they name none; raise ConfigurationError for one of none."""
    if not {"season", "value"} & set(words.keys):
        return None
    from arena_submit.seasons import open_season
    from arena_submit.standing import read_standing

    return open_season(read_standing(SEASONS_OF), words.required("season"), words.required("value"))


def _pack_runs(folders: Sequence[Path], draft: Path, target: Path, sealed: Sealed | None) -> str:
    """Pack runs into a draft and check it as what it will be called; return what is said of it."""
    from arena_submit.cards import card_text, read_cards
    from arena_submit.packing import read_pack, write_pack
    from arena_submit.standing import benchmark_of, check_standing

    digest = write_pack(folders, draft)
    with read_pack(draft) as read:
        pack = replace(read, path=target)
        wanted, card = benchmark_of(pack) if sealed is None else sealed.standing, ""
        if wanted is not None:
            check_standing(pack, wanted, load_registry())
            card = f"{card_text(read_cards([pack])[0], wanted.tables)}\n"
        episodes = sum(len(run.rows) for run in pack.runs)
    of = (
        f", all of experiment={wanted.experiment}"
        if wanted
        else "; no standing benchmark: it can be verified, not ranked"
    )
    return f"{card}{target}: {episodes} episodes{of}\ndigest {digest}"


class VerifyCommand(Command):
    """Drive a random sample of a pack's episodes again and say whether the pack is true."""

    help: ClassVar[str] = f"drive a sample of a pack again: {VERIFY}"

    def run(self, arguments: Sequence[str]) -> int:
        """Print what was found; return 1 where the pack does not hold."""
        from arena_submit.packing import read_pack
        from arena_submit.verification import verify_pack

        if _print_help(arguments, VERIFY):
            return 0
        words = read_words(VERIFY, arguments, names=1, keys=("sample", "seed"), overrides=("executor",))
        sample = words.value("sample", PositiveInt, SAMPLE)
        seed = words.value("seed", NonNegativeInt, secrets.randbits(31))  # no one who packs knows what will be drawn
        executor = to_plain(compose(words.overrides))["executor"]
        with read_pack(Path(words.names[0])) as pack:
            print(f"digest {pack.digest}")
            found = verify_pack(pack, sample, seed, executor, load_registry())
        print("\n".join(verification_lines(found, seed)))
        return 0 if found.is_valid else 1

    def complete(self, words: Sequence[str], word: str) -> Sequence[str]:
        """Return the executor's keys; files are the shell's."""
        return complete_overrides(words, word) if word.startswith("executor") else ()


def verification_lines(found: Verification, seed: int) -> list[str]:
    """Return a verification's lines for a reader; the last one is the verdict."""
    lines = [
        f"rows: {found.rows - len(found.wrong_rows)} of {found.rows} are those of the records",
        *found.wrong_rows[:SHOWN],
    ]
    same = sum(one.same for one in found.repeated)
    agreeing = sum(one.agrees for one in found.repeated)
    lines.append(
        f"driven again: {len(found.repeated)} episodes (seed={seed}), {same} the same bit for bit, "
        f"{agreeing} alike in success"
    )
    lines += [f"{one.drawn.name}: {one.told}" for one in found.repeated if not one.same][:SHOWN]
    lines += [f"here is {line}" for line in found.elsewhere]
    how = (
        f"by outcome: {found.required_count} of {len(found.repeated)} have to end alike"
        if found.elsewhere
        else "bit for bit"
    )
    return [*lines, f"verified {how}" if found.is_valid else f"not verified {how}"]


class LeaderboardCommand(Command):
    """Rank packs of a standing benchmark."""

    help: ClassVar[str] = f"rank packs of a standing benchmark: {LEADERBOARD}"

    def run(self, arguments: Sequence[str]) -> int:
        """Write or print the table, in Markdown."""
        from contextlib import ExitStack

        from arena_submit.leaderboard import leaderboard_page
        from arena_submit.packing import read_pack

        if _print_help(arguments, f"{LEADERBOARD}\n       {SEASON}"):
            return 0
        if arguments[0] == "season":
            print("\n".join(_season_lines(arguments[1:])))
            return 0
        words = read_words(LEADERBOARD, arguments, names=None, keys=("out", "reference", "season", "value", "entries"))
        reference, entries = (Path(words.keys[key]) if key in words.keys else None for key in ("reference", "entries"))
        sealed = _sealed(words)
        if entries is not None and sealed is None:
            raise ConfigurationError(f"entries is {entries}; allowed with season=NAME value=HEX")
        with ExitStack() as stack:
            packs = [stack.enter_context(read_pack(Path(name))) for name in words.names]
            text = leaderboard_page(packs, load_registry(), reference, sealed, entries)
        if "out" not in words.keys:
            print(text, end="")
            return 0
        write_text_whole(Path(words.keys["out"]), text)
        print(words.keys["out"])
        return 0


def _season_lines(arguments: Sequence[str]) -> list[str]:
    """Return what a season is, with a planner the entry to publish, with the beacon's value how it is driven."""
    from arena_submit.seasons import find_season, open_season, planner_entry
    from arena_submit.standing import read_standing

    words = read_words(SEASON, arguments, names=1, keys=("value",), overrides=None)
    name, standing = words.names[0], read_standing(SEASONS_OF)
    season = find_season(standing, name)
    lines = [f"{name} opens on {season.opens} at 0:00 UTC with round {season.round} of {standing.beacon}"]
    if words.overrides:
        entry = planner_entry(standing, words.overrides, load_registry())
        lines.append(f"entry: {entry} (publish it before that day: {' '.join(words.overrides)})")
    if "value" in words.keys:
        value = words.keys["value"]
        seed, chosen = open_season(standing, name, value).standing.seed, " ".join(words.overrides) or "planner=NAME"
        lines += [
            f"arena run experiment={standing.experiment} seed={seed} {chosen} out=DIR",
            f"arena submit DIR season={name} value={value} out=FILE.zip",
        ]
    return lines
