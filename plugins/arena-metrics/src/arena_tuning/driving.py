"""Drive sets of values on problems, whoever carries the episodes; what the journal knows is not driven again."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from hashlib import blake2b
from pathlib import Path
from typing import Any

from arena_core import ConfigurationError
from arena_core.commands import interrupts
from arena_core.hosting import Executor, Finished, Job, Lost, Registry, RunFolderError, check_job, compose, to_plain
from arena_tuning.costing import DROVE, TWINS, drive, drive_and_cost
from arena_tuning.journal import Journal, Values
from arena_tuning.objective import COST, TIME_LIMIT, Objectives
from arena_tuning.problems import Problem, ProblemSets, words_of
from arena_tuning.racing import Scores, Worth

Work = Callable[[Job], Finished]
DRIVES = "drives"  # the folder of what is under way: records, which go once their rows are kept


@dataclass(frozen=True, slots=True, eq=False)
class Cells:
    """The composed configuration of each cell of the problems, the seeds of the sets, and at which place of it values
    stand (empty: at its top).
    """

    configs: Sequence[Any]
    choices: Sequence[Mapping[str, str]]
    sets: ProblemSets
    place: str = "planner"

    def config(self, values: Values, problem: Problem) -> dict[str, Any]:
        """Return the plain configuration of a problem with some values for what is tuned."""
        from omegaconf import OmegaConf, open_dict

        composed = self.configs[problem.cell].copy()
        with open_dict(composed):
            for key, value in values.items():
                OmegaConf.update(composed, f"{self.place}.{key}".lstrip("."), value)
            composed.seed = self.sets.seed(problem.purpose)
        return {**to_plain(composed), "choices": dict(self.choices[problem.cell])}


def compose_cells(sets: ProblemSets, words: Sequence[str], place: str = "planner") -> Cells:
    """Compose every cell of the problems with the user's words, for values that stand at a place; raise
    ConfigurationError.
    """
    from omegaconf import open_dict

    configs, choices = [], []
    for cell in range(len(sets.cells)):
        composed = compose([*words_of(sets, cell, words), *words], hydra=True)
        chosen = {group: option for group, option in composed.hydra.runtime.choices.items() if option is not None}
        with open_dict(composed):
            del composed["hydra"]
        configs.append(composed)
        choices.append({str(group): str(option) for group, option in chosen.items() if not group.startswith("hydra/")})
    return Cells(configs, choices, sets, place)


class Driver:
    """Drives episodes through an executor and says what they are worth.

    ``late`` are the problems of the search on which it counts what the robot cost the people, all until they are known.
    """

    def __init__(self, cells: Cells, executor: Executor, journal: Journal, objective: Objectives, folder: Path) -> None:
        self.cells, self.journal, self.objective = cells, journal, objective
        self.late: frozenset[Problem] | None = None
        self.seconds = {DROVE: 0.0, TWINS: 0.0}  # of episodes and of their twins, summed over workers
        self._executor, self._folder = executor, folder / DRIVES

    def check(self, values: Values, registry: Registry) -> None:
        """Raise ConfigurationError where a cell cannot be built with these values, before anything is driven."""
        jobs = [
            Job(self.cells.config(values, Problem("tune", cell, 0)), str(self._folder), 0)
            for cell in range(len(self.cells.configs))
        ]
        for answer in self._executor.prepare(check_job, jobs):
            interrupts.check()
            if isinstance(answer, Lost):
                raise ConfigurationError(f"the planner cannot be built: {answer.reason}")
            if answer.error is not None:
                raise answer.error

    def drive(self, sets_of_values: Sequence[Values], problems: Sequence[Problem]) -> list[Scores]:
        """Drive every set of values on every problem, what is known aside; return the scores of each."""
        pending = [
            (values, problem)
            for values in sets_of_values
            for problem in sorted(problems, key=lambda problem: problem.cell)
            if self.journal.row(values, problem) is None
        ]
        self._drive_pending(pending)
        return [{problem: self.score(values, problem) for problem in problems} for values in sets_of_values]

    def score(self, values: Values, problem: Problem) -> Worth | None:
        """Return what a finished episode is worth by each objective, None where it ended with an error; raise
        ConfigurationError where one is not defined.
        """
        row = self.row(values, problem)
        if row["outcome"] == "error":
            return None
        limit = self.cells.configs[problem.cell].task.get(TIME_LIMIT, float("nan"))
        counted = row if self.costs(problem) else {key: row[key] for key in row if not key.startswith(COST)}
        worth = self.objective.value(counted, float(limit))
        for part, value in zip(self.objective.parts, worth, strict=True):
            if value != value:
                raise ConfigurationError(
                    f"objective {part.text} is not defined in an episode that ended with {row['outcome']}; "
                    f"allowed: known(METRIC, OTHERWISE) for what is not always defined"
                )
        return worth

    def costs(self, problem: Problem) -> bool:
        """Return whether it counts on a problem what the robot cost the people."""
        late = self.late is None or problem.purpose != "tune" or problem in self.late
        return self.objective.costs and late

    def row(self, values: Values, problem: Problem) -> Mapping[str, Any]:
        """Return the row of a finished episode."""
        row = self.journal.row(values, problem)
        assert row is not None
        return row

    def errors(self, sets_of_values: Iterable[Values], problems: Sequence[Problem]) -> list[str]:
        """Return what ended finished episodes with an error."""
        rows = [self.journal.row(values, problem) or {} for values in sets_of_values for problem in problems]
        return [str(row["error"]) for row in rows if row.get("outcome") == "error"]

    def _drive_pending(self, pending: Sequence[tuple[Values, Problem]]) -> None:
        try:
            for work, costs in ((drive, False), (drive_and_cost, True)):
                self._drive_with(work, [one for one in pending if self.costs(one[1]) == costs])
        finally:
            shutil.rmtree(self._folder, ignore_errors=True)

    def _drive_with(self, work: Work, pending: Sequence[tuple[Values, Problem]]) -> None:
        jobs: dict[tuple[str, int], tuple[Values, Problem]] = {}
        configs: dict[str, Mapping[str, Any]] = {}
        for values, problem in pending:
            folder = self._make_folder(values, problem)
            jobs[folder, problem.number] = values, problem
            configs[folder] = configs.get(folder) or self.cells.config(values, problem)
        wanted = [Job(configs[folder], folder, number) for folder, number in jobs]
        for answer in self._executor.map(work, wanted) if wanted else ():
            interrupts.check()
            values, problem = jobs[answer.job.folder, answer.job.episode]
            lost = {"outcome": "error", "error": answer.reason} if isinstance(answer, Lost) else answer.row
            row = dict[str, Any](lost)
            for name in self.seconds:
                self.seconds[name] += row.pop(name, 0.0)
            self.journal.add(values, problem, row)

    def _make_folder(self, values: Values, problem: Problem) -> str:
        text = repr((sorted(values.items()), problem.purpose, problem.cell))
        folder = self._folder / blake2b(text.encode(), digest_size=8).hexdigest()
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise RunFolderError(f"cannot write {folder}: {error.strerror or error}") from error
        return str(folder)
