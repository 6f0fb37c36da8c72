"""Run benchmarks: plan the episodes, hand them to an executor, keep every finished one, write tables and report."""

from __future__ import annotations

import csv
import json
import platform
import subprocess
import sys
from collections.abc import Iterable, Mapping, Sequence
from contextlib import closing, suppress
from dataclasses import dataclass
from functools import lru_cache
from importlib.metadata import distributions
from pathlib import Path
from typing import Any

from arena_core.benchmark import Benchmark, build_benchmark, build_metrics, config_hash, identification
from arena_core.configuration import plain
from arena_core.errors import ArenaError, ConfigurationError, RunFolderError, RunStopped
from arena_core.evaluate import COLUMNS, evaluate, write_episodes
from arena_core.interfaces import Job
from arena_core.interrupt import interrupts
from arena_core.progress import Progress
from arena_core.recording import read_record, write_record, write_text_whole
from arena_core.registry import Registry, load_registry
from arena_core.rounds import Run, rounds
from arena_core.success import succeeded


@dataclass(frozen=True, slots=True, eq=False)
class RunRequest:
    """A composed configuration, the folder of its run, and which option of each configuration group made it."""

    config: Any
    folder: Path
    choices: Mapping[str, str | None]


def run_all(requests: Sequence[RunRequest]) -> int:
    """Run every episode of every request through one executor; return the exit status (0 all ran, 1 some episode failed).

    All configurations are checked before anything runs. On Ctrl-C or a full disk what was finished is kept.
    """
    registry = load_registry()
    runs = [_prepare(request, registry) for request in requests]
    executor = registry.build("executor", runs[0].config["executor"])
    try:
        with interrupts.heard(), closing(executor), Progress(runs) as progress:
            for jobs in rounds(runs):
                progress.begin(jobs)
                for row in executor.map(work, jobs):
                    interrupts.check()  # before the row is taken: it may be that of an episode that the interrupt broke
                    _take(row, runs)
                    progress.add(row)
                progress.end()
        _write_all(runs)
    except BaseException as error:
        with suppress(RunFolderError):  # where there is no room for a table either, the records are still there
            _write_all(runs)
        if not isinstance(error, RunFolderError):
            raise
        raise RunStopped(f"{error}; finished episodes are kept, resume=true hydra.run.dir=DIR continues") from error
    _finish(runs, registry)
    return int(any(row["outcome"] == "error" for run in runs for row in run.rows.values()))


def _take(row: Mapping[str, Any], runs: Iterable[Run]) -> None:
    """Hand a row of ``work`` to its run."""
    run = next(run for run in runs if str(run.folder) == row["folder"])
    run.take({name: value for name, value in row.items() if name not in ("folder", "succeeded")}, row["succeeded"])


def _write_all(runs: Iterable[Run]) -> None:
    for run in runs:
        run.write()


def work(job: Job) -> dict[str, Any]:
    """Run one episode in whatever process this is, write its record and return its row; a failure is a row with its error.

    Beside the columns, the row has ``folder``, and ``succeeded`` for tasks that adapt.

    Raises RunFolderError when the record cannot be written: then nothing else could be either.
    """
    config = json.dumps(job.config, sort_keys=True)
    try:
        benchmark = _benchmark(config)
        with interrupts.held():
            record = benchmark.run(job.episode, Path(job.folder), job.stage)
            write_record(Path(job.folder), job.episode, record)
            _registry().manager.hook.episode_finished(record=record)
            row = {**evaluate(record, benchmark.metrics), "succeeded": succeeded(record)}
    except RunFolderError:
        raise
    except Exception as error:
        seed, name = job.config["seed"], type(error).__name__
        row = {**identification(job.config), "stage": job.stage, "episode": job.episode, "seed": seed, "outcome": "error"}
        row |= {"error": " ".join(f"{name}: {error}".split()), "succeeded": False}
    return {**row, "folder": job.folder}


@lru_cache(maxsize=1)
def _registry() -> Registry:
    return load_registry()


@lru_cache(maxsize=4)  # a worker sees the cells of a multirun one after the other
def _benchmark(config: str) -> Benchmark:
    return build_benchmark(json.loads(config), _registry())


def _prepare(request: RunRequest, registry: Registry) -> Run:
    """Check a configuration by building it, open its folder and read what an interrupted run has left."""
    config = plain(request.config)
    config["choices"] = {k: v for k, v in request.choices.items() if v is not None and not k.startswith("hydra/")}
    benchmark = build_benchmark(config, registry)
    limit = benchmark.task.count()
    if limit is not None and config["episodes"] > limit:
        raise ConfigurationError(f"episodes is {config['episodes']}; allowed: at most {limit} with this task")
    folder = request.folder.resolve()
    run = Run(config, folder, benchmark.metrics, benchmark.task.staging())
    if (folder / "provenance.json").exists():
        _continue(run)
    facts = provenance(config, benchmark.navigator.planner.untuned)
    for note in facts["untuned"]:
        print(note, file=sys.stderr)
    write_text_whole(folder / "provenance.json", json.dumps(facts, indent=2, sort_keys=True) + "\n")
    run.write()
    return run


