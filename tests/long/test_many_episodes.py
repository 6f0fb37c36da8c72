"""Ten thousand short episodes in one worker: its memory stays as it is."""

import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import psutil
import pytest

pytestmark = pytest.mark.long
EPISODES = 10_000
MEGABYTE = 1e6
MAY_GROW = 10.0  # MB between the second and the last quarter


def worker_of(process):
    return next(
        (child for child in psutil.Process(process.pid).children() if "spawn_main" in " ".join(child.cmdline())), None
    )


def sampled(process, records):
    """Return (episodes done, MB of the worker, MB of the main process), every two seconds until the process ends."""
    samples = []
    while process.poll() is None:
        time.sleep(2.0)
        try:
            worker = worker_of(process)
            done = sum(1 for _ in records.rglob("[0-9]*.npz"))  # a folder for every thousand
            if worker is not None and done:
                rss = [one.memory_info().rss / MEGABYTE for one in (worker, psutil.Process(process.pid))]
                samples.append((done, *rss))
        except psutil.Error:  # the last one has just gone
            pass
    return np.array(samples)


def test_the_memory_of_a_worker_is_flat_over_ten_thousand_episodes(tmp_path, capsys):
    words = (
        "planner=dwa",
        "robot=jackal",
        "world=warehouse",
        "task.pedestrians=3",
        "task.time_limit=0.5",
        "report=false",
    )
    words += (
        "localizer=ground_truth",
        f"episodes={EPISODES}",
        "executor.workers=1",
        f"hydra.run.dir={tmp_path / 'run'}",
    )
    process = subprocess.Popen([sys.executable, "-m", "arena_core.cli.main", "run", *words], cwd=tmp_path)
    samples = sampled(process, Path(tmp_path, "run", "records"))
    assert process.returncode == 0
    quarters = [
        samples[(samples[:, 0] > k * EPISODES / 4) & (samples[:, 0] <= (k + 1) * EPISODES / 4)].mean(axis=0)
        for k in range(4)
    ]
    with capsys.disabled():
        for done, worker, main in quarters:
            print(f"\nabout {done:.0f} episodes: worker {worker:.1f} MB, main process {main:.1f} MB", end="")
    assert quarters[3][1] - quarters[1][1] < MAY_GROW
