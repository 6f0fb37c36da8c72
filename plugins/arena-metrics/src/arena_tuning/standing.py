"""How a tuning stands, as its folder says: settings, the study on disk, the journal, and once it has ended its card."""

from __future__ import annotations

import json
import sqlite3
from collections.abc import Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, field
from itertools import accumulate
from pathlib import Path
from typing import Any

from arena_core import ConfigurationError, InputFileError
from arena_core.commands import one_line
from arena_core.files import is_file, read_json
from arena_tuning.folder import EPISODES, IMPORTANCE, STORAGE
from arena_tuning.folder import NAME as SETTINGS
from arena_tuning.journal import NAME as JOURNAL
from arena_tuning.objective import split_objectives
from arena_tuning.sampling import plain_values

ALLOWED = "what `arena tune` wrote"
CARD = "card.json"
PURPOSES = ("tune", "validate", "test")
ENDS = {"COMPLETE": "whole", "PRUNED": "dropped", "FAIL": "failed"}  # how a set of values came out of its race
MOST_TRIALS = 100_000
MOST_STEPS = 50_000_000  # of SQLite's machine that one question may take; 100,000 trials take a tenth

TRIALS = "SELECT trial_id, number, state FROM trials ORDER BY number LIMIT ?"
VALUES = "SELECT trial_id, value FROM trial_values ORDER BY objective"
STEPS = "SELECT trial_id, MAX(step) FROM trial_intermediate_values GROUP BY trial_id"
PARAMETERS = "SELECT trial_id, param_name, param_value, distribution_json FROM trial_params"
DRIVEN = "SELECT trial_id, value_json FROM trial_user_attributes WHERE key = ?"
ATTRIBUTE = "SELECT value_json FROM study_user_attributes WHERE key = ?"


@dataclass(frozen=True, slots=True)
class StoredSets:
    """The sets of values of a study in order, the ranges of parameters, and their importance where it is noted.

    A set has a number, its race, how it ended, its advantage over the present values (by the first objective, and by
    all of several), the episodes it drove, values.
    """

    sets: Sequence[Mapping[str, Any]] = ()
    ranges: Mapping[str, Any] = field(default_factory=dict)
    importance: Mapping[str, float] = field(default_factory=dict)


def read_standing(folder: Path) -> dict[str, Any]:
    """Return what a tuning has come to: ``sets`` of values in order, the ``curve`` (episodes of the search, best
    advantage), ``parameters``, ``episodes`` by purpose, the ``best`` set, and verdict and figures once it has ended.

    Advantages are those that the command has written to the study. Raises InputFileError (one line) for what is no
    tuning.
    """
    settings = _read_settings(folder)
    card = _read_mapping(folder / CARD) if is_file(folder / CARD) else {}
    stored = read_study(folder / STORAGE, settings["problems"]) if is_file(folder / STORAGE) else StoredSets()
    best = _best_set(stored.sets)
    values = card.get("values") or (best["values"] if best else {})
    try:
        return {
            **{key: settings[key] for key in ("planner", "preset", "robot", "sampler", "seed", "objective", "words")},
            "objectives": split_objectives(settings["objective"]),
            "problems": settings["problems"]["name"],
            "finished": bool(card),
            "races": max((one["race"] for one in stored.sets), default=0),
            "sets": stored.sets,
            "curve": card.get("curve") or _best_curve(stored.sets, settings["problems"]["blocks"][-1]),
            "best": {
                "values": values,
                "advantage": best["advantage"] if best else None,
                "winner": bool(card.get("values")),
            },
            "parameters": _parameters(settings["present"], values, card, stored),
            "episodes": count_episodes(folder / JOURNAL),
            **{key: card.get(key) for key in ("verdict", "better", "budget", "validation", "test", "pareto", "rule")},
        }
    except (KeyError, IndexError, TypeError, ValueError, AttributeError, ConfigurationError) as error:
        raise InputFileError(f"{folder}: holds no tuning ({one_line(repr(error), 80)}); allowed: {ALLOWED}") from None


