"""Certificates of the problems of runs as rows of their own: what the clairvoyant did, whoever else drove there."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from hashlib import blake2b
from pathlib import Path
from typing import Any

from arena_core import ArenaError, Metric
from arena_core.hosting import load_registry
from arena_core.records import EPISODE_COLUMNS, build_metrics, evaluate_record, read_record, record_path
from arena_metrics.pooling.cells import SEEING, without_planners
from arena_metrics.pooling.runs import Episode, Row, Run

FOLDER = (
    "reference"  # of a run's, in which the records of its certificates lie; and the kind of the findings about them
)
CLAIRVOYANT = "clairvoyant"
PROBLEM = ("robot", "world", "pedestrians", "task", "simulator", "stop_on_collision")  # parts of a configuration
CONDITION = ("localizer", "timing", "predictor", "communication")  # columns


def certificate_episodes(runs: Sequence[Run]) -> list[Episode]:
    """Return an episode for each certificate beside the records of some runs, once for all that share it, with the
    metrics of its record.

    Its row says the conditions of the run whose problem it solves, so that it stands beside that run's planner.
    """
    found: dict[tuple[Any, ...], Episode] = {}
    for run in runs:
        for row, path in _certified_rows(run):
            key = (_condition(row, run), row["seed"], row["episode"])
            if key not in found and (episode := _episode(run, row, path, key[0])) is not None:
                found[key] = episode
    return list(found.values())


def _certified_rows(run: Run) -> Iterator[tuple[Row, Path]]:
    """Yield the rows of a run whose problem was certified, with the certificate's record."""
    for row in run.rows:
        path = record_path(run.folder / FOLDER, row["episode"])
        if row.get(f"{FOLDER}.problem") and path.is_file():
            yield row, path


def _condition(row: Row, run: Run) -> str:
    """Return a name of the condition under which a run drove, whatever its planner."""
    config = run.provenance.get("config", {})
    seen = without_planners(row.get("privileged") or "")
    parts = [{key: config.get(key) for key in PROBLEM}, [row.get(key, "") for key in CONDITION], seen]
    return blake2b(json.dumps(parts, sort_keys=True).encode(), digest_size=4).hexdigest()


def _episode(run: Run, row: Row, path: Path, condition: str) -> Episode | None:
    """Return a certificate's episode; None where its record or a metric of its run cannot be read here."""
    try:
        record = read_record(path)
        figures = evaluate_record(record, _packs(run))
    except ArenaError:
        return None
    seeing = ", ".join(filter(None, (without_planners(row.get("privileged") or ""), f"{SEEING}{CLAIRVOYANT}")))
    own = {name: value for name, value in figures.items() if name in row and name not in EPISODE_COLUMNS}
    ended = {name: figures[name] for name in ("outcome", "error")}
    named = {"planner": CLAIRVOYANT, "preset": CLAIRVOYANT, "config_hash": condition, "privileged": seeing}
    told = {"code": str(record.meta["columns"].get("code", "")), **_findings(row)}
    return Episode({**row, **own, **ended, **named, **told}, _run_of(run, row))


def _packs(run: Run) -> Mapping[str, Sequence[Metric]]:
    return build_metrics(run.provenance.get("config", {}), load_registry())


def _findings(row: Row) -> dict[str, float | str]:
    """Return what findings say of a certificate itself: those about the run's own episode do not count."""
    certified = row[f"{FOLDER}.solvable"] == "yes"
    own = {"time_regret": 0.0, "stl": 1.0, "avoidable": 0.0}
    others = {name: "" if isinstance(row[name], str) else math.nan for name in row if name.startswith("explain.")}
    return others | {f"{FOLDER}.{name}": value if certified else math.nan for name, value in own.items()}


def _run_of(run: Run, row: Row) -> Run:
    config = {**run.provenance.get("config", {}), "planner": {"name": CLAIRVOYANT}}
    return replace(run, folder=run.folder / FOLDER, rows=[row], provenance={**run.provenance, "config": config})
