"""A whole recorded DWA episode with AMCL against real time; the memory of a worker; the start of `arena list`."""

from __future__ import annotations

import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

from arena_core.config.configuration import compose, to_plain
from arena_core.config.registry import load_registry
from arena_core.hosting import Benchmark, build_benchmark
from arena_core.loop.record_files import write_record
from arena_core.records import evaluate_record

EPISODES = 5
MEMORY = """
import sys
sys.path.insert(0, sys.argv[1])
import bench_episode
bench_episode.drive("turtlebot3", 2)
status = open("/proc/self/status").read()  # getrusage would tell what the parent used at most, if that is more
print(int(status.split("VmHWM:")[1].split()[0]) / 1024)
"""


def measure() -> list[dict[str, Any]]:
    """Return one row a robot, then memory and start-up."""
    rows = [_episode_row(robot) for robot in ("turtlebot3", "jackal", "robotino")]
    here = str(Path(__file__).parent)
    memory = float(
        subprocess.run([sys.executable, "-c", MEMORY, here], capture_output=True, text=True, check=True).stdout
    )
    rows.append(_make_row("memory of a worker", memory, "MB", 400.0))
    arena = str(Path(sys.executable).parent / "arena")
    rows.append(_make_row("arena list", statistics.median(_wall_time([arena, "list"]) for _ in range(5)), "s", 1.0))
    return rows


def drive(robot: str, episodes: int) -> tuple[float, float]:
    """Run, record and evaluate episodes after a warm-up; return (CPU seconds, simulated seconds)."""
    benchmark = build_benchmark(
        to_plain(compose([f"robot={robot}", "executor=serial", "task.pedestrians=5"])), load_registry()
    )
    with tempfile.TemporaryDirectory() as folder:
        _run_episode(benchmark, 100, Path(folder))
        began = time.process_time()
        simulated = sum(_run_episode(benchmark, episode, Path(folder)) for episode in range(episodes))
        return time.process_time() - began, simulated


def _run_episode(benchmark: Benchmark, episode: int, folder: Path) -> float:
    record = benchmark.run(episode, folder)
    write_record(folder, episode, record)
    evaluate_record(record, benchmark.metrics)
    return float(record["stamp"][-1])


def _episode_row(robot: str) -> dict[str, Any]:
    seconds, simulated = drive(robot, EPISODES)
    return _make_row(
        f"DWA episode, {robot}, per simulated s", 1e3 * seconds / simulated, "ms", 100.0, simulated / seconds
    )


def _make_row(what: str, ours: float, unit: str, goal: float, real_time: float | None = None) -> dict[str, Any]:
    """Return a row without a named peer; ``real_time`` is how many times faster than real time it ran."""
    peer = None if real_time is None else "real time"
    peer_ms = None if real_time is None else 1e3
    return {
        "what": what,
        "ours_ms": ours,
        "ours_unit": unit,
        "peer": peer,
        "peer_ms": peer_ms,
        "ratio": real_time,
        "goal": goal,
    }


def _wall_time(command: list[str]) -> float:
    began = time.perf_counter()
    subprocess.run(command, stdout=subprocess.DEVNULL, check=True)
    return time.perf_counter() - began


if __name__ == "__main__":
    for row in measure():
        print(f"{row['what']:45} {row['ours_ms']:10.3f} {row['ours_unit']:3} ratio {row['ratio']} goal {row['goal']}")
