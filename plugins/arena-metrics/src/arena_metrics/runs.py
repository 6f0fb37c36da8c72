"""What runs left on disk: their rows, pooled and without repeats, their provenance, and what their columns mean."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from arena_core import ArenaError, InputFileError, Metric, build_metrics, compose, find_runs, load_registry

IDENTIFICATION = [
    *("config_hash", "planner", "preset", "robot", "simulator", "world", "task", "scenario", "scenario_hash", "stage", "n_pedestrians"),
    *("pedestrian_model", "reaction", "localizer", "timing", "episode", "seed", "outcome", "error"),
]
LATER = ["scenario_hash", "stage"]  # texts too, which older tables lack
DEFAULT_PACK = "si"
Row = Mapping[str, Any]


@dataclass(frozen=True, slots=True, eq=False)
class Run:
    """One run's folder: its rows of episodes.csv (metrics as floats, NaN where empty) and its provenance."""

    folder: Path
    rows: Sequence[Row]
    provenance: Mapping[str, Any]


@dataclass(frozen=True, slots=True)
class Column:
    """One metric's column: its name in episodes.csv, its pack, and what it means (unknown where its pack is not installed)."""

    name: str
    pack: str
    unit: str
    better: str
    description: str
    path_metric: bool

    @property
    def proportion(self) -> bool:
        """Tell whether every value is 0 or 1, so that the mean is a proportion."""
        return self.unit == "0/1"

    @property
    def title(self) -> str:
        """Return the name for a reader."""
        return self.name.rpartition(".")[2].replace("_", " ")


def read_runs(directories: Iterable[Path]) -> list[Run]:
    """Read every run at or below the given folders once; raise InputFileError when there is none or a table is broken."""
    folders = {folder.resolve(): folder for directory in directories for folder in find_runs(directory)}
    return [Run(folder, read_episodes(folder / "episodes.csv"), _provenance(folder)) for folder in folders.values()]


def read_episodes(path: Path) -> list[Row]:
    """Read an episodes.csv; raise InputFileError (file, line, what is allowed)."""
    import csv

    try:
        with path.open(newline="", encoding="utf-8") as file:
            reader = csv.DictReader(file, strict=True)
            missing = [name for name in IDENTIFICATION if name not in (reader.fieldnames or [])]
            if missing:
                raise InputFileError(f"{path}: lacks the column {missing[0]}; allowed: a table that `arena run` or `arena evaluate` wrote")
            return [_row(path, number, row) for number, row in enumerate(reader, start=2)]
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise InputFileError(f"{path}: cannot be read ({error}); allowed: a table that `arena run` or `arena evaluate` wrote") from error


def _row(path: Path, line: int, row: Mapping[str | None, Any]) -> Row:
    if None in row or None in row.values():
        raise InputFileError(f"{path}: line {line} has another number of fields than the header")
    texts: dict[str, str] = {str(key): value for key, value in row.items()}
    try:
        metrics = {key: float(value) if value else math.nan for key, value in texts.items() if key not in (*IDENTIFICATION, *LATER)}
        numbers = {key: int(texts[key]) for key in ("episode", "seed")}
        numbers |= {key: int(texts[key]) if texts[key] else -1 for key in ("n_pedestrians", "stage")}
    except ValueError as error:
        raise InputFileError(
            f"{path}: line {line}: {error}; allowed: numbers in all metrics, episode, seed, stage and n_pedestrians"
        ) from None
    return {**texts, **metrics, **numbers}


def _provenance(folder: Path) -> Mapping[str, Any]:
    path = folder / "provenance.json"
    if not path.exists():
        return {}
    try:
        provenance = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise InputFileError(f"{path}: cannot be read ({error}); allowed: JSON that `arena run` wrote") from error
    if not isinstance(provenance, dict):
        raise InputFileError(f"{path}: holds no mapping; allowed: JSON that `arena run` wrote")
    return provenance


@dataclass(frozen=True, slots=True, eq=False)
class Episode:
    """One row of a run, with the run that it came from."""

    row: Row
    run: Run

    @property
    def record_path(self) -> Path:
        """Return where the record is, if the episode got so far as to have one."""
        return self.run.folder / "records" / f"{self.row['episode']:04d}.npz"


def pooled(runs: Iterable[Run]) -> tuple[list[Episode], int]:
    """Return the episodes of all runs and how many were left out as repeats (same cell, seed and number as another)."""
    episodes: dict[tuple[Any, ...], Episode] = {}
    total = 0
    for run in runs:
        for row in run.rows:
            episodes[row["config_hash"], row["seed"], row["episode"]] = Episode(row, run)
            total += 1
    return list(episodes.values()), total - len(episodes)


def metric_columns(runs: Sequence[Run]) -> list[Column]:
    """Return every metric's column in the order of the tables, ``si`` first."""
    names = dict.fromkeys(name for run in runs for row in run.rows[:1] for name in row if name not in (*IDENTIFICATION, *LATER))
    packs = {name: name.rpartition(".")[0] or DEFAULT_PACK for name in names}
    known = _described(runs, list(dict.fromkeys(packs.values())))
    columns = [known.get(name, Column(name, pack, "", "neither", "", False)) for name, pack in packs.items()]
    return sorted(columns, key=lambda column: (column.pack != DEFAULT_PACK, column.pack))


def columns_of(packs: Mapping[str, Sequence[Metric]]) -> list[Column]:
    """Return the columns of metric packs; those of ``si`` carry no prefix."""
    return [
        Column(m.name if pack == DEFAULT_PACK else f"{pack}.{m.name}", pack, m.unit, m.better, m.description, m.path_metric)
        for pack, metrics in packs.items()
        for m in metrics
    ]


def _described(runs: Sequence[Run], packs: Sequence[str]) -> dict[str, Column]:
    """Return what these packs say about their columns, as configured in the runs; one that is not installed here is left out."""
    registry = load_registry()
    columns: dict[str, Column] = {}
    for pack in packs:
        try:
            node = _node(runs, pack)
            columns.update({c.name: c for c in columns_of(build_metrics({"metrics": {pack: node}}, registry))})
        except ArenaError:
            continue  # its figures are shown without unit and description
    return columns


def _node(runs: Sequence[Run], pack: str) -> Any:
    """Return a pack's configuration: a run's own, or the preset where the pack was evaluated only afterwards."""
    for run in runs:
        metrics = run.provenance.get("config", {}).get("metrics") or {}
        if pack in metrics:
            return metrics[pack]
    from omegaconf import OmegaConf

    return OmegaConf.to_container(compose([f"metrics=[{pack}]"], "component").metrics[pack], resolve=True)
