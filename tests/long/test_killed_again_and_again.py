"""One sweep, killed a hundred times as a whole and fifty times at one of its workers: resumed,
it ends with the same bytes.
"""

import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import psutil
import pytest

pytestmark = pytest.mark.long
KILLED_WHOLE, KILLED_WORKERS, EPISODES = 100, 50, 150
SWEEP = (
    *(
        "-m",
        "planner=dwa,pure_pursuit",
        "robot=jackal",
        "world=warehouse",
        "task.pedestrians=2",
        "task.time_limit=3",
        "report=false",
    ),
    *("localizer=ground_truth", f"episodes={EPISODES}", "executor.workers=2"),
)


def start(folder, log):
    words = [sys.executable, "-m", "arena_core.cli.main", "run", *SWEEP, f"hydra.sweep.dir={folder}", "resume=true"]
    return subprocess.Popen(words, start_new_session=True, stderr=log, stdout=log)


def records(folder):
    return {str(path.relative_to(folder)): path.read_bytes() for path in Path(folder).rglob("records/*")}


def workers_of(process):
    try:
        return [child for child in psutil.Process(process.pid).children() if "spawn_main" in " ".join(child.cmdline())]
    except psutil.Error:
        return []


def kill_worker(process, chance):
    workers = workers_of(process)
    if not workers:
        return False
    try:
        chance.choice(workers).kill()
    except psutil.Error:
        return False
    return True


@pytest.fixture
def log(tmp_path):
    with (tmp_path / "log").open("w") as file:
        yield file


def test_a_sweep_killed_again_and_again_ends_with_the_same_bytes(tmp_path, log, capsys):
    chance = random.Random(0)
    assert start(tmp_path / "whole", log).wait() == 0
    whole, groups, single, under_way, begun = records(tmp_path / "whole"), 0, 0, 0, time.monotonic()
    while groups < KILLED_WHOLE or single < KILLED_WORKERS:
        process = start(tmp_path / "part", log)
        wait_a_while(process, chance, tmp_path / "part")
        for _ in range(groups % 2):
            single += kill_worker(process, chance)
            time.sleep(chance.uniform(0.0, 3.0))
        under_way += len(left := workers_of(process)) > 0 and count_records(tmp_path / "part") > 0
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGKILL)
        process.wait()
        groups += 1
        assert not psutil.wait_procs(left, timeout=30.0)[1]
        forget_some(tmp_path / "part", chance, groups)
    assert start(tmp_path / "part", log).wait() == 0
    with capsys.disabled():
        print(
            f"\n{groups} kills of the group ({under_way} among records), {single} of workers "
            f"in {time.monotonic() - begun:.0f} s, "
            f"{len(whole)} records"
        )
    assert records(tmp_path / "part") == whole
    assert not [path for path in (tmp_path / "part").rglob(".*") if path.is_file()]
    for job in ("0", "1"):
        assert table(tmp_path / "part" / job) == table(tmp_path / "whole" / job)


def wait_a_while(process, chance, folder):
    """Wait until some while after the first worker is there, every other time for a record first: on a machine that is
    busy workers take long to get going. One time in five, do not even wait for a worker.
    """
    time.sleep(chance.uniform(0.0, 2.0))
    if chance.random() < 0.2:
        return
    before = count_records(folder) if chance.random() < 0.5 else -1
    while process.poll() is None and (not workers_of(process) or count_records(folder) <= before):
        time.sleep(0.05)
    time.sleep(chance.uniform(0.0, 6.0 if before < 0 else 1.0))


def count_records(folder):
    return sum(1 for _ in folder.glob("*/records/*.npz"))


def forget_some(folder, chance, groups):
    """Once a run is nearly through, take records away again, so that every kill finds work under way."""
    found = sorted(folder.rglob("records/[0-9]*.npz"))
    if len(found) > EPISODES and groups < KILLED_WHOLE:
        for path in chance.sample(found, len(found) // 2):
            path.unlink()


def table(folder):
    lines = (folder / "episodes.csv").read_text().splitlines()
    header = lines[0].split(",")
    kept = [k for k, name in enumerate(header) if not name.startswith("planning_")]
    return [[line.split(",")[k] for k in kept] for line in lines]
