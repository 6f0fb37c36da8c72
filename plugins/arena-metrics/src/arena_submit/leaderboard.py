"""The table of packs that stand: ranked by success, those that cannot be told apart on one
rank, with the score card of each.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

from arena_core import InputFileError
from arena_core.hosting import Registry
from arena_core.statistics import after_holm
from arena_metrics.pooling.runs import Column
from arena_metrics.tables.pairs import Pair, compare_pairs, metric_pairs
from arena_submit.cards import HEAD, ScoreCard, read_card_set
from arena_submit.packing import Pack
from arena_submit.standing import Standing, benchmark_of, check_standing

RANKED = [
    "rank",
    "planner",
    "success",
    "95 %",
    "no collision",
    "collisions",
    "time to goal",
    "CPU a step",
    "code",
    "pack",
]
INTRODUCTION = """\
# Leaderboard: {name}

Written by `arena leaderboard` from packs that `arena submit` made; [Leaderboard](../leaderboard.md) says how to \
take part.
{count} conditions of {episodes} episodes each: {robots}, {scenarios} scenarios. Planners on one rank cannot be \
told apart
by their successes in pairs (p after Holm among all pairs above .05). Times to the goal are of successes; CPU is of the
planner alone, on whatever machine drove it.
"""


def leaderboard_page(packs: Sequence[Pack], registry: Registry) -> str:
    """Return the page in Markdown; raise InputFileError where a pack is not whole,
    or packs are of different benchmarks.
    """
    wanted = _common_standing(packs)
    for pack in packs:
        check_standing(pack, wanted, registry)
    together = read_card_set(packs)
    cards = sorted(together.cards, key=lambda card: (-card.success().mean, card.planner, card.digest))
    ranks = _card_ranks(cards, together.columns["success"])
    lines = [
        INTRODUCTION.format(
            name=wanted.experiment,
            count=len(wanted.conditions),
            episodes=wanted.episodes,
            robots=" and ".join(wanted.robots),
            scenarios=len(wanted.scenarios),
        ),
        *_markdown_table(
            RANKED,
            [
                [str(rank), *_without_count(card.row(card.planner, card.cells)), card.code, card.digest[:12]]
                for rank, card in zip(ranks, cards, strict=True)
            ],
        ),
    ]
    for card in cards:
        lines += ["", f"## {card.planner} ({card.digest[:12]})", "", *_markdown_table(HEAD, card.rows())]
    return "\n".join(lines) + "\n"


def _common_standing(packs: Sequence[Pack]) -> Standing:
    if not packs:
        raise InputFileError("no pack given; allowed: files that `arena submit` wrote")
    found = {pack.path: benchmark_of(pack) for pack in packs}
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


def _card_ranks(cards: Sequence[ScoreCard], success: Column) -> list[int]:
    """Return the rank of each card, the best first: one that is not told apart from the first of a rank shares it."""
    couples = list(combinations(range(len(cards)), 2))
    found = after_holm([compare_pairs(_success_pairs(cards[i], cards[j], success), success) for i, j in couples])
    apart = {couple: one.told_apart for couple, one in zip(couples, found, strict=True)}
    ranks, leader = [1], 0
    for i in range(1, len(cards)):
        if apart[leader, i]:
            leader = i
        ranks.append(leader + 1)
    return ranks[: len(cards)]


def _success_pairs(first: ScoreCard, second: ScoreCard, success: Column) -> list[Pair]:
    theirs = {(cell.factors["robot"], cell.factors["scenario"]): cell for cell in second.cells}
    both = [(cell, theirs[cell.factors["robot"], cell.factors["scenario"]]) for cell in first.cells]
    return [pair for cell, base in both for pair in metric_pairs(cell, base, success)]


def _without_count(row: Sequence[str]) -> list[str]:
    return [row[0], *row[2:]]


def _markdown_table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
    lines = [head, ["---"] * len(head), *rows]
    return [f"| {' | '.join(cell.replace('|', '/') for cell in line)} |" for line in lines]
