"""How the planners of a report were tuned, with which budget, and how they learned: what their runs say."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from arena_metrics.pooling.runs import Run

NOT_TOLD = "not told"  # by runs that are older than the question
HEAD = ("planner", "robot", "tuned", "budget", "learned by")


def tuned_rows(runs: Sequence[Run]) -> list[tuple[str, ...]]:
    """Return a row for each planner and robot of some runs, in order: the cells of ``HEAD``."""
    return sorted({_row_of(run.provenance) for run in runs})


def _row_of(provenance: Mapping[str, Any]) -> tuple[str, ...]:
    config = _mapping(provenance.get("config"))
    told = _mapping(provenance.get("tuning"))
    choices = _mapping(config.get("choices"))
    planner = told.get("preset") or choices.get("planner") or _mapping(config.get("planner")).get("name", "–")
    robot = choices.get("robot") or _mapping(config.get("robot")).get("name", "–")
    budget = told.get("budget")
    spent = f"{budget} episodes" if isinstance(budget, int) else NOT_TOLD
    learned = str(told.get("learned_by") or "–") if told else NOT_TOLD
    return str(planner), str(robot), f"{told.get('tuned', NOT_TOLD)}{_stack_of(told)}", spent, learned


def _stack_of(told: Mapping[str, Any]) -> str:
    """Return what is to be said of the stack that guided it, empty where none was chosen."""
    stack = _mapping(told.get("stack"))
    return f"; stack {stack.get('preset')} {stack.get('tuned')}, {stack.get('budget')} episodes" if stack else ""


def _mapping(value: Any) -> Mapping[str, Any]:
    return value if isinstance(value, Mapping) else {}
