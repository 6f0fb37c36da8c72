"""Whole recorded episodes of ten robots in an open hall against real time, and what a robot more costs."""

from __future__ import annotations

import tempfile
import time
from pathlib import Path
from statistics import median
from typing import Any

from arena_core.config.configuration import compose, to_plain
from arena_core.hosting import build_benchmark, load_registry
from arena_core.loop.record_files import write_record
from arena_core.records import evaluate_record

HALL = ("task=antipodal", "world=empty", "pedestrians=none", "localizer=ground_truth", "metrics=[si,team]")
GOALS = {("orca", 10): 20.0, ("teb", 10): 4.0}  # times real time, on one core
TEAMS = (("orca", 2), ("orca", 10), ("orca", 20), ("orca", 50), ("teb", 2), ("teb", 10))
EPISODES = 3


def measure() -> list[dict[str, Any]]:
    """Return one row for each planner and size of a team."""
    return [_speed_row(planner, robots) for planner, robots in TEAMS]


def drive(planner: str, robots: int, episodes: int) -> list[float]:
    """Run, record and evaluate episodes after a warm-up; return how many times faster than real time each was, by the
    CPU time of the process.
    """
    radius = max(4.0, 0.12 * robots)  # m: neighbours stand 0.75 m apart and more
    words = [*HALL, f"planner={planner}", f"task.team={robots}", f"task.radius={radius:g}", "executor=serial"]
    benchmark = build_benchmark(to_plain(compose(words)), load_registry())
    speeds = []
    with tempfile.TemporaryDirectory() as folder:
        for number in range(episodes + 1):
            began = time.process_time()
            records = benchmark.run_all(number * robots, Path(folder))
            for episode, record in records.items():
                write_record(Path(folder), episode, record)
                evaluate_record(record, benchmark.metrics)
            simulated = float(records[number * robots]["team_stamp"][-1])
            speeds.append(simulated / (time.process_time() - began))
    return speeds[1:]


def _speed_row(planner: str, robots: int) -> dict[str, Any]:
    speed = median(drive(planner, robots, EPISODES))
    return {
        "what": f"{robots} robots, {planner}, per simulated s",
        "ours_ms": 1e3 / speed,
        "ours_unit": "ms",
        "peer": "real time",
        "peer_ms": 1e3,
        "ratio": speed,
        "goal": GOALS.get((planner, robots)),
    }


if __name__ == "__main__":
    for planner, robots in TEAMS:
        row = _speed_row(planner, robots)
        print(f"{row['what']:40} {row['ours_ms']:8.1f} ms, {row['ratio']:.1f} times real time", flush=True)
