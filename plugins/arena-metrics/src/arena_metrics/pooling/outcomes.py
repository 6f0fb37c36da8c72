"""How an episode ended, in words that say why one that reached its goal is no success."""

from __future__ import annotations

import math

from arena_core.records import COLLISIONS_ALLOWED
from arena_metrics.pooling.runs import Row


def describe_outcome(row: Row) -> str:
    """Return the outcome; beside a goal that was reached without success, the reason."""
    outcome = str(row["outcome"]).replace("_", " ")
    if row["outcome"] != "goal_reached" or row.get("success") != 0.0:
        return outcome
    return f"{outcome}, but {_failure_reason(row)}"


def _failure_reason(row: Row) -> str:
    """Return why the goal that was reached does not count; what arrives is near enough and in
    time, unless the record was changed.
    """
    collisions = row.get("collisions", math.nan)
    if collisions > COLLISIONS_ALLOWED:
        return f"{collisions:.0f} collisions (at most {COLLISIONS_ALLOWED})"
    return "too far from it in truth, or too late"
