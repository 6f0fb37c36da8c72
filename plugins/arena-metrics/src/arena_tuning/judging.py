"""The winner of a search: chosen among finalists on other problems, and judged once on yet others, in pairs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from arena_core.statistics import ALPHA, Comparison, after_holm, compare
from arena_tuning.driving import Driver
from arena_tuning.journal import Values
from arena_tuning.pareto import front_of, rank
from arena_tuning.problems import Problem, ProblemSets, problems_of
from arena_tuning.racing import Entrant, Scores, Worth, is_worse
from arena_tuning.study import Search

FIGURES: Mapping[str, bool] = {  # of a test, where the metric packs have them: whether they are proportions
    "strict_success": True,
    "success": True,
    "collisions": False,
    "collisions_people": False,
    "time_to_goal": False,
}


RULE = (
    "of the points that no other one dominates, those that are not worse than the best one by the first objective by "
    "more than chance, of these likewise by the next ones, and by the last one the best"
)
EACH = "better by one objective at least (after Holm) and worse by none, by more than chance"


@dataclass(frozen=True, slots=True, eq=False)
class Finalist:
    """A set of values that was driven on validation: its gains over the present values by each objective, whether no
    other finalist dominates it, and what it was worth on each problem.
    """

    values: Values
    gains: Worth
    undominated: bool
    scores: Scores


@dataclass(frozen=True, slots=True, eq=False)
class Judgement:
    """What came of choosing and judging: the winner where there is one, and by how much it beats the present values by
    each objective.
    """

    winner: Values | None
    validation: Sequence[Finalist]
    comparisons: Sequence[Comparison]
    figures: Mapping[str, Mapping[str, float]]
    episodes: Mapping[str, int]

    @property
    def better(self) -> bool:
        """Return whether the winner beats the present values by more than chance: by one of several objectives, and
        then is worse by none.
        """
        gains = any(one.difference.mean > 0.0 and one.holm <= ALPHA for one in after_holm(self.comparisons))
        return gains and not any(one.difference.mean < 0.0 and one.p <= ALPHA for one in self.comparisons)

    @property
    def sentence(self) -> str:
        """Return what is to be said of it, in one line."""
        if not self.comparisons:
            return "no set of values was better than the present ones on the problems of validation: nothing to write"
        told = "; ".join(map(_told, after_holm(self.comparisons)))
        pairs = f"{self.comparisons[0].difference.n} pairs"
        return f"{'better' if self.better else 'not better'} than the present values, on test {told}, {pairs}"


def _told(one: Comparison) -> str:
    found = one.difference
    return f"{found.mean:+.4f} [{found.low:+.4f}, {found.high:+.4f}], p {one.holm:.3g}"


def judge_search(search: Search, finalists: int, sets: ProblemSets, driver: Driver) -> Judgement:
    """Choose the winner on the problems of ``validate``, and compare it once with the present values on ``test``."""
    chosen = [one for one in search.whole if _gains(one.advantages(search.scores))][:finalists]
    validate = problems_of(sets, "validate", sets.validate.problems)
    episodes = {"validate": len(validate) * (len(chosen) + 1) if chosen else 0, "test": 0}
    validation = _validate(chosen, search.present, validate, driver)
    winner = choose([one for one in validation if one.undominated and _gains(one.gains)])
    if winner is None:
        return Judgement(None, validation, [], {}, episodes)
    values, test = winner.values, problems_of(sets, "test", sets.test.problems)
    driver.drive([search.present, values], test)
    pairs = [(driver.score(values, one), driver.score(search.present, one)) for one in test]
    both = [(mine, theirs) for mine, theirs in pairs if mine is not None and theirs is not None]
    failed = any(mine is None and theirs is not None for mine, theirs in pairs)
    count = 0 if failed or not both else len(both[0][0])
    comparisons = [compare([mine[k] for mine, _ in both], [theirs[k] for _, theirs in both]) for k in range(count)]
    figures = _compare_figures(values, search.present, test, driver)
    episodes["test"] = 2 * len(test)
    return Judgement(None if failed else values, validation, comparisons, figures, episodes)


def choose(points: Sequence[Finalist]) -> Finalist | None:
    """Return the chosen one of some points that do not dominate each other, after ``RULE``; None where there is
    none.
    """
    left = list(points)
    for k in range(len(left[0].gains) if left else 0):
        best = max(left, key=lambda one: one.gains[k])
        left = [one for one in left if one is best or not _is_behind(one, best, k)]
        last = best
    return last if left else None


def _is_behind(one: Finalist, best: Finalist, objective: int) -> bool:
    pairs = [(score, best.scores[problem]) for problem, score in one.scores.items()]
    known = [(mine[objective], theirs[objective]) for mine, theirs in pairs if mine is not None and theirs is not None]
    return is_worse([mine for mine, _ in known], [theirs for _, theirs in known])


def _gains(advantages: Worth) -> bool:
    """Return whether a set of values is better than the present ones by any objective."""
    return any(one > 0.0 for one in advantages)


def _validate(
    chosen: Sequence[Entrant], present: Values, problems: Sequence[Problem], driver: Driver
) -> list[Finalist]:
    """Return the finalists with their gains on other problems, the best first; those that failed are left out."""
    if not chosen:
        return []
    base, *others = driver.drive([present, *(one.values for one in chosen)], problems)
    sound = [
        Entrant(one.values, dict(scores))
        for one, scores in zip(chosen, others, strict=True)
        if not any(scores[problem] is None and base[problem] is not None for problem in problems)
    ]
    gains = [one.advantages(base) for one in sound]
    front = front_of(gains)
    return [Finalist(sound[k].values, gains[k], k in front, sound[k].scores) for k in rank(gains)]


def _compare_figures(
    winner: Values, present: Values, problems: Sequence[Problem], driver: Driver
) -> dict[str, dict[str, float]]:
    """Return figures of both on the problems of a test: means of each, the paired difference, its interval and p."""
    rows = [[driver.row(values, problem) for problem in problems] for values in (winner, present)]
    found = {}
    for name, proportion in FIGURES.items():
        mine, theirs = ([_figure(row, name) for row in one] for one in rows)
        if all(value == value for value in (*mine, *theirs)) or name == "time_to_goal":
            told = compare(mine, theirs, "proportion" if proportion else "figure")
            found[name] = {"tuned": _mean(mine), "present": _mean(theirs), **_interval(told)}
    return found


def _figure(row: Mapping[str, Any], name: str) -> float:
    value = row.get(name, "")
    return float(value) if value not in ("", None) else float("nan")


def _mean(values: Sequence[float]) -> float:
    known = [value for value in values if value == value]
    return sum(known) / len(known) if known else float("nan")


def _interval(told: Comparison) -> dict[str, float]:
    found = told.difference
    return {"difference": found.mean, "low": found.low, "high": found.high, "p": told.p, "pairs": float(found.n)}
