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
from arena_tuning.pareto import rank
from arena_tuning.problems import Problem

LOST = 0.1  # p of a two-sided test of pairs at which the worse one is dropped
Values = Mapping[str, Any]
Worth = tuple[float, ...]  # by each objective
Scores = Mapping[Problem, Worth | None]  # None where an episode ended with an error
Drive = Callable[[Sequence[Values], Sequence[Problem]], Sequence[Scores]]


@dataclass(slots=True, eq=False)
class Entrant:
    """A set of values in a race: what it is worth on each problem, and after how many blocks it was dropped, if it was.

    ``failed`` once an episode ended with an error that the present values drove without one.
    """

    values: Values
    scores: dict[Problem, Worth | None] = field(default_factory=dict)
    blocks: int = 0
    failed: bool = False

    def advantages(self, present: Scores) -> Worth:
        """Return by how much it is better than the present values by each objective, the means over the problems that
        both drove; nothing where there are none.
        """
        drove = ((score, present.get(problem)) for problem, score in self.scores.items())
        pairs = [(one, base) for one, base in drove if one is not None and base is not None]
        count = len(pairs[0][0]) if pairs else 0
        return tuple(fmean(one[k] - base[k] for one, base in pairs) for k in range(count))

    def advantage(self, present: Scores) -> float:
        """Return the same by the first objective alone, NaN where there is none."""
        found = self.advantages(present)
        return found[0] if found else math.nan


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
    ranked = [alive[place] for place in rank([one.advantages(present) for one in alive])]
    best = ranked[0] if ranked else None
    return [one for one in ranked[: _survivors(len(ranked))] if one is best or not (best and loses(one, best))]


def loses(one: Entrant, other: Entrant) -> bool:
    """Return whether one is worse than another on the same problems by each objective, by more than chance."""
    drove = [(score, other.scores.get(problem)) for problem, score in one.scores.items()]
    pairs = [(mine, theirs) for mine, theirs in drove if mine is not None and theirs is not None]
    return bool(pairs) and all(
        is_worse([mine[k] for mine, _ in pairs], [theirs[k] for _, theirs in pairs]) for k in range(len(pairs[0][0]))
    )


def is_worse(mine: Sequence[float], theirs: Sequence[float]) -> bool:
    """Return whether one is worse than another in pairs, by more than chance."""
    found = compare(mine, theirs)
    return bool(found.difference.mean < 0.0 and found.p <= LOST)


def _survivors(count: int) -> int:
    return math.ceil(count / 2)
