"""One episode of a tuning, carried out in whatever process: its row, what it cost the people, and how long it took."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from time import perf_counter
from typing import Any

from arena_core.commands import one_line
from arena_core.hosting import Benchmark, Finished, Job, Registry, build_benchmark, load_registry, run_job
from arena_core.records import TEXT, read_record, record_path
from arena_reference.costing import cost_of_record
from arena_reference.people_cost import COLUMNS
from arena_tuning.objective import COST

DROVE, TWINS = "tuning.drove", "tuning.twins"  # s of an episode and of its twins, beside its metrics
KNOWN = f"{COST}people_displacement"  # of every episode whose twins could be driven
COST_NAMES = tuple(f"{COST}{column.name}" for column in COLUMNS if column.unit != TEXT)


def drive(job: Job) -> Finished:
    """Run an episode; its row says how long it took."""
    began = perf_counter()
    found = run_job(job)
    return replace(found, row={**found.row, DROVE: perf_counter() - began, TWINS: 0.0})


def drive_and_cost(job: Job) -> Finished:
    """Run an episode, then its twins; its row says what the robot cost the people, or why that is not known."""
    found = drive(job)
    began = perf_counter()
    try:
        told = _cost_of(job)
    except Exception as error:  # whatever a simulator raises: the episode itself is sound
        told = {"note": one_line(repr(error))}
    known = {f"{COST}{name}": value for name, value in told.items() if value != ""}
    return replace(found, row={**found.row, **known, TWINS: perf_counter() - began})


def _cost_of(job: Job) -> Mapping[str, Any]:
    """Return what the robot cost the people; nothing where no one is there, or the episode left no record."""
    path = record_path(Path(job.folder), job.episode)
    record = read_record(path) if path.is_file() else None
    if record is None or not record["pedestrian_positions"].size:
        return {}
    benchmark = _cached_benchmark(json.dumps(job.config, sort_keys=True))
    return cost_of_record(benchmark, _load_registry(), record, job.episode, job.stage)


@lru_cache(maxsize=1)
def _load_registry() -> Registry:
    return load_registry()


@lru_cache(maxsize=4)  # as many cells as a worker of a run keeps
def _cached_benchmark(config: str) -> Benchmark:
    return build_benchmark(json.loads(config), _load_registry())
