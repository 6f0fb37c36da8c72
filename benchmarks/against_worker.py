"""Runs units of work for ``against.py``, in whatever checkout's interpreter it is started: it uses what has long been
public.

A line of JSON a unit comes in, a line with what it took goes out: CPU seconds of all and of the planner, and the number
of control steps.
"""

from __future__ import annotations

import contextlib
import json
import resource
import subprocess
import sys
import tempfile
from functools import lru_cache
from pathlib import Path
from typing import Any

BIN = Path(sys.executable).parent


@lru_cache(maxsize=2)
def benchmark_of(overrides: tuple[str, ...]) -> Any:
    """Return the benchmark of a configuration, after two episodes that compile and fill caches."""
    from arena_core.config.configuration import compose, to_plain
    from arena_core.hosting import build_benchmark, load_registry

    built = build_benchmark(to_plain(compose([*overrides, "executor=serial"])), load_registry())
    for episode in (1000, 1001):
        drive_episode(built, episode)
    return built


def drive_episode(benchmark: Any, episode: int) -> dict[str, float]:
    """Run, write and evaluate an episode; return CPU seconds of all, and of the planner alone,
    and how many control steps it had.
    """
    from arena_core.loop.record_files import write_record
    from arena_core.records import evaluate_record

    with tempfile.TemporaryDirectory() as folder:
        began = own_seconds()
        record = benchmark.run(episode, Path(folder))
        write_record(Path(folder), episode, record)
        evaluate_record(record, benchmark.metrics)
        took = own_seconds() - began
    return {
        "seconds": took,
        "planner": float(record.timing["planner_cpu_seconds"].sum()),
        "count": len(record["stamp"]) - 1,
    }


def run_command(words: list[str]) -> dict[str, float]:
    """Run a command of this checkout in a folder of its own; return the CPU seconds of it and of its children."""
    with tempfile.TemporaryDirectory() as folder:
        began = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run(
            [BIN / words[0], *words[1:]], cwd=folder, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
        )
        ended = resource.getrusage(resource.RUSAGE_CHILDREN)
    return {"seconds": ended.ru_utime + ended.ru_stime - began.ru_utime - began.ru_stime, "planner": 0.0, "count": 1}


def own_seconds() -> float:
    """Return the CPU seconds of this process so far."""
    used = resource.getrusage(resource.RUSAGE_SELF)
    return used.ru_utime + used.ru_stime


def main() -> None:
    """Answer until nothing more is asked."""
    answers = sys.stdout
    with contextlib.redirect_stdout(sys.stderr):
        for line in sys.stdin:
            unit = json.loads(line)
            episode = unit["work"] == "episode"
            found = (
                drive_episode(benchmark_of(tuple(unit["overrides"])), unit["episode"])
                if episode
                else run_command(unit["words"])
            )
            print(json.dumps(found), file=answers, flush=True)


if __name__ == "__main__":
    main()
