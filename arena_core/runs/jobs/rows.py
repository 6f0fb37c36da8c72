"""From records to rows: identification, outcome, then one column a metric."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from numpy.typing import NDArray

from arena_core.base.cells import csv_text
from arena_core.base.errors import InputFileError, one_line
from arena_core.base.files import reason_of
from arena_core.base.whole_files import write_text_whole
from arena_core.contracts.running import Metric
from arena_core.loop.record_files import read_record
from arena_core.loop.record_layout import fault_of_numbers
from arena_core.loop.record_places import record_paths
from arena_core.values.episode import EpisodeRecord

COLUMNS = (
    *(
        "config_hash",
        "code",
        "planner",
        "preset",
        "robot",
        "simulator",
        "world",
        "task",
        "scenario",
        "scenario_hash",
        "stage",
    ),
    *(
        "n_pedestrians",
        "pedestrian_model",
        "reaction",
        "localizer",
        "timing",
        "predictor",
        "privileged",
        "episode",
        "seed",
        "outcome",
        "error",
    ),
)
TEAM_TEXTS = ("communication",)  # columns of texts that only runs of teams have: by what they tell each other
OF_TEAMS = ("member", *TEAM_TEXTS)  # and which robot of its team a row is of
TEXT = "text"  # the unit of metrics that are texts


def metric_columns(packs: Mapping[str, Sequence[Metric]]) -> list[str]:
    """Return the column of every metric of packs as ``build_metrics`` returns them."""
    return [metric_column(pack, metric) for pack, metrics in packs.items() for metric in metrics]


def metric_column(pack: str, metric: Metric) -> str:
    """Return the column of one metric; ``pack`` is empty for the one whose columns are bare."""
    return f"{pack}.{metric.name}" if pack else metric.name


def evaluate_record(record: EpisodeRecord, packs: Mapping[str, Sequence[Metric]]) -> dict[str, Any]:
    """Return the row of one episode; a metric is empty where it asks for an array that is not
    known (``meta["unknown"]``).
    """
    if fault := fault_of_numbers(record.arrays):  # before any metric makes room for them
        raise InputFileError(f"the record holds numbers that are too far off: {fault}")
    if record.meta.get("unknown"):
        record = _Known(record.arrays, record.meta, record.timing)
    row = {**record.meta["columns"], "outcome": record.meta["outcome"], "error": one_line(record.meta["error"])}
    return row | {
        metric_column(pack, metric): _metric_value(metric, record)
        for pack, metrics in packs.items()
        for metric in metrics
    }


class _Unknown(Exception):
    """A metric asked for what no one recorded."""


class _Known(EpisodeRecord):
    """A record of which some arrays are not known; ``meta["unknown"]`` names them with the reasons."""

    __slots__ = ()

    def __getitem__(self, name: str) -> NDArray[Any]:
        if name in self.meta["unknown"]:
            raise _Unknown
        return self.arrays[name]


def _metric_value(metric: Metric, record: EpisodeRecord) -> float | str:
    try:
        found = metric.compute(record)
    except _Unknown:
        found = "" if metric.unit == TEXT else math.nan
    if isinstance(found, str) != (metric.unit == TEXT):
        raise TypeError(
            f"metric {metric.name} is {found!r} in unit {metric.unit}; allowed: a text in unit text, else a number"
        )
    return one_line(found) if isinstance(found, str) else float(found)


def evaluate_folder(folder: Path, packs: Mapping[str, Sequence[Metric]]) -> list[dict[str, Any]]:
    """Return the rows of all records of a run, in order of episode."""
    return [evaluate_file(path, packs) for path in record_paths(folder)]


def evaluate_file(path: Path, packs: Mapping[str, Sequence[Metric]]) -> dict[str, Any]:
    """Return the row of a record's file; raise InputFileError, also where a metric can make
    nothing of what the record holds.
    """
    record = read_record(path)
    try:
        return evaluate_record(record, packs)
    except Exception as error:  # whatever a metric, which may be a plugin's, stumbles over
        raise InputFileError(
            f"{path}: cannot be evaluated ({reason_of(error)}); allowed: a record that `arena run` wrote"
        ) from error


def write_episodes(folder: Path, rows: Iterable[Mapping[str, Any]], packs: Mapping[str, Sequence[Metric]]) -> None:
    """Write ``episodes.csv``, whole, in order of episode; a value that is not defined is left empty."""
    ordered = sorted(rows, key=lambda row: int(row["episode"]))
    own = [name for name in OF_TEAMS if any(name in row for row in ordered)]
    columns = [*COLUMNS, *own, *metric_columns(packs)]
    cells = ([row.get(column, "") for column in columns] for row in ordered)
    write_text_whole(folder / "episodes.csv", csv_text([columns, *cells]))
