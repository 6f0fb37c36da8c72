"""What an earlier run left in a folder: the rows of its records, those of other code, and what is half-written."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Any

from arena_core.base.ctrl_c import interrupts
from arena_core.base.errors import ArenaError, ConfigurationError, InputFileError, RunFolderError
from arena_core.base.files import read_table
from arena_core.base.folders import ITS_FOLDER
from arena_core.config.registry import Registry
from arena_core.contracts.running import Finished, Job, Lost
from arena_core.loop.half_written import remove_half_written
from arena_core.loop.record_files import read_record
from arena_core.loop.record_places import record_path, record_paths
from arena_core.runs.folders.kept_rows import KeptRow
from arena_core.runs.folders.provenance import NAME, read_provenance
from arena_core.runs.folders.schedule import OpenRun
from arena_core.runs.jobs.benchmark import build_metrics, config_hash
from arena_core.runs.jobs.rows import COLUMNS, OF_TEAMS, evaluate_file, write_episodes
from arena_core.runs.jobs.working import evaluate_row, failed_row


def take_over(run: OpenRun) -> None:
    """Take over the finished episodes of an earlier run of the same cell and seed, if its folder holds one."""
    if not (run.folder / NAME).exists():
        return
    if not run.config["resume"]:
        raise ConfigurationError(
            f"{run.folder} holds a run already; resume=true continues it, {ITS_FOLDER} takes another folder"
        )
    before = read_provenance(run.folder)
    now = {"config_hash": config_hash(run.config), "seed": run.config["seed"]}
    if any(before.get(key) != value for key, value in now.items()):
        raise ConfigurationError(
            f"{run.folder} holds a run of another configuration or seed; resume=true continues only the same one"
        )
    for path in _records_without_row(run):
        interrupts.check()
        _take_record(run, path)
    if run.superseded and run.config["resume"] != "force":
        raise ConfigurationError(_other_code(run, before))


def complete_tables(runs: Iterable[OpenRun]) -> None:
    """Complete the tables of runs that were cut short, by the records whose rows never came."""
    for run in runs:
        with suppress(RunFolderError):  # where there is no room for a table, the records are still there
            remove_half_written(run.folder)
            for path in _records_without_row(run):
                with suppress(InputFileError):
                    _take_record(run, path)
            run.write()


def check_counts(run: OpenRun) -> None:
    """Count a finished run's rows and records against each other, whoever carried its jobs; raise RunFolderError where
    they differ.

    A record without a row is taken. An episode that ended with an error need not have a record.
    """
    for path in _records_without_row(run):
        with suppress(InputFileError):
            _take_record(run, path)
            run.unwritten = True
    if run.unwritten:
        run.write()
    recorded = {int(path.stem) for path in record_paths(run.folder)}
    unrecorded = sum(row["outcome"] != "error" and episode not in recorded for episode, row in run.rows.items())
    if run.left() or unrecorded:
        counts = f"{run.left()} of {run.total} episodes have no row, {unrecorded} rows have no record"
        raise RunFolderError(f"{run.folder}: {counts}; allowed: both for each, and files that no one else changes")


def rows_of_lost(lost: Lost, run: OpenRun) -> list[Finished]:
    """Return the rows of a job that was lost, one for each robot."""
    jobs = (replace(lost.job, episode=lost.job.episode + member) for member in range(run.robots))
    return [_row_of_lost(Lost(job, lost.reason), run) for job in jobs]


def _row_of_lost(lost: Lost, run: OpenRun) -> Finished:
    """Return the row of a job that was lost: that of its record where it came so far, else one with the reason."""
    with suppress(InputFileError):
        found = evaluate_row(lost.job, read_record(record_path(run.folder, lost.job.episode)), run.packs)
        if found.row.get("code") == run.code.digest:  # not what other code left there
            return found
    return failed_row(lost.job, lost.reason)


def _records_without_row(run: OpenRun) -> list[Path]:
    return [path for path in record_paths(run.folder) if int(path.stem) not in run.rows]


def _take_record(run: OpenRun, path: Path) -> None:
    """Take the row of a finished episode; one of other code stands only until it is run again."""
    episode = int(path.stem)
    found = evaluate_row(Job(run.config, str(run.folder), episode), read_record(path), run.packs)
    if found.row.get("code") != run.code.digest:
        run.superseded[episode] = KeptRow(found.row)
    else:
        run.rows[episode], run.successes[episode] = KeptRow(found.row), found.succeeded


def _other_code(run: OpenRun, before: Mapping[str, Any]) -> str:
    """Return the line for a folder in which episodes of other code lie."""
    then = (before.get("code") or {}).get("parts") or {}
    what = f": {', '.join(run.code.changed(then)) or 'changed while it ran'}" if then else ", which it does not name"
    count = len(run.superseded)
    held = f"{run.folder} holds {count} episode{'s' * (count > 1)} of other code{what}"
    return f"{held}; resume=force runs these again and keeps the rest, {ITS_FOLDER} takes another folder"


def re_evaluate(
    folder: Path, registry: Registry, metrics: Mapping[str, Any] | None = None, target: Path | None = None
) -> int:
    """Compute all metrics of a run again from its records, its own packs or these; return the number of episodes.

    Rows of episodes that failed without a record are kept. The table goes to ``target``, None: to the run's folder.
    """
    config = read_provenance(folder)["config"]
    packs = build_metrics({"metrics": metrics} if metrics else config, registry)
    rows = {int(row["episode"]): row for row in _failed_rows(folder)}
    rows |= {int(record.stem): evaluate_file(record, packs) for record in record_paths(folder)}
    if not rows:
        raise ArenaError(f"{folder}: no episode to evaluate")
    write_episodes(folder if target is None else target, rows.values(), packs)
    return len(rows)


def _failed_rows(folder: Path) -> list[dict[str, Any]]:
    path, allowed = folder / "episodes.csv", "a table that `arena run` wrote"
    columns, rows = read_table(path, allowed)
    lacking = [name for name in COLUMNS if name not in columns]
    if lacking:
        raise InputFileError(f"{path}: lacks the column {lacking[0]}; allowed: {allowed}")
    kept = [*COLUMNS, *(name for name in OF_TEAMS if name in columns)]
    return [{k: row[k] for k in kept} for row in rows if row["outcome"] == "error"]
