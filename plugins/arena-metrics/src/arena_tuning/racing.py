"""Races: sets of values drive growing blocks of problems, and those that lose are dropped after each.

Successive halving (Jamieson and Talwalkar 2016), with tests of pairs (Birattari et al. 2002).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from statistics import fmean
from typing import Any

from arena_core.statistics import compare
from arena_tuning.problems import Problem

LOST = 0.1  # p of a two-sided test of pairs at which the worse one is dropped
Values = Mapping[str, Any]
Scores = Mapping[Problem, float | None]  # None where an episode ended with an error
Drive = Callable[[Sequence[Values], Sequence[Problem]], Sequence[Scores]]


@dataclass(slots=True, eq=False)
class Entrant:
    """A set of values in a race: what it is worth on each problem, and after how many blocks it was dropped, if it was.

    ``failed`` once an episode ended with an error that the present values drove without one.
    """

    values: Values
    scores: dict[Problem, float | None] = field(default_factory=dict)
    blocks: int = 0
    failed: bool = False

    def advantage(self, present: Scores) -> float:
        """Return by how much it is better than the present values, the mean over the problems that both drove."""
        pairs = [one - base for one, base in self._pairs(present)]
        return fmean(pairs) if pairs else math.nan

    def _pairs(self, present: Scores) -> list[tuple[float, float]]:
        drove = ((score, present.get(problem)) for problem, score in self.scores.items())
        return [(one, base) for one, base in drove if one is not None and base is not None]


def cost_of_race(entrants: int, blocks: Sequence[int]) -> int:
    """Return how many episodes a race takes at most."""
    alive, before, cost = entrants, 0, 0
    for block in blocks:
        cost += alive * (block - before)
        alive, before = _survivors(alive), block
    return cost


def run_race(
    entrants: Sequence[Values], blocks: Sequence[int], problems: Sequence[Problem], present: Scores, drive: Drive
) -> list[Entrant]:
    """Race sets of values against each other and against the ``present`` ones, whose scores are known on all problems;
    return all of them.
    """
    found = [Entrant(values) for values in entrants]
    alive, before = list(found), 0
    for block in blocks:
        new = problems[before:block]
        for one, scores in zip(alive, drive([one.values for one in alive], new), strict=True):
            one.scores |= scores
            one.blocks += 1
            one.failed = any(score is None and present[problem] is not None for problem, score in one.scores.items())
        alive, before = [one for one in alive if not one.failed], block
        if block != blocks[-1]:
            alive = drop_losers(alive, present)
        if not alive:
            break
    return found


def drop_losers(alive: Sequence[Entrant], present: Scores) -> list[Entrant]:
    """Return those who go on: the better half, without those who are worse than the best by more than chance."""
    ranked = sorted(alive, key=lambda one: -_rank(one, present))
    best = ranked[0] if ranked else None
    return [one for one in ranked[: _survivors(len(ranked))] if one is best or not (best and loses(one, best))]


def loses(one: Entrant, other: Entrant) -> bool:
    """Return whether one is worse than another on the same problems, by more than chance."""
    drove = [(score, other.scores.get(problem)) for problem, score in one.scores.items()]
    pairs = [(mine, theirs) for mine, theirs in drove if mine is not None and theirs is not None]
    found = compare([mine for mine, _ in pairs], [theirs for _, theirs in pairs])
    return bool(found.difference.mean < 0.0 and found.p <= LOST)


def _rank(one: Entrant, present: Scores) -> float:
    worth = one.advantage(present)
    return worth if math.isfinite(worth) else -math.inf


def _survivors(count: int) -> int:
    return math.ceil(count / 2)