def _continue(run: Run) -> None:
    """Take over the finished episodes of an earlier run of the same cell and seed in this folder."""
    if not run.config["resume"]:
        raise ConfigurationError(f"{run.folder} holds a run already; resume=true continues it, hydra.run.dir=DIR takes another folder")
    before = _provenance_of(run.folder / "provenance.json")
    now = {"config_hash": config_hash(run.config), "seed": run.config["seed"]}
    if any(before.get(key) != value for key, value in now.items()):
        raise ConfigurationError(f"{run.folder} holds a run of another configuration or seed; resume=true continues only the same one")
    for path in sorted((run.folder / "records").glob("[0-9]*.npz")):
        record = read_record(path)
        run.rows[int(path.stem)], run.successes[int(path.stem)] = evaluate(record, run.packs), succeeded(record)


def provenance(config: Mapping[str, Any], notes: Sequence[str]) -> dict[str, Any]:
    """Return what a reader needs to repeat a run: versions, seed, commit, machine, and what is untuned, with the planner's ``notes``."""
    versions = {d.metadata["Name"]: d.version for d in distributions() if d.metadata["Name"]}
    return {
        "config_hash": config_hash(config),
        "seed": config["seed"],
        "episodes": config["episodes"],
        "config": dict(config),
        "versions": dict(sorted(versions.items())),
        "python": platform.python_version(),
        "commit": _commit(),
        "machine": {"system": platform.platform(), "processor": platform.machine()},
        "untuned": [*untuned(config.get("choices", {})), *notes],
    }


def untuned(choices: Mapping[str, str]) -> list[str]:
    """Return a note for every optional tuning that a chosen component asks for and no file holds."""
    from hydra.core.global_hydra import GlobalHydra

    if not GlobalHydra.instance().is_initialized():
        return []
    options = GlobalHydra.instance().config_loader().get_group_options
    tunings = [(group.partition("@")[0], option) for group, option in choices.items() if "_tuning" in group]
    return [f"{group.rpartition('/')[2].removesuffix('_tuning')}: untuned for {o}" for group, o in tunings if o not in options(group)]


def _commit() -> str:
    """Return the commit of the checkout that the core runs from, with + when it has changes; empty outside a checkout."""
    here = Path(__file__).resolve().parent.parent
    if not (here / ".git").exists():
        return ""
    try:
        command = ["git", "describe", "--always", "--dirty=+", "--abbrev=12", "--exclude=*"]
        answer = subprocess.run(command, cwd=here, capture_output=True, text=True, check=True)  # noqa: S603 - fixed words
    except (OSError, subprocess.CalledProcessError):
        return ""
    return answer.stdout.strip()


def _finish(runs: Iterable[Run], registry: Registry) -> None:
    """Say what came out, and write a report for each run when a plugin offers one."""
    runs = list(runs)
    for run in runs:
        _print_errors(run)
    if not all(run.config["report"] for run in runs) or "report" not in registry.names("command"):
        for run in runs:
            print(f"records: {run.folder}")
        return
    report = registry.component("command", "report").resolve()()
    folder = runs[0].folder if len(runs) == 1 else runs[0].folder.parent
    report.run([str(folder)])


def _print_errors(run: Run) -> None:
    for episode, row in sorted(run.rows.items()):
        if row["outcome"] == "error":
            print(f"episode {episode} failed: {row['error']}", file=sys.stderr)


def re_evaluate(folder: Path, registry: Registry, metrics: Mapping[str, Any] | None = None) -> int:
    """Compute all metrics of a run anew from its records, its own packs or these; return the number of episodes.

    Rows of episodes that failed without a record are kept.
    """
    config = _provenance_of(folder / "provenance.json")["config"]
    packs = build_metrics({"metrics": metrics} if metrics else config, registry)
    rows = {int(row["episode"]): row for row in _failed_rows(folder)}
    rows |= {int(record.stem): evaluate(read_record(record), packs) for record in sorted((folder / "records").glob("[0-9]*.npz"))}
    if not rows:
        raise ArenaError(f"{folder}: no episode to evaluate")
    write_episodes(folder, rows.values(), packs)
    return len(rows)


def _provenance_of(path: Path) -> dict[str, Any]:
    try:
        facts: dict[str, Any] = json.loads(path.read_text())
        facts["config"]["seed"]
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise RunFolderError(f"cannot read {path}: {error}") from error
    return facts


def _failed_rows(folder: Path) -> list[dict[str, Any]]:
    with (folder / "episodes.csv").open(newline="") as file:
        return [{k: row[k] for k in COLUMNS} for row in csv.DictReader(file) if row["outcome"] == "error"]
