"""The winner of a search: chosen among finalists on other problems, and judged once on yet others, in pairs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from arena_core.statistics import ALPHA, Comparison, compare
from arena_tuning.driving import Driver
from arena_tuning.journal import Values
from arena_tuning.problems import Problem, ProblemSets, problems_of
from arena_tuning.racing import Entrant
from arena_tuning.study import Search

FIGURES: Mapping[str, bool] = {  # of a test, where the metric packs have them: whether they are proportions
    "strict_success": True,
    "success": True,
    "collisions": False,
    "collisions_people": False,
    "time_to_goal": False,
}


@dataclass(frozen=True, slots=True, eq=False)
class Judgement:
    """What came of choosing and judging: the winner where there is one, and by how much it beats the present values."""

    winner: Values | None
    validation: Sequence[tuple[Values, float]]
    comparison: Comparison | None
    figures: Mapping[str, Mapping[str, float]]
    episodes: Mapping[str, int]

    @property
    def better(self) -> bool:
        """Return whether the winner beats the present values by more than chance."""
        found = self.comparison
        return found is not None and found.difference.mean > 0.0 and found.p <= ALPHA

    @property
    def sentence(self) -> str:
        """Return what is to be said of it, in one line."""
        if self.comparison is None:
            return "no set of values was better than the present ones on the problems of validation: nothing to write"
        found = self.comparison.difference
        said = f"{found.mean:+.4f} [{found.low:+.4f}, {found.high:+.4f}], p {self.comparison.p:.3g}, {found.n} pairs"
        return f"{'better' if self.better else 'not better'} than the present values, on test {said}"


def judge_search(search: Search, finalists: int, sets: ProblemSets, driver: Driver) -> Judgement:
    """Choose the winner on the problems of ``validate``, and compare it once with the present values on ``test``."""
    chosen = [one for one in search.whole if one.advantage(search.scores) > 0.0][:finalists]
    validate = problems_of(sets, "validate", sets.validate.problems)
    episodes = {"validate": len(validate) * (len(chosen) + 1) if chosen else 0, "test": 0}
    validation = _validate(chosen, search.present, validate, driver)
    if not validation or validation[0][1] <= 0.0:
        return Judgement(None, validation, None, {}, episodes)
    winner, test = validation[0][0], problems_of(sets, "test", sets.test.problems)
    driver.drive([search.present, winner], test)
    pairs = [(driver.score(winner, one), driver.score(search.present, one)) for one in test]
    both = [(mine, theirs) for mine, theirs in pairs if mine is not None and theirs is not None]
    failed = any(mine is None and theirs is not None for mine, theirs in pairs)
    comparison = compare([mine for mine, _ in both], [theirs for _, theirs in both])
    figures = _compare_figures(winner, search.present, test, driver)
    episodes["test"] = 2 * len(test)
    return Judgement(None if failed else winner, validation, None if failed else comparison, figures, episodes)


def _validate(
    chosen: Sequence[Entrant], present: Values, problems: Sequence[Problem], driver: Driver
) -> list[tuple[Values, float]]:
    """Return the finalists with their advantage on other problems, the best first; those that failed are left out."""
    if not chosen:
        return []
    base, *others = driver.drive([present, *(one.values for one in chosen)], problems)
    found = []
    for one, scores in zip(chosen, others, strict=True):
        if not any(scores[problem] is None and base[problem] is not None for problem in problems):
            found.append((one.values, Entrant(one.values, dict(scores)).advantage(base)))
    return sorted(found, key=lambda pair: -pair[1])


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
