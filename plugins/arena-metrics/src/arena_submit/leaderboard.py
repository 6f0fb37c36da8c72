"""The table of packs that stand: by success, each with the ranks that its pairs with all others leave it and with its
score card.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import combinations
from pathlib import Path

from arena_core import InputFileError
from arena_core.hosting import Registry
from arena_core.statistics import Comparison, after_holm
from arena_metrics.pooling.runs import Column
from arena_metrics.tables.pairs import Pair, compare_pairs, metric_pairs
from arena_submit.breaking import breaking_lines
from arena_submit.cards import HEAD, STRICT, SUCCESS, ScoreCard, read_card_set
from arena_submit.limit import read_limit
from arena_submit.markdown import markdown_table
from arena_submit.packing import Pack
from arena_submit.seasons import Sealed, pack_entry, published_text, read_entries
from arena_submit.standing import Part, Standing, benchmark_of, check_standing, condition_of, planner_of

RANKED = [
    "rank",
    "planner",
    "success",
    "95 %",
    "behind the first",
    "no collision",
    "collisions",
    "time to goal",
    "CPU a step",
    "CPU p99",
    "tuned",
    "learned by",
    "code",
    "pack",
]
INTRODUCTION = """\
# Leaderboard: {name}

Written by `arena leaderboard` from packs that `arena submit` made; [Leaderboard](../leaderboard.md) says how to \
take part.

{parts}

