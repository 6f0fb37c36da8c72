"""What a card says of a tuning: code, problems, trials, budget, curve, importance of parameters, figures on test."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import Any

from arena_core.statistics import Comparison, after_holm
from arena_tuning.judging import EACH, RULE, Finalist, Judgement
from arena_tuning.sampling import importances
from arena_tuning.study import Plan, Search


def make_card(facts: Mapping[str, Any], plan: Plan, search: Search, judgement: Judgement) -> dict[str, Any]:
    """Return the card; ``facts`` are those of the request: planner, preset, robot, words, objectives, code; and of how
    many episodes twins were driven.
    """
    episodes = {"search": search.episodes, **judgement.episodes}
    card = {
        **facts,
        "seed": plan.seed,
        "sampler": plan.sampler,
        "budget": {"asked": plan.budget.text, "episodes": sum(episodes.values()), **episodes},
        "trials": {
            "all": len(search.entrants),
            "whole": len(search.whole),
            "failed": sum(one.failed for one in search.entrants),
            "races": search.races,
        },
        "space": {key: _plain(asdict(one)) for key, one in plan.space.parameters.items()},
        "present": dict(search.present),
        "values": dict(judgement.winner or {}),
        **_pareto_of(judgement, facts["objectives"]),
        "curve": [[episodes, best] for episodes, best in search.curve],
        "importance": importances(search.study, plan.seed),
        "validation": [_finalist(one) for one in judgement.validation],
        "test": _test_of(judgement, facts["objectives"]),
        "better": judgement.better,
        "verdict": judgement.sentence,
    }
    return _finite(card)  # type: ignore[no-any-return]


def _finalist(one: Finalist) -> dict[str, Any]:
    found = {"values": dict(one.values), "advantage": one.gains[0] if one.gains else math.nan}
    return {**found, "advantages": list(one.gains)} if len(one.gains) > 1 else found


def _pareto_of(judgement: Judgement, objectives: Sequence[str]) -> dict[str, Any]:
    """Return the points of validation that no other one dominates, and the rule that chose one; nothing where a single
    objective is sought.
    """
    if len(objectives) == 1:
        return {}
    points = [
        {**_finalist(one), "chosen": one.values == judgement.winner} for one in judgement.validation if one.undominated
    ]
    return {"pareto": points, "rule": RULE, "better_if": EACH}


def _test_of(judgement: Judgement, objectives: Sequence[str]) -> dict[str, Any]:
    """Return what came of the test: of the objective, or of each of several with p after Holm, and figures."""
    found = after_holm(judgement.comparisons)
    if not found:
        return {}
    told = {text: _interval(one) for text, one in zip(objectives, found, strict=True)}
    figures = {name: dict(one) for name, one in judgement.figures.items()}
    several = {"objectives": told} if len(told) > 1 else {}
    return {"objective": told[objectives[0]], **several, "figures": figures}


def _interval(one: Comparison) -> dict[str, Any]:
    found = one.difference
    return {"difference": found.mean, "low": found.low, "high": found.high, "p": one.holm, "pairs": found.n}


def _plain(fields: Mapping[str, Any]) -> dict[str, Any]:
    return {name: value for name, value in fields.items() if value is not None and value is not False}


def _finite(value: Any) -> Any:
    """Return a value with null in the place of numbers that JSON does not have."""
    if isinstance(value, dict):
        return {key: _finite(one) for key, one in value.items()}
    if isinstance(value, list):
        return [_finite(one) for one in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
