"""What a card says of a tuning: code, problems, trials, budget, curve, importance of parameters, figures on test."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

from arena_tuning.judging import Judgement
from arena_tuning.sampling import importances
from arena_tuning.study import Plan, Search


def make_card(facts: Mapping[str, Any], plan: Plan, search: Search, judgement: Judgement) -> dict[str, Any]:
    """Return the card; ``facts`` are those of the request: planner, preset, robot, words, objective, code."""
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
        "curve": [[episodes, best] for episodes, best in search.curve],
        "importance": importances(search.study, plan.seed),
        "validation": [{"values": dict(values), "advantage": worth} for values, worth in judgement.validation],
        "test": _test_of(judgement),
        "better": judgement.better,
        "verdict": judgement.sentence,
    }
    return _finite(card)  # type: ignore[no-any-return]


def _test_of(judgement: Judgement) -> dict[str, Any]:
    found = judgement.comparison
    if found is None:
        return {}
    interval = {"difference": found.difference.mean, "low": found.difference.low, "high": found.difference.high}
    figures = {name: dict(one) for name, one in judgement.figures.items()}
    return {"objective": {**interval, "p": found.p, "pairs": found.difference.n}, "figures": figures}


def _plain(fields: Mapping[str, Any]) -> dict[str, Any]:
    return {name: value for name, value in fields.items() if value is not None and value is not False}


def _finite(value: Any) -> Any:
    """Return a value with null in the place of numbers that JSON does not have."""
    if isinstance(value, dict):
        return {key: _finite(one) for key, one in value.items()}
    if isinstance(value, list):
        return [_finite(one) for one in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
