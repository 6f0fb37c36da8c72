"""Which of the hard problems of a search are kept: of every kind some, none twice, those with most room first."""

from __future__ import annotations

import math
from collections.abc import Sequence

from arena_break.judging import KINDS
from arena_break.searching import Found

ALIKE = 1.0  # m that start and goal of two problems differ by, so that they are two


def choose(hard: Sequence[Found], count: int) -> list[Found]:
    """Return up to ``count`` problems: kinds of failure take turns, within a kind the place along the way and the
    number of people do, and then those count first in which the clairvoyant has most room.
    """
    queues = [_in_turn([one for one in hard if one.worth.kind == kind]) for kind in range(len(KINDS))]
    found: list[Found] = []
    while len(found) < count and any(queues):
        for queue in queues:
            while queue and any(_alike(queue[0], one) for one in found):
                queue.pop(0)
            if queue and len(found) < count:
                found.append(queue.pop(0))
    return found


def _in_turn(hard: Sequence[Found]) -> list[Found]:
    """Return problems so that cells take turns, the best of each first."""
    ranked = sorted(hard, key=lambda one: (-one.worth.objective, one.draft.problem.name))
    cells: dict[tuple[int, int], list[Found]] = {}
    for one in ranked:
        _, people, place = one.worth.measures
        cells.setdefault((int(people), min(int(4.0 * place), 3)), []).append(one)
    rounds = [(depth, i, one) for i, cell in enumerate(cells.values()) for depth, one in enumerate(cell)]
    return [one for _, _, one in sorted(rounds, key=lambda entry: entry[:2])]


def _alike(one: Found, other: Found) -> bool:
    mine, theirs = one.draft.problem, other.draft.problem
    ends = ((mine.start, theirs.start), (mine.goal, theirs.goal))
    return all(math.hypot(a.x - b.x, a.y - b.y) < ALIKE for a, b in ends)
