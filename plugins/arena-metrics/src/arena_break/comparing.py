"""How planners do on hard problems, without the share that was searched against them."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from arena_break.request import file_name
from arena_core import Runs
from arena_core.statistics import wilson

TAIL = 0.1  # share of the worst episodes whose collisions are averaged


@dataclass(frozen=True, slots=True)
class Drive:
    """One episode of a planner on a robot: against whom its problem was searched, and how it ended."""

    driver: str
    against: str
    strict: bool
    success: bool
    collisions: float


def read_drives(folders: Sequence[Path]) -> list[Drive]:
    """Return the episodes of all runs at or below some folders; raise InputFileError where there is no run."""
    return [_drive_of(row) for run in Runs.below(*folders) for row in run.episodes.to_dict("records")]


def comparison_table(drives: Sequence[Drive]) -> list[list[str]]:
    """Return a row for each planner: strict successes of the problems that were searched against each, its own in
    brackets; then over those that were not searched against itself strict success with its interval (Wilson), success,
    collisions an episode, and those of the worst tenth (CVaR).
    """
    shares = sorted({one.against for one in drives})
    head = ["planner on robot", *shares, "episodes", "strict success", "95 %", "success", "collisions", "worst tenth"]
    rows = []
    for driver in dict.fromkeys(one.driver for one in drives):
        own = [one for one in drives if one.driver == driver]
        fair = [one for one in own if one.against != driver]
        cells = [_share([one for one in own if one.against == share], own=share == driver) for share in shares]
        rows.append((-_mean([one.strict for one in fair]), [driver, *cells, str(len(fair)), *_figures(fair)]))
    return [head, *(row for _, row in sorted(rows, key=lambda one: (math.isnan(one[0]), one)))]


def _share(drives: Sequence[Drive], *, own: bool) -> str:
    if not drives:
        return "–"
    text = f"{sum(one.strict for one in drives)} of {len(drives)}"
    return f"({text})" if own else text


def _figures(drives: Sequence[Drive]) -> list[str]:
    worst = sorted((one.collisions for one in drives), reverse=True)[: math.ceil(TAIL * len(drives))]
    strict = _mean([one.strict for one in drives])
    means = (
        _mean([one.success for one in drives]),
        _mean([one.collisions for one in drives]),
        _mean(worst),
    )
    interval = "{:.2f} – {:.2f}".format(*wilson(strict, len(drives))) if drives else "–"
    return [_text(strict), interval, *map(_text, means)]


def _text(value: float) -> str:
    return "–" if math.isnan(value) else f"{value:.2f}"


def _mean(values: Sequence[float]) -> float:
    return math.fsum(values) / len(values) if values else math.nan


def _drive_of(row: Mapping[str, Any]) -> Drive:
    name = str(row["scenario"]).partition("/")[0].rpartition("_")[0]
    return Drive(
        f"{file_name(str(row['preset']))}_{file_name(str(row['robot']))}",
        name,
        str(row.get("strict_success", "")) in ("1.0", "1"),
        str(row.get("success", "")) in ("1.0", "1"),
        _number(row.get("collisions")),
    )


def _number(value: Any) -> float:
    try:
        found = float(value)
    except (TypeError, ValueError):
        return 0.0
    return found if found == found else 0.0
