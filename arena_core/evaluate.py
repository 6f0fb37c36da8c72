"""From records to rows: identification, outcome, then one column a metric."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from arena_core.episode import EpisodeRecord
from arena_core.interfaces import Metric
from arena_core.recording import read_record, write_text_whole

COLUMNS = (
    *("config_hash", "planner", "preset", "robot", "simulator", "world", "task", "scenario", "scenario_hash", "stage", "n_pedestrians"),
    *("pedestrian_model", "reaction", "localizer", "timing", "episode", "seed", "outcome", "error"),
)
DEFAULT_PACK = "si"


def metric_columns(packs: Mapping[str, Sequence[Metric]]) -> list[str]:
    """Return the column of every metric: bare for the pack ``si``, prefixed for others."""
    return [column(pack, metric) for pack, metrics in packs.items() for metric in metrics]


def column(pack: str, metric: Metric) -> str:
    """Return the column of one metric."""
    return metric.name if pack == DEFAULT_PACK else f"{pack}.{metric.name}"


def evaluate(record: EpisodeRecord, packs: Mapping[str, Sequence[Metric]]) -> dict[str, Any]:
    """Return the row of one episode."""
    row = {**record.meta["columns"], "outcome": record.meta["outcome"], "error": record.meta["error"]}
    return row | {column(pack, metric): float(metric.compute(record)) for pack, metrics in packs.items() for metric in metrics}


def evaluate_folder(folder: Path, packs: Mapping[str, Sequence[Metric]]) -> list[dict[str, Any]]:
    """Return the rows of all records of a run, in order of episode."""
    return [evaluate(read_record(path), packs) for path in sorted((folder / "records").glob("[0-9]*.npz"))]


def write_episodes(folder: Path, rows: Iterable[Mapping[str, Any]], packs: Mapping[str, Sequence[Metric]]) -> None:
    """Write ``episodes.csv``, whole, in order of episode; a value that is not defined is left empty."""
    text = io.StringIO()
    writer = csv.DictWriter(text, [*COLUMNS, *metric_columns(packs)], restval="", lineterminator="\n")
    writer.writeheader()
    for row in sorted(rows, key=lambda row: int(row["episode"])):
        writer.writerow({key: _cell(value) for key, value in row.items()})
    write_text_whole(folder / "episodes.csv", text.getvalue())


def _cell(value: Any) -> Any:
    if isinstance(value, float):
        return "" if value != value else repr(value)
    return value
