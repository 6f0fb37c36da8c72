"""How Optuna chooses sets of values: its sampler, and the search space as its distributions."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from arena_core.hosting import SearchRange, SearchSpace

if TYPE_CHECKING:
    from optuna.distributions import BaseDistribution
    from optuna.samplers import BaseSampler
    from optuna.study import Study

SAMPLERS = ("tpe", "cmaes", "random", "nsga")
OF_ONE = "cmaes"  # the sampler of one objective alone
FIRST = 16  # sets of values that TPE draws at random before it learns
FEW = 8  # trials that drove all problems, below which importances say nothing


def make_sampler(name: str, seed: int, entrants: int) -> BaseSampler:
    """Return the sampler of a name; trials that were dropped count with what they were worth until then. A generation
    of NSGA-II has so many parents as a race has ``entrants``.
    """
    from optuna.exceptions import ExperimentalWarning
    from optuna.samplers import CmaEsSampler, NSGAIISampler, RandomSampler, TPESampler

    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ExperimentalWarning)
        if name == "cmaes":
            return CmaEsSampler(seed=seed, consider_pruned_trials=True, warn_independent_sampling=False)
        if name == "random":
            return RandomSampler(seed=seed)
        if name == "nsga":
            return NSGAIISampler(seed=seed, population_size=entrants)
        return TPESampler(seed=seed, n_startup_trials=FIRST, constant_liar=True)


def distributions_of(space: SearchSpace) -> dict[str, BaseDistribution]:
    """Return the distribution of each parameter, in order of the keys."""
    return {key: _distribution(one) for key, one in sorted(space.parameters.items())}


def _distribution(one: SearchRange) -> BaseDistribution:
    from optuna.distributions import CategoricalDistribution, FloatDistribution, IntDistribution

    if one.choices is not None:
        return CategoricalDistribution(one.choices)
    assert one.low is not None
    assert one.high is not None
    if one.integer:
        return IntDistribution(int(one.low), int(one.high), log=one.log)
    return FloatDistribution(one.low, one.high, log=one.log)


def importances(study: Study, seed: int, objective: int = 0) -> dict[str, float]:
    """Return which share of what differs between sets of values by an objective each parameter explains, greatest
    first; nothing where there are too few to say (functional ANOVA, Hutter et al. 2014).
    """
    from optuna.trial import TrialState

    if len(study.get_trials(deepcopy=False, states=(TrialState.COMPLETE,))) < FEW:
        return {}
    from optuna.importance import FanovaImportanceEvaluator, get_param_importances

    try:
        evaluator = FanovaImportanceEvaluator(seed=seed)
        found = get_param_importances(study, evaluator=evaluator, target=lambda trial: trial.values[objective])
    except (RuntimeError, ValueError):  # fewer than two trials ended, or all alike
        return {}
    return {name: float(share) for name, share in found.items()}


def plain_values(values: Mapping[str, Any]) -> dict[str, Any]:
    """Return values in order of their keys, numbers with the digits that a preset's file keeps."""
    return {key: _rounded(value) for key, value in sorted(values.items())}


def _rounded(value: Any) -> Any:
    return float(f"{value:.4g}") if isinstance(value, float) else value
