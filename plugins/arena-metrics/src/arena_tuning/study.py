"""The search: Optuna asks for a batch of sets of values, they race, and it is told what came of each."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from time import monotonic
from typing import TYPE_CHECKING

from arena_core import ConfigurationError
from arena_core.hosting import RunFolderError, SearchSpace
from arena_tuning.budget import Budget
from arena_tuning.driving import Driver
from arena_tuning.folder import EPISODES, IMPORTANCE, STORAGE
from arena_tuning.journal import Values
from arena_tuning.pareto import rank
from arena_tuning.problems import Problem, ProblemSets, problems_of
from arena_tuning.racing import Entrant, Scores, cost_of_race, run_race
from arena_tuning.sampling import OF_ONE, distributions_of, importances, make_sampler, plain_values

if TYPE_CHECKING:
    from optuna.study import Study

NAME = "tune"  # of the study in its storage
LAST = (math.inf,)  # what a problem counts for that the present values cannot drive: it says nothing
Say = Callable[[str], None]


@dataclass(slots=True, eq=False)
class Search:
    """What a search has come to: all entrants, the scores of the present values, the best advantage by episodes."""

    study: Study
    present: Values
    problems: Sequence[Problem]
    scores: Scores
    entrants: list[Entrant] = field(default_factory=list)
    curve: list[tuple[int, float]] = field(default_factory=list)
    races: int = 0
    episodes: int = 0

    @property
    def whole(self) -> list[Entrant]:
        """Return those that drove all problems, the best first."""
        driven = [one for one in self.entrants if not one.failed and len(one.scores) == len(self.problems)]
        return [driven[place] for place in rank([one.advantages(self.scores) for one in driven])]


@dataclass(frozen=True, slots=True)
class Plan:
    """What a search needs to know: space, sampler, seed, budget, problems."""

    space: SearchSpace
    sampler: str
    seed: int
    budget: Budget
    sets: ProblemSets
    objectives: int = 1

    @property
    def race(self) -> int:
        """Return how many episodes a race takes at most."""
        return cost_of_race(self.sets.entrants, self.sets.blocks)

    def check(self) -> None:
        """Raise ConfigurationError where the budget is not enough for the present values and one race, or the sampler
        does not know what to do with several objectives.
        """
        if self.objectives > 1 and self.sampler == OF_ONE:
            raise ConfigurationError(f"sampler is {OF_ONE}, of one objective; allowed for several: tpe, nsga, random")
        least = self.race + self.sets.searched
        if self.budget.episodes is not None and self.budget.episodes < least:
            raise ConfigurationError(f"budget is {self.budget.text}; allowed: {least} episodes at least, for one race")


def run_search(plan: Plan, present: Values, driver: Driver, folder: Path, say: Say) -> Search:
    """Race batches of sets of values until the budget is used; the same for one seed and a budget in episodes, whoever
    drives and however often it was interrupted.

    Raises ConfigurationError where the present values fail, or all others do.
    """
    import optuna

    optuna.logging.set_verbosity(optuna.logging.WARNING)
    began = monotonic()
    stored, problems = StoredStudy(folder), problems_of(plan.sets, "tune", plan.sets.searched)
    problems = order_problems(problems, _present_scores(driver, present, problems))
    driver.late = frozenset(problems[plan.sets.before_last :])
    (scores,) = driver.drive([present], problems)
    search = Search(_make_study(plan), present, problems, scores)
    search.episodes = len(problems)
    search.curve.append((search.episodes, 0.0))
    while plan.budget.allows(search.episodes + plan.race, monotonic() - began):
        before = search.episodes
        _race_batch(search, plan, driver)
        stored.follow(search.study, importances(search.study, plan.seed))
        say(_progress_line(search, plan))
        if search.episodes == before:  # the sampler has nothing new
            break
    if search.entrants and all(one.failed for one in search.entrants):
        errors = driver.errors([one.values for one in search.entrants], problems)
        raise ConfigurationError(f"an episode of every trial ended with an error, such as: {errors[0]}")
    return search


def order_problems(problems: Sequence[Problem], present: Scores) -> list[Problem]:
    """Return problems in the order in which sets of values race on them, by what the present values are worth there,
    the worst first: where these do well sets of values hardly differ.
    """
    return sorted(problems, key=lambda problem: present[problem] or LAST)


def _make_study(plan: Plan) -> Study:
    import optuna

    sampler = make_sampler(plan.sampler, plan.seed, plan.sets.entrants)
    return optuna.create_study(directions=["maximize"] * plan.objectives, sampler=sampler)


def _present_scores(driver: Driver, present: Values, problems: Sequence[Problem]) -> Scores:
    (scores,) = driver.drive([present], problems)
    if all(score is None for score in scores.values()):
        raise ConfigurationError(
            f"the planner as it is ends every episode with an error: {driver.errors([present], problems)[0]}"
        )
    return scores


def _race_batch(search: Search, plan: Plan, driver: Driver) -> None:
    """Ask for a batch, race it, and tell what came of it: of each its advantage over the present values."""
    from optuna.trial import TrialState

    distributions = distributions_of(plan.space)
    trials = [search.study.ask(distributions) for _ in range(plan.sets.entrants)]
    values = [plain_values(trial.params) for trial in trials]
    entrants = run_race(values, plan.sets.blocks, search.problems, search.scores, driver.drive)
    for trial, one in zip(trials, entrants, strict=True):
        worths = one.advantages(search.scores)
        trial.set_user_attr(EPISODES, len(one.scores))
        if one.failed or not worths:
            search.study.tell(trial, state=TrialState.FAIL)
        elif len(one.scores) == len(search.problems):
            search.study.tell(trial, worths)
        else:
            if len(worths) == 1:  # Optuna takes no reports of several
                trial.report(worths[0], one.blocks)
            search.study.tell(trial, state=TrialState.PRUNED)
    search.races += 1
    search.episodes += sum(len(one.scores) for one in entrants)
    search.entrants += entrants
    search.curve.append((search.episodes, max([search.curve[-1][1], *_whole_worths(search)])))


def _whole_worths(search: Search) -> list[float]:
    return [one.advantage(search.scores) for one in search.whole]


def _progress_line(search: Search, plan: Plan) -> str:
    of = f" of {plan.budget.episodes}" if plan.budget.episodes is not None else ""
    best = search.curve[-1][1]
    return f"race {search.races}: {search.episodes}{of} episodes, best {best:+.4f} over the present values"


class StoredStudy:
    """The study on disk, which optuna-dashboard shows; it follows the one that is searched with."""

    def __init__(self, folder: Path) -> None:
        self._file = folder / STORAGE
        self._kept: Study | None = None

    def follow(self, study: Study, importance: Mapping[str, float]) -> None:
        """Add the trials that are new and note the importance; raise RunFolderError where they cannot be written."""
        import optuna

        try:
            self._kept = self._kept or optuna.create_study(
                storage=f"sqlite:///{self._file}",
                study_name=NAME,
                directions=study.directions,
                load_if_exists=True,
            )
            there = len(self._kept.get_trials(deepcopy=False))
            self._kept.add_trials(study.get_trials(deepcopy=False)[there:])
            self._kept.set_user_attr(IMPORTANCE, dict(importance))
        except Exception as error:  # whatever its database raises
            raise RunFolderError(f"cannot write {self._file}: {error}") from error