Every two planners are compared by their successes in pairs, p after Holm among all pairs{each}: a rank begins after all
that surely succeed more often, and ends before all that surely succeed less often. "Behind the first" is the difference
to the first line, in points with its 95 % interval. Times to the goal are of successes; CPU is of the planner alone, on
whatever machine drove it, p99 the mean over episodes.
"""
STRICTLY = "\nPlanners are ranked by episodes without any contact."
SEALED = """\
The seed was not known before {opens}. An entry is a digest of a planner's configuration on each robot and of the code;
it is late where it was not published before that day. Published entries: {where}.
"""
OWN = "\nProblems that were searched against the planner of a line itself are left out of it, and of its pairs."


def leaderboard_page(
    packs: Sequence[Pack],
    registry: Registry,
    reference: Path | None = None,
    sealed: Sealed | None = None,
    entries: Path | None = None,
) -> str:
    """Return the page in Markdown, with a row of the certificates beside the runs of ``reference``; of a season with
    when each planner was published, by the file ``entries``.

    Raises InputFileError where a pack is not whole, packs are of different benchmarks, or the reference is of another.
    """
    wanted = _common_standing(packs, sealed)
    published = None if sealed is None else _season_lines(packs, sealed, entries)
    for pack in packs:
        check_standing(pack, wanted, registry)
    together = read_card_set(packs)
    cards = _best_first(together.cards)
    limits = [] if reference is None else [read_limit(reference, wanted, registry)]
    parts = "\n".join(map(_part_line, wanted.parts))
    each = " of a table" if wanted.tables else ""
    name = wanted.experiment if sealed is None else f"{wanted.experiment}, season {sealed.season}"
    lines = [INTRODUCTION.format(name=name, parts=parts, each=each)]
    for start in wanted.tables or [""]:
        lines += _table_lines(wanted, start, cards, limits, together.columns)
    lines += [*breaking_lines(cards), *(published or [])]
    lines += [_limit_sentence(card, wanted) for card in limits]
    for card in [*cards, *limits]:
        digest = f" ({card.digest[:12]})" if card.digest else ""
        lines += ["", f"## {card.planner}{digest}", "", *markdown_table(HEAD, card.rows(wanted.tables))]
    return "\n".join(lines) + "\n"


def _part_line(part: Part) -> str:
    """Return what a planner drives of one experiment."""
    counts = [
        f"{count} {name}{'' if count == 1 else 's'}"
        for count, name in ((len(part.scenarios), "scenario"), (part.episodes, "episode"))
    ]
    return f"- `{part.experiment}`: {counts[0]} of {counts[1]} with {', '.join(part.robots)}"


def _table_lines(
    wanted: Standing,
    start: str,
    cards: Sequence[ScoreCard],
    limits: Sequence[ScoreCard],
    columns: Mapping[str, Column],
) -> list[str]:
    """Return a table of ranks, of the scenarios that begin as ``start`` says."""
    column = STRICT if start in wanted.strict else SUCCESS
    shown = _best_first([card.only(start).without_own(wanted.searched) for card in cards], column)
    compared = _compare_cards(shown, columns[column])
    certified = [card.only(start) for card in limits]
    rows = [*_ranked_rows(shown, compared, column), *(_limit_row(card, column) for card in certified if card.cells)]
    head = [*RANKED]
    if column == STRICT:
        first, other = head.index("success"), head.index("no collision")
        head[first], head[other] = head[other], head[first]
    title = ["", f"## {wanted.tables[start]}", ""] if wanted.tables else []
    own = [OWN] if start and any(name.startswith(start) for name in wanted.searched) else []
    return [*title, *markdown_table(head, rows), *([STRICTLY] if column == STRICT else []), *own]


def _best_first(cards: Sequence[ScoreCard], column: str = SUCCESS) -> list[ScoreCard]:
    return sorted(cards, key=lambda card: (-card.success(column=column).mean, card.planner, card.digest))


def _season_lines(packs: Sequence[Pack], sealed: Sealed, entries: Path | None) -> list[str]:
    """Return a section with the entry of each pack, and whether it was published before the season opened."""
    known = None if entries is None else read_entries(entries)
    found = [(pack, pack_entry(pack, sealed.standing)) for pack in packs]
    rows = [
        [planner_of(pack.runs[0]), pack.digest[:12], entry, published_text(entry, known, sealed.opens)]
        for pack, entry in found
    ]
    where = SEALED.format(opens=sealed.opens, where="nowhere" if known is None else known.where)
    return ["", "## Entries", "", where, *markdown_table(["planner", "pack", "entry", "published"], rows)]


def _common_standing(packs: Sequence[Pack], sealed: Sealed | None = None) -> Standing:
    if not packs:
        raise InputFileError("no pack given; allowed: files that `arena submit` wrote")
    found = {pack.path: benchmark_of(pack) if sealed is None else sealed.standing for pack in packs}
    for path, wanted in found.items():
        if wanted is None:
            raise InputFileError(
                f"{path}: is of no standing benchmark; allowed: packs of one, such as experiment=arena_v1"
            )
    first = found[packs[0].path]
    other = [path for path, wanted in found.items() if wanted != first]
    if other or first is None:
        raise InputFileError(
            f"{other[0]}: is of another benchmark than {packs[0].path}; allowed: packs of one benchmark"
        )
    digests = [pack.digest for pack in packs]
    if len(set(digests)) < len(digests):
        raise InputFileError("a pack is given twice; allowed: each once")
    return first


Couple = tuple[int, int]  # numbers of two cards, that of the better one first


def _compare_cards(cards: Sequence[ScoreCard], success: Column) -> dict[Couple, Comparison]:
    """Compare the successes of every two cards in pairs, p after Holm among all of them."""
    couples = list(combinations(range(len(cards)), 2))
    found = after_holm([compare_pairs(_success_pairs(cards[i], cards[j], success), success) for i, j in couples])
    return dict(zip(couples, found, strict=True))


def _rank_ranges(count: int, compared: Mapping[Couple, Comparison]) -> list[tuple[int, int]]:
    """Return the best and the worst rank of each card: whom it is told apart from is surely before or behind it."""
    apart = [couple for couple, one in compared.items() if one.told_apart]
    first = [sum(worse == k for _, worse in apart) for k in range(count)]
    behind = [sum(better == k for better, _ in apart) for k in range(count)]
    return [(1 + before, count - after) for before, after in zip(first, behind, strict=True)]


def _ranked_rows(
    cards: Sequence[ScoreCard], compared: Mapping[Couple, Comparison], column: str = SUCCESS
) -> list[list[str]]:
    rows = []
    for k, (card, (best, worst)) in enumerate(zip(cards, _rank_ranges(len(cards), compared), strict=True)):
        name, _, success, interval, *others = card.row(card.planner, card.cells, column)
        rank = str(best) if best == worst else f"{best}–{worst}"
        behind = _points_text(compared[0, k]) if k else "–"
        rows.append([rank, name, success, interval, behind, *others, *card.origin, card.code, card.digest[:12]])
    return rows


def _limit_row(card: ScoreCard, column: str = SUCCESS) -> list[str]:
    """Return the row of what knows everybody's future, which has no rank."""
    name, _, success, interval, *others = card.row(card.planner, card.cells, column)
    return ["–", name, success, interval, "–", *others, "–", "–", card.code, "–"]


def _limit_sentence(card: ScoreCard, wanted: Standing) -> str:
    certified, problems = card.success().n, wanted.problems
    return (
        "\nThe last line is no competitor: it is what [the clairvoyant](../clairvoyant.md), who knows everybody's\n"
        f"future, drove in the {certified} of {problems} problems for which it found a certificate."
    )


def _points_text(one: Comparison) -> str:
    """Return how many points of success the second of two is behind the first, with the interval."""
    found = one.difference
    points = [100.0 * value for value in (found.mean, found.low, found.high)]
    mean, low, high = (f"{value + 0.0:.0f}".replace("-0", "0").replace("-", "−") for value in points)
    return f"{mean} ({low} to {high})" if found.has_interval else mean


def _success_pairs(first: ScoreCard, second: ScoreCard, success: Column) -> list[Pair]:
    theirs = {condition_of(cell.config): cell for cell in second.cells}
    both = [(cell, theirs[key]) for cell in first.cells if (key := condition_of(cell.config)) in theirs]
    return [pair for cell, base in both for pair in metric_pairs(cell, base, success)]
