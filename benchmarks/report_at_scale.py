"""Time `arena report` over many episodes: rows of the paper's experiment, drawn again with other numbers, without
records.

    python benchmarks/report_at_scale.py [EPISODES]

Prints wall and CPU time and the most memory of the command, which runs in a process of its own.
"""

from __future__ import annotations

import csv
import gzip
import json
import os
import sys
import time
from collections import defaultdict
from pathlib import Path
from subprocess import Popen
from tempfile import TemporaryDirectory

import numpy as np

from arena_core.hosting import compose, to_plain
from arena_core.records import EPISODE_COLUMNS

HERE = Path(__file__).resolve().parent
ROWS = HERE.parent / "docs" / "results" / "paper" / "episodes.csv.gz"
SPREAD = 0.05  # of a figure that is not a count, as a share of it


def write_runs(folder: Path, episodes: int) -> None:
    """Write a run for each cell of the paper's experiment, about ``episodes`` in all."""
    with gzip.open(ROWS, "rt", newline="") as file:
        rows = list(csv.DictReader(file))
    cells = defaultdict(list)
    for row in rows:
        cells[row["config_hash"]].append(row)
    metrics, random = to_plain(compose([]))["metrics"], np.random.default_rng(0)
    for number, cell in enumerate(cells.values()):
        _write_run(folder / str(number), cell, round(episodes / len(cells)), metrics, random)


def _write_run(
    folder: Path, cell: list[dict[str, str]], episodes: int, metrics: dict, random: np.random.Generator
) -> None:
    folder.mkdir(parents=True)
    first = cell[0]
    parts = {name: {"name": first[name]} for name in ("planner", "robot", "world", "simulator", "task")}
    config = {**parts, "metrics": metrics, "seed": 0, "episodes": episodes}
    facts = {
        "config_hash": first["config_hash"],
        "seed": 0,
        "episodes": episodes,
        "config": config,
        "versions": {},
        "code": {},
    }
    (folder / "provenance.json").write_text(json.dumps(facts))
    with (folder / "episodes.csv").open("w", newline="") as file:
        writer = csv.DictWriter(file, list(first), lineterminator="\n")
        writer.writeheader()
        for episode in range(episodes):
            row = cell[episode % len(cell)]
            writer.writerow(
                {
                    **{key: _vary_value(key, value, random) for key, value in row.items()},
                    "episode": episode,
                    "scenario": f"random/{episode:06d}",
                }
            )


def _vary_value(key: str, value: str, random: np.random.Generator) -> str:
    if key in EPISODE_COLUMNS or not value or float(value).is_integer():
        return value
    return repr(float(value) * (1.0 + SPREAD * random.standard_normal()))


def main() -> None:
    """Write the runs, report on them, and print what it took."""
    episodes = int(sys.argv[1]) if len(sys.argv) > 1 else 100_000
    with TemporaryDirectory() as name:
        write_runs(Path(name), episodes)
        began = time.perf_counter()
        _, status, used = os.wait4(Popen([str(Path(sys.executable).with_name("arena")), "report", name]).pid, 0)
        wall = time.perf_counter() - began
    cpu = used.ru_utime + used.ru_stime
    took, said = f"{wall:.1f} s, {cpu:.1f} s of CPU", os.waitstatus_to_exitcode(status)
    print(f"{episodes} episodes: {took}, {used.ru_maxrss / 1e6:.2f} GB at the most, exit status {said}")


if __name__ == "__main__":
    main()