def read_study(path: Path, problems: Mapping[str, Any]) -> StoredSets:
    """Read a study on disk; raise InputFileError (one line)."""
    try:
        with closing(sqlite3.connect(f"{path.resolve().as_uri()}?mode=ro", uri=True, timeout=2.0)) as base:
            base.set_progress_handler(lambda: 1, MOST_STEPS)
            trials = base.execute(TRIALS, (MOST_TRIALS,)).fetchall()
            worths, blocks = _read_worths(base.execute(VALUES).fetchall()), dict(base.execute(STEPS).fetchall())
            driven = {trial: int(text) for trial, text in base.execute(DRIVEN, (EPISODES,))}
            values, ranges = _read_parameters(base.execute(PARAMETERS).fetchall())
            noted = base.execute(ATTRIBUTE, (IMPORTANCE,)).fetchone()
            sizes = [int(size) for size in problems["blocks"]]
            sets = [
                {
                    "number": number,
                    "race": number // int(problems["entrants"]) + 1,
                    "ended": ENDS.get(state, "racing"),
                    "advantage": worths.get(trial, [None])[0],
                    "advantages": worths.get(trial, []),
                    "episodes": driven.get(
                        trial, sizes[-1] if state == "COMPLETE" else _size(sizes, blocks.get(trial))
                    ),
                    "values": plain_values(values.get(trial, {})),
                }
                for trial, number, state in trials
            ]
            importance = json.loads(noted[0]) if noted else {}
            return StoredSets(sets, ranges, {str(key): float(share) for key, share in importance.items()})
    except (sqlite3.Error, KeyError, IndexError, TypeError, ValueError, AttributeError, OverflowError) as error:
        raise InputFileError(f"{path}: cannot be read ({one_line(str(error), 80)}); allowed: {ALLOWED}") from None


def count_episodes(path: Path) -> dict[str, int]:
    """Return how many episodes a journal holds of each purpose; a line that is being written is none yet."""
    counted = dict.fromkeys(PURPOSES, 0)
    if not is_file(path):
        return counted
    marks = {name: f'"problem": ["{name}", '.encode() for name in PURPOSES}
    with path.open("rb") as file:
        for line in file:
            if line.endswith(b"\n"):
                for name, mark in marks.items():
                    counted[name] += mark in line
    return counted


def _read_worths(rows: Sequence[tuple[int, float]]) -> dict[int, list[float]]:
    """Return of each trial what it was worth by the objectives, in order."""
    found: dict[int, list[float]] = {}
    for trial, value in rows:
        found.setdefault(trial, []).append(value)
    return found


def _size(sizes: Sequence[int], blocks: int | None) -> int:
    return sizes[blocks - 1] if blocks else 0


def _read_parameters(rows: Sequence[tuple[int, str, float, str]]) -> tuple[dict[int, Any], dict[str, Any]]:
    """Return of each trial its values by parameter, and the ranges of parameters: low, high, log, or choices."""
    values: dict[int, dict[str, Any]] = {}
    ranges: dict[str, dict[str, Any]] = {}
    for trial, name, value, text in rows:
        told = json.loads(text)
        facts = told["attributes"]
        choices = facts.get("choices")
        number = int(value) if told["name"] == "IntDistribution" else value
        values.setdefault(trial, {})[name] = choices[int(value)] if choices else number
        ranges[name] = {key: facts[key] for key in ("low", "high", "log", "choices") if key in facts}
    return values, ranges


def _best_set(sets: Sequence[Mapping[str, Any]]) -> Mapping[str, Any] | None:
    """Return the best of those that drove all problems, the first of equal ones."""
    whole = [one for one in sets if one["ended"] == "whole" and one["advantage"] is not None]
    return max(whole, key=lambda one: float(one["advantage"]), default=None)


def _best_curve(sets: Sequence[Mapping[str, Any]], problems: int) -> list[tuple[int, float]]:
    """Return the best advantage after each race by the episodes until then; the present values drove ``problems``."""
    races = [[one for one in sets if one["race"] == race] for race in sorted({one["race"] for one in sets})]
    spent = accumulate((sum(one["episodes"] for one in race) for race in races), initial=problems)
    best = accumulate(
        (max(0.0, (_best_set(race) or {"advantage": 0.0})["advantage"]) for race in races), max, initial=0.0
    )
    return list(zip(spent, best, strict=True))


def _parameters(
    present: Mapping[str, Any], values: Mapping[str, Any], card: Mapping[str, Any], stored: StoredSets
) -> list[dict[str, Any]]:
    """Return a row for each parameter: what it is now, in the best set, its range, and why where a card says."""
    importance, told = card.get("importance") or stored.importance, card.get("space") or {}
    return [
        {
            **{**stored.ranges.get(key, {}), **told.get(key, {})},
            **{"key": key, "present": value, "best": values.get(key), "importance": importance.get(key)},
        }
        for key, value in present.items()
    ]


def _read_settings(folder: Path) -> dict[str, Any]:
    """Return the settings of a tuning; raise InputFileError for those of anything else."""
    found = _read_mapping(folder / SETTINGS)
    if (
        "planner" not in found
        or not isinstance(found.get("problems"), dict)
        or not isinstance(found.get("present"), dict)
    ):
        raise InputFileError(f"{folder / SETTINGS}: holds no tuning; allowed: {ALLOWED}")
    return found


def _read_mapping(path: Path) -> dict[str, Any]:
    found = read_json(path, ALLOWED)
    if not isinstance(found, dict):
        raise InputFileError(f"{path}: holds no mapping; allowed: {ALLOWED}")
    return found
