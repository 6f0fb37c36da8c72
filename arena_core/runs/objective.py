"""What a sweeper that looks for the best is told of a run: the mean of a metric over its episodes."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from statistics import fmean
from typing import Any

from arena_core.base.errors import ConfigurationError
from arena_core.base.files import read_table
from arena_core.config.binding import read_settings
from arena_core.config.registry import Registry
from arena_core.runs.jobs.benchmark import build_metrics
from arena_core.runs.jobs.rows import TEXT, metric_column

Objective = float | list[float]


def check_objective(config: Mapping[str, Any], registry: Registry) -> None:
    """Raise ConfigurationError where a composed configuration asks for a figure that its metric packs do not have."""
    read_settings(config["objective"], str | list[str] | None, "objective")  # type: ignore[arg-type]
    packs = build_metrics(config, registry) if config["objective"] is not None else {}
    known = [
        metric_column(pack, metric) for pack, metrics in packs.items() for metric in metrics if metric.unit != TEXT
    ]
    for name in _metric_names(config["objective"]):
        if name not in known:
            raise ConfigurationError(f"objective is {name}; allowed: null, or out of {', '.join(known)}")


def objective_of(folder: Path, wanted: str | list[str]) -> Objective:
    """Return the mean of a metric over the episodes of a run in which it is defined, or of several; raise
    ConfigurationError for none.
    """
    _, rows = read_table(folder / "episodes.csv", "a table that `arena run` wrote")
    values = {name: [float(row[name]) for row in rows if row[name]] for name in _metric_names(wanted)}
    means = {name: fmean(found) if found else math.nan for name, found in values.items()}
    for name, mean in means.items():
        if not math.isfinite(mean):
            raise ConfigurationError(
                f"objective {name} is not defined in any episode of {folder}; allowed: one that is"
            )
    return means[wanted] if isinstance(wanted, str) else [means[name] for name in wanted]


def _metric_names(wanted: str | list[str] | None) -> list[str]:
    return [] if wanted is None else [wanted] if isinstance(wanted, str) else list(wanted)
