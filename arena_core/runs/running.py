"""Run benchmarks: plan the episodes, hand them to an executor, keep every finished one, write tables and report."""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, closing
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from arena_core.base.ctrl_c import interrupts
from arena_core.base.errors import ConfigurationError, RunFolderError, RunStopped
from arena_core.base.files import check_inside
from arena_core.base.folders import KEPT, folder_identity, lock_folder
from arena_core.base.notices import print_notice
from arena_core.base.whole_files import write_text_whole
from arena_core.config.configuration import to_plain
from arena_core.config.registry import Registry
from arena_core.contracts.running import Executor, Finished, Job, Lost
from arena_core.loop.half_written import keep_room, remove_half_written
from arena_core.runs.folders.provenance import NAME, make_provenance, missing_tunings
from arena_core.runs.folders.resuming import check_counts, complete_tables, rows_of_lost, take_over
from arena_core.runs.folders.schedule import OpenRun, job_rounds
from arena_core.runs.folders.tunings import tuning_of
from arena_core.runs.jobs.benchmark import build_metrics, check_complete
from arena_core.runs.jobs.working import Checked, cannot_be_built, check_job, run_job
from arena_core.runs.progress import Progress
from arena_core.runs.references import References

# bytes kept free for the table: so that it has a row for every record on a disk that is full, too
ROW, MOST_ROOM = 2000, 2**24
WRITERS = 8  # folders written at a time: disks take several files together nearly as soon as one


@dataclass(frozen=True, slots=True, eq=False)
class RunRequest:
    """A composed configuration, the folder of its run, and which option of each configuration group made it.

    ``files`` are texts, by name, that are written to the folder once the request is accepted.
    """

    config: Any
    folder: Path
    choices: Mapping[str, str | None]
    files: Mapping[str, str] = field(default_factory=dict)


def run_all(requests: Sequence[RunRequest], registry: Registry) -> list[OpenRun]:
    """Run every episode of every request through one executor, have their references find out what they do, and return
    the runs.

    All configurations are checked, and the folders kept from other runs, before anything runs or is written. Whatever
    ends the run early (a signal, a full disk), what was finished is kept.
    """
    with interrupts.heard(), interrupts.held(), ExitStack() as folders, ExitStack() as staff:
        jobs = _check_jobs(requests)
        for job in jobs:
            folders.enter_context(lock_folder(Path(job.folder)))
        references = References([job.config for job in jobs], registry)
        executor = staff.enter_context(closing(registry.build("executor", jobs[0].config["executor"])))
        runs = _prepare_runs(jobs, registry, executor)
        for note in (note for run in runs for note in [*_run_notes(run, registry), *_seeing_notes(run)]):
            print(note, file=sys.stderr)
        side_by_side(lambda run, request: _open_run(run, request.files, registry), runs, requests)
        _drive_runs(runs, executor, staff)
    references.refer(runs)
    for run in runs:
        for episode, row in sorted(run.rows.items()):
            if row["outcome"] == "error":
                print(f"episode {episode} failed: {row['error']}", file=sys.stderr)
    return runs


def write_reports(runs: Sequence[OpenRun], registry: Registry, above: Path | None = None) -> None:
    """Write a report over the runs where a plugin offers one and the configuration wants it; else say where the records
    are.

    That of several runs lies in the folder ``above`` them, or in the one that they share where some lie elsewhere.
    """
    reporters = registry.names("reporter")
    if not reporters or not all(run.config["report"] for run in runs):
        for run in runs:
            print(f"records: {run.folder}")
        return
    folder = runs[0].folder if len(runs) == 1 else _common_folder([run.folder for run in runs], above)
    with interrupts.heard():
        registry.component("reporter", reporters[0]).resolve()().report([folder], folder / "report")


def _common_folder(folders: Sequence[Path], above: Path | None) -> Path:
    """Return the folder in which all of several lie: ``above`` where it is one, else the deepest."""
    if above is not None and all(folder.is_relative_to(above.resolve()) for folder in folders):
        return above
    return Path(os.path.commonpath(folders))


def _drive_runs(runs: Sequence[OpenRun], executor: Executor, staff: ExitStack) -> None:
    """Run all episodes and take their rows; when that is cut short, close ``staff`` and take what is on disk."""
    try:
        with Progress(runs) as progress:
            for jobs in job_rounds(runs):
                progress.begin(jobs)
                for answer in executor.map(run_job, jobs):
                    interrupts.check()  # before the row is taken: it may be that of an episode that the interrupt broke
                    for finished in _store_answer(answer, runs):
                        progress.add(finished)
                progress.end()
        side_by_side(_close_run, runs)
        staff.close()
        for run in runs:
            check_counts(run)
    except BaseException as error:
        staff.close()  # from here on no one writes but this process
        complete_tables(runs)
        if not isinstance(error, RunFolderError):
            raise
        raise RunStopped(f"{error}; {KEPT}") from error


