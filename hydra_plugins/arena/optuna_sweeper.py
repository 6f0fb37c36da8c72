"""The sweeper that looks for the best: Optuna chooses the next values by what came of the ones before."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hydra.core.override_parser.overrides_parser import OverridesParser
from hydra.core.override_parser.types import IntervalSweep, Override, RangeSweep, Transformer
from hydra.core.plugins import Plugins
from hydra.plugins.sweeper import Sweeper
from hydra.types import HydraContext, TaskFunction
from hydra.utils import instantiate
from omegaconf import DictConfig, OmegaConf

from .best import RESULTS

if TYPE_CHECKING:
    from optuna.distributions import BaseDistribution
    from optuna.study import Study
    from optuna.trial import Trial

DIRECTIONS = ("minimize", "maximize")
Settings = Mapping[str, Any]


class OptunaSweeper(Sweeper):
    """Launch trials, ``n_jobs`` at a time, until there have been ``n_trials``; ``params`` are searched besides what the
    command line sweeps. ``study`` says where it is kept: ``direction``, ``storage``, ``study_name``.
    """

    def __init__(
        self, sampler: Settings, params: Mapping[str, Any] | None, n_trials: int, n_jobs: int, **study: Any
    ) -> None:
        self.sampler, self.params, self.study = sampler, params or {}, study
        self.n_trials, self.n_jobs = n_trials, n_jobs

    def setup(self, *, hydra_context: HydraContext, task_function: TaskFunction, config: DictConfig) -> None:
        """Make the launcher that is chosen; raise ConfigurationError where Optuna is not installed."""
        from arena_core.base.optional import require_extra

        require_extra("hydra/sweeper=optuna", ["optuna"], "arena-core[optuna]")
        self.config: Any = config
        self.launcher: Any = Plugins.instance().instantiate_launcher(
            hydra_context=hydra_context, task_function=task_function, config=config
        )

    def sweep(self, arguments: list[str]) -> None:
        """Run all trials and write the best to the multirun's folder."""
        study = self._make_study()
        parsed = OverridesParser.create().parse_overrides(
            [*(f"{key}={value}" for key, value in self.params.items()), *arguments]
        )
        chosen = {one.get_key_element(): one for one in parsed}
        space = {key: distribution_of(one) for key, one in chosen.items() if one.is_sweep_override()}
        fixed = [f"{key}={one.get_value_element_as_str()}" for key, one in chosen.items() if key not in space]
        for first in range(0, self.n_trials, self.n_jobs):
            self._run_batch(study, space, fixed, range(first, min(first + self.n_jobs, self.n_trials)))
        OmegaConf.save(best_of(study), Path(str(self.config.hydra.sweep.dir)) / RESULTS)

    def _make_study(self) -> Study:
        import optuna

        from arena_core.base.errors import ConfigurationError

        optuna.logging.set_verbosity(optuna.logging.WARNING)  # it prints lines of its own
        wanted = self.study["direction"]
        directions: list[Any] = [wanted] if isinstance(wanted, str) else list(wanted)
        if not directions or any(one not in DIRECTIONS for one in directions):
            raise ConfigurationError(
                f"hydra.sweeper.direction is {wanted}; allowed: minimize, maximize, or one of them for each objective"
            )
        return optuna.create_study(
            storage=self.study["storage"],
            study_name=self.study["study_name"],
            sampler=instantiate(self.sampler),
            directions=directions,
            load_if_exists=True,
        )

    def _run_batch(
        self, study: Study, space: Mapping[str, BaseDistribution], fixed: Sequence[str], numbers: range
    ) -> None:
        trials = [study.ask(dict(space)) for _ in numbers]
        jobs = [(*(f"{key}={value}" for key, value in one.params.items()), *fixed) for one in trials]
        answers = self.launcher.launch(jobs, initial_job_idx=numbers.start)
        for trial, answer in zip(trials, answers, strict=True):
            study.tell(trial, _values_of(answer.return_value, trial))


def distribution_of(one: Override) -> BaseDistribution:
    """Return what a swept word lets Optuna choose from: an interval, a range in steps, or values between commas."""
    from optuna.distributions import CategoricalDistribution, FloatDistribution, IntDistribution

    value = one.value()
    if isinstance(value, IntervalSweep):
        assert value.start is not None
        assert value.end is not None
        log = "log" in value.tags
        if isinstance(value.start, int) and isinstance(value.end, int):
            return IntDistribution(value.start, value.end, log=log)
        return FloatDistribution(float(value.start), float(value.end), log=log)
    if isinstance(value, RangeSweep) and not value.shuffle:
        numbers = list(value.range())
        if all(isinstance(number, int) for number in numbers):
            return IntDistribution(min(numbers), max(numbers), step=abs(int(value.step)))
    choices: Any = list(one.sweep_iterator(transformer=Transformer.encode))
    return CategoricalDistribution(choices)


def best_of(study: Study) -> dict[str, Any]:
    """Return what the file of results says: the best trial, or all that none is better than in every objective."""
    if len(study.directions) == 1:
        return {"name": "optuna", "best_params": dict(study.best_params), "best_value": study.best_value}
    solutions = [{"params": dict(one.params), "values": list(one.values)} for one in study.best_trials]
    return {"name": "optuna", "solutions": solutions}


def _values_of(returned: Any, trial: Trial) -> list[float]:
    values = [float(one) for one in (returned if isinstance(returned, Sequence) else [returned])]
    if len(values) != len(trial.study.directions) or not all(map(math.isfinite, values)):
        from arena_core.base.errors import ConfigurationError

        raise ConfigurationError(
            f"trial {trial.number} has {returned} as its objective; allowed: a number for each hydra.sweeper.direction"
        )
    return values
