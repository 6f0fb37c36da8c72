"""What an executor calls: check that a run can be built, run one episode. Each works in whatever process it is in."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import Any

from arena_core.base.ctrl_c import interrupts
from arena_core.base.errors import ArenaError, ConfigurationError, RunFolderError, describe_error
from arena_core.base.folders import FolderLost, check_there, check_writable
from arena_core.base.notices import print_notice, take_notices
from arena_core.base.pulse import pulse
from arena_core.config.registry import Registry, load_registry
from arena_core.contracts.running import Finished, Job, Metric
from arena_core.loop.record_files import write_record
from arena_core.runs.jobs.benchmark import Benchmark, build_benchmark, identity_columns
from arena_core.runs.jobs.code_digest import Code
from arena_core.runs.jobs.compiling import MANY, NOTICE, announce_compilation
from arena_core.runs.jobs.rows import evaluate_record
from arena_core.values.episode import EpisodeRecord
from arena_core.values.staging import Staging
from arena_core.values.success import is_success

FOLLOWING = ("code", "privileged")


@dataclass(frozen=True, slots=True, eq=False)
class Checked:
    """What a run must know of what it is made of: how many episodes there are, its levels, notes for the user, what
    sees the truth, and the code.

    ``error`` is set, and the rest of no use, where the run cannot be built.
    """

    job: Job
    count: int | None = None
    staging: Staging | None = None
    untuned: Sequence[str] = ()
    learned_by: str = ""
    privileged: Sequence[str] = ()
    told: Sequence[str] = ()
    code: Code | None = None
    robots: int = 1
    error: ArenaError | None = None


def run_job(job: Job) -> Finished:
    """Run one episode, write its record and return its row; a failure is a row with its error.

    Raises RunFolderError when the record cannot be written: then nothing else could be either. What this process alone
    lacks, and a RunFolderError of foreign code, costs the episode alone.
    """
    try:
        with interrupts.let_go():
            benchmark = _cached_benchmark(_config_text(job.config))
            announce_compilation(_report_compilation)
        with interrupts.held():
            folder = Path(job.folder)
            check_there(folder)
            records = benchmark.run_all(job.episode, folder, job.stage)
            pulse.finish()
            check_there(folder)
            return _keep_records(job, folder, records, benchmark)
    except FolderLost as lost:
        raise RunFolderError(str(lost)) from lost
    except BaseException as error:  # sys.exit() of a planner's reset, say
        if interrupts.raised(error):
            raise
        return _failed_rows(job, describe_error(error))


def _keep_records(job: Job, folder: Path, records: Mapping[int, EpisodeRecord], benchmark: Benchmark) -> Finished:
    """Write the records of a job, by episode, and return their rows: that of the job's own episode, with the others."""
    rows = {}
    for episode, record in records.items():
        with check_writable(folder):
            write_record(folder, episode, record)
        _load_registry().manager.hook.episode_finished(record=record)
        rows[episode] = evaluate_row(replace(job, episode=episode), record, benchmark.metrics)
    return _with_team(rows.pop(job.episode), rows.values())


def _failed_rows(job: Job, reason: str) -> Finished:
    """Return the row of an episode that left no record, with those of its team."""
    team = range(1, job.robots)
    return _with_team(
        failed_row(job, reason), (failed_row(replace(job, episode=job.episode + k), reason) for k in team)
    )


def _with_team(finished: Finished, others: Iterable[Finished]) -> Finished:
    return replace(finished, team=tuple(others))


def compile_job(job: Job) -> None:
    """Have what guides a robot and decides for it compiled in this process; what is wrong with
    it is left to the episode to tell.
    """
    with suppress(Exception, SystemExit):
        with interrupts.let_go():
            benchmark = _cached_benchmark(_config_text(job.config))
        benchmark.warm_up()


def check_job(job: Job) -> Checked:
    """Build all that a run needs; return what the run must know of it, or the error that refuses it."""
    try:
        with interrupts.let_go():
            benchmark = _cached_benchmark(_config_text(job.config))
        task, planner = benchmark.task, benchmark.navigator.planner
        return Checked(
            job,
            task.count(),
            task.staging(),
            [*planner.untuned, *(benchmark.mates.untuned if benchmark.mates else ())],
            planner.learned_by,
            benchmark.privileged,
            take_notices(),
            benchmark.code,
            benchmark.robots,
        )
    except BaseException as error:
        if interrupts.raised(error):
            raise
        return Checked(
            job, error=error if isinstance(error, ArenaError) else cannot_be_built(job, describe_error(error))
        )


def failed_row(job: Job, reason: str) -> Finished:
    """Return the row of an episode that left no record."""
    row = {**identity_columns(job.config), "stage": job.stage, "episode": job.episode, "seed": job.config["seed"]}
    row |= {"member": job.episode % job.robots} if job.robots > 1 else {}
    return Finished(job, row | {"outcome": "error", "error": reason}, False)


def evaluate_row(job: Job, record: EpisodeRecord, packs: Mapping[str, Sequence[Metric]]) -> Finished:
    """Return the row of a record; a metric that fails makes it a row with that error."""
    try:
        return Finished(job, evaluate_record(record, packs), is_success(record))
    except Exception as error:
        return Finished(job, {**record.meta["columns"], "outcome": "error", "error": describe_error(error)}, False)


def cannot_be_built(job: Job, reason: str) -> ConfigurationError:
    """Return the error of a run that cannot be built."""
    return ConfigurationError(
        f"planner {job.config['planner']['name']}, or what it runs with, cannot be built: {reason}"
    )


def _report_compilation() -> None:
    pulse.compile()
    if pulse.compiled() == MANY:
        print_notice(NOTICE)


def _config_text(config: Mapping[str, Any]) -> str:
    """Return what a benchmark is built from; code and what sees the truth follow from it."""
    return json.dumps({key: value for key, value in config.items() if key not in FOLLOWING}, sort_keys=True)


@lru_cache(maxsize=1)
def _load_registry() -> Registry:
    return load_registry()


@lru_cache(maxsize=4)  # a worker sees the cells of a multirun one after the other
def _cached_benchmark(config: str) -> Benchmark:
    return build_benchmark(json.loads(config), _load_registry())
