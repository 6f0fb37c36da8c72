"""``arena compile``: all kernels ahead of the runs that want them, for this processor or a common one."""

from __future__ import annotations

import os
import platform
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from itertools import zip_longest
from pathlib import Path
from typing import ClassVar

from arena_core import ConfigurationError
from arena_core.commands import Command, print_notice, read_words
from arena_core.hosting import Registry, load_registry
from arena_core.parameters import PositiveInt
from arena_kernels.ready import (
    CHOSEN,
    CPU,
    CPU_FEATURES,
    FOLDER,
    TARGETS,
    Target,
    note_native,
    processor_flags,
    read_manifest,
    write_manifest,
)

USAGE = "arena compile [planner=NAME,...] [workers=N] [out=DIR]"
MOMENT = ("task.pedestrians=3", "task.time_limit=3", "episodes=1", "executor=serial", "report=false")
ROBOT = "robot=jackal"
PARTS = ("simulator", "pedestrians", "localizer", "global_planner", "robot")  # kinds that have kernels, beside planners
LEFT_OUT = ("planner=ros_external", "pedestrians=replay", "pedestrians=timetable")  # these want a file, or a robot
SET = (CPU, CPU_FEATURES, CHOSEN)
LOCK = "kernels.lock"


class CompileCommand(Command):
    """Compile what planners, simulators and crowds call, so that no run has to; ``out``: for a common processor."""

    help: ClassVar[str] = f"kernels ahead of the runs that want them: {USAGE}"

    def run(self, arguments: Sequence[str]) -> int:
        """Have each installed component drive for a moment; return 1 where one could not."""
        words = read_words(USAGE, arguments, keys=("planner", "workers", "out"))
        out = words.value("out", str | None, None)
        registry = load_registry()
        chosen = words.value("planner", str, ",".join(_planners_first(registry))).split(",")
        drives = list(drives_of(registry, chosen))
        target = None if out is None else _target_here()
        environ = _native_environment() if target is None else _common_environment(target, Path(str(out)))
        failed = _drive_all(drives, environ, words.value("workers", PositiveInt, os.cpu_count() or 1))
        for drive, why in failed:
            print_notice(f"not compiled: {drive}: {why}")
        if len(failed) < len(drives):
            print(_keep_note(target, out), len(drives) - len(failed), "drives")
        return int(bool(failed))


def drives_of(registry: Registry, planners: Sequence[str]) -> Iterator[str]:
    """Yield the words of drives in which the kernels of these planners, and of all that is beside them, are called."""
    known = registry.names("planner")
    if unknown := [name for name in planners if name not in known]:
        raise ConfigurationError(f"planner is {unknown[0]}; allowed: {', '.join(known)}")
    yield from (f"{words} {ROBOT}" for name in planners if (words := f"planner={name}") not in LEFT_OUT)
    for row in zip_longest(*(_options(registry, kind) for kind in PARTS), fillvalue=""):
        beside = " ".join(filter(None, row))
        yield f"planner={planners[0]} {beside}" + (f" {ROBOT}" if "robot=" not in beside else "")


def _options(registry: Registry, kind: str) -> list[str]:
    return [words for name in registry.names(kind) if (words := f"{kind}={name}") not in LEFT_OUT]


def _planners_first(registry: Registry) -> list[str]:
    """Return all planners, DWA first: what is beside a planner is driven with the first one."""
    return sorted(registry.names("planner"), key=lambda name: name != "dwa")


def _target_here() -> Target:
    if (machine := platform.machine()) not in TARGETS:
        raise ConfigurationError(f"out is given on {machine}; allowed: on {', '.join(TARGETS)}")
    return TARGETS[machine]


def _native_environment() -> dict[str, str]:
    kept = os.environ if CHOSEN not in os.environ else {k: v for k, v in os.environ.items() if k not in SET}
    return {**kept, "ARENA_KERNELS": "native"}


def _common_environment(target: Target, folder: Path) -> dict[str, str]:
    folder.mkdir(parents=True, exist_ok=True)
    place = {"NUMBA_CACHE_DIR": str(folder.resolve()), CPU: target.cpu, CPU_FEATURES: target.features}
    return {**_native_environment(), **place}


def _drive_all(drives: Sequence[str], environ: Mapping[str, str], workers: int) -> list[tuple[str, str]]:
    """Drive them, so many at a time; return those that could not, and why."""
    with tempfile.TemporaryDirectory() as folder, ThreadPoolExecutor(workers) as pool:
        told = pool.map(lambda drive: _drive(drive, folder, environ), drives)
        return [(drive, why) for drive, why in zip(drives, told, strict=True) if why]


def _drive(drive: str, folder: str, environ: Mapping[str, str]) -> str:
    """Drive once, in a process of its own; return why that failed, empty where it did not."""
    run = f"hydra.run.dir={tempfile.mkdtemp(dir=folder)}"
    words = [sys.executable, "-m", "arena_core", "run", *MOMENT, *drive.split(), run]
    # the words are ours, and names of what is installed
    done = subprocess.run(words, env=environ, cwd=folder, capture_output=True, text=True)  # noqa: S603
    last = (done.stderr or done.stdout).strip().splitlines()[-1:]
    return "" if done.returncode == 0 else (last or [f"status {done.returncode}"])[0]


def _keep_note(target: Target | None, out: str | None) -> str:
    """Note what was compiled where later processes look for it; return what to say of it."""
    if target is not None:
        folder = Path(str(out))
        for lock in folder.glob(f"*/{LOCK}"):
            lock.unlink()
        manifest = write_manifest(folder, target)
        return f"kernels for {manifest.cpu}, {manifest.python}, numba {manifest.numba}: {folder}:"
    if (manifest_here := read_manifest(FOLDER)) is not None:
        note_native(manifest_here, processor_flags(), os.environ)
    return "kernels for this processor:"