def _store_answer(answer: Finished | Lost, runs: Iterable[OpenRun]) -> list[Finished]:
    """Hand what came of a job to its run, of each robot; return it."""
    run = next(run for run in runs if str(run.folder) == answer.job.folder)
    found = rows_of_lost(answer, run) if isinstance(answer, Lost) else [answer, *answer.team]
    for finished in found:
        run.take(finished)
    return found


def _check_jobs(requests: Sequence[RunRequest]) -> list[Job]:
    """Return what stands for each request until its episodes are planned; raise ConfigurationError where
    two would share a folder.
    """
    jobs: dict[str, Job] = {}
    for request in requests:
        config = to_plain(request.config)
        config["choices"] = {k: v for k, v in request.choices.items() if v is not None and not k.startswith("hydra/")}
        check_complete(config)
        folder = str(request.folder.resolve())
        if folder in jobs:
            raise ConfigurationError(
                f"two runs would share the folder {folder}; allowed: a hydra.sweep.subdir for each"
            )
        jobs[folder] = Job(config, folder, 0)
    return list(jobs.values())


def _prepare_runs(jobs: Sequence[Job], registry: Registry, executor: Executor) -> list[OpenRun]:
    """Check every configuration by having it built, and read what interrupted runs have left."""
    checked: dict[str, Checked] = {}
    for answer in executor.prepare(check_job, jobs):
        if isinstance(answer, Lost):
            answer = Checked(answer.job, error=cannot_be_built(answer.job, answer.reason))
        checked[answer.job.folder] = answer
    return [_run_of(checked[job.folder], job, registry) for job in jobs]


def _run_of(checked: Checked, job: Job, registry: Registry) -> OpenRun:
    if checked.error is not None:
        raise checked.error
    assert checked.code is not None
    for line in checked.told:
        print_notice(line)
    limit, asked = checked.count, job.config["episodes"]
    if limit is not None and asked > limit:
        raise ConfigurationError(f"episodes is {asked}; allowed: at most {limit} with this task")
    config = {**job.config, "code": checked.code.digest, "privileged": list(checked.privileged)}
    run = OpenRun(
        config,
        Path(job.folder),
        build_metrics(config, registry),
        checked.staging,
        checked.code,
        checked.untuned,
        checked.learned_by,
        checked.robots,
    )
    take_over(run)
    return run


def _run_notes(run: OpenRun, registry: Registry) -> list[str]:
    """Return what is to be told of a run ahead of it."""
    return [*missing_tunings(run.config.get("choices", {}), registry.manager), *run.untuned]


def _seeing_notes(run: OpenRun) -> list[str]:
    """Return what is to be told of a run in which something sees the truth."""
    names = run.config["privileged"]
    return [f"{' and '.join(names)} {'see' if len(names) > 1 else 'sees'} the truth: no planner for a robot"] * bool(
        names
    )


def _open_run(run: OpenRun, files: Mapping[str, str], registry: Registry) -> None:
    """Write what a run's folder begins with, and remove what a killed run has left half-written."""
    remove_half_written(run.folder)
    for name, text in files.items():
        check_inside(run.folder, (run.folder / name).parent)
        write_text_whole(run.folder / name, text)
    run.place = folder_identity(run.folder)
    told = make_provenance(run.config, run.code, _run_notes(run, registry))
    told["tuning"] = {**tuning_of(run.config, registry.manager), "learned_by": run.learned_by}
    write_text_whole(run.folder / NAME, json.dumps(told, indent=2, sort_keys=True) + "\n")
    run.write()
    keep_room(run.folder, min(ROW * run.total, MOST_ROOM))


def _close_run(run: OpenRun) -> None:
    """Give back the room that was kept, and write the table where rows have come since."""
    remove_half_written(run.folder)
    if run.unwritten:
        run.write()


def side_by_side(write: Callable[..., None], *arguments: Sequence[Any]) -> None:
    """Call ``write`` with the first of each sequence, the second of each, and so on, a few at a
    time; raise the first failure.
    """
    with ThreadPoolExecutor(WRITERS) as writers:
        for _ in writers.map(write, *arguments):
            pass
