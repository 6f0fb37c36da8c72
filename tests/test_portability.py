"""What a system without POSIX does: tried here with ARENA_PORTABLE, which takes the same ways."""

import os
import subprocess
import sys
import time

import psutil
import pytest

WORK = """
import os, time
from pathlib import Path

def answer(job):
    if job.episode == 2:
        os._exit(7)
    return {"episode": job.episode, "long": "x" * 200_000}

def hang(job):
    Path(job.folder).write_text(str(os.getpid()))
    time.sleep(3600)
"""
DRIVES = """
from contextlib import closing
from arena_core.hosting import Job, Lost
from arena_core.runs.workers.budgets import Budgets
from arena_core.runs.workers.executors import ProcessExecutor
from working import answer

if __name__ == "__main__":
    jobs = [Job({}, "", episode) for episode in range(4)]
    with closing(ProcessExecutor(2, Budgets(600.0, 600.0, 600.0, 4.0))) as executor:
        answers = list(executor.map(answer, jobs))
    print(sorted(one["episode"] for one in answers if not isinstance(one, Lost)))
    print([(one.job.episode, one.reason) for one in answers if isinstance(one, Lost)])
"""
LEAVES = """
import os, sys, time
from pathlib import Path
from arena_core.hosting import Job
from arena_core.runs.workers.budgets import Budgets, Watch
from arena_core.runs.workers.worker import Task, Worker
from working import hang

if __name__ == "__main__":
    Worker().begin(hang, Task(Job({}, sys.argv[1], 0), 1, Watch(Budgets(600.0, 600.0, 600.0, 4.0))))
    while not Path(sys.argv[1]).exists():
        time.sleep(0.05)
    os._exit(0)
"""
SWITCHED_OFF = """
import sys
import numpy as np
from arena_core.base.frozen import is_sealed, seal_array
from arena_core.base.portability import PORTABLE, most_open_files, process_settings
from arena_kernels.compiled import LOCKS, lock_file

kept = seal_array(np.arange(3.0))
print(PORTABLE, LOCKS, lock_file("."), most_open_files() == sys.maxsize, process_settings())
print(is_sealed(kept), kept.flags.writeable, kept.tolist())
"""


@pytest.fixture
def portably(tmp_path):
    """Return a function that runs a program on the portable ways, and returns its lines."""
    (tmp_path / "working.py").write_text(WORK, encoding="utf-8")
    environment = {**os.environ, "ARENA_PORTABLE": "1", "PYTHONPATH": str(tmp_path)}

    def run(program, *words):
        script = tmp_path / "program.py"
        script.write_text(program, encoding="utf-8")
        command = [sys.executable, str(script), *words]
        done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=600, check=False)
        assert done.returncode == 0, done.stderr
        return done.stdout.splitlines()

    return run


def is_gone(pid):
    """Return whether a process has ended, though no one may have collected it yet."""
    try:
        return psutil.Process(pid).status() == psutil.STATUS_ZOMBIE
    except psutil.NoSuchProcess:
        return True


def test_one_variable_switches_off_what_posix_alone_has(portably):
    assert portably(SWITCHED_OFF) == ["True False None True ()", "False False [0.0, 1.0, 2.0]"]


def test_workers_answer_and_a_dead_one_costs_its_job_alone(portably):
    assert portably(DRIVES) == ["[0, 1, 3]", "[(2, 'worker died: exit status 7')]"]


def test_a_worker_ends_when_its_parent_has_gone(portably, tmp_path):
    portably(LEAVES, str(tmp_path / "pid"))
    pid = int((tmp_path / "pid").read_text(encoding="utf-8"))
    until = time.monotonic() + 600.0
    while not is_gone(pid) and time.monotonic() < until:
        time.sleep(0.05)
    assert is_gone(pid)


@pytest.mark.parametrize("signs", ["ascii", "cp1252"])
def test_signs_that_a_terminal_does_not_know_are_printed_as_question_marks(signs):
    program = "import sys\nfrom arena_core.cli import main\nstatus = main.main(['--version'])\nprint('m/s² ≤ 3')"
    environment = {**os.environ, "PYTHONIOENCODING": signs}
    done = subprocess.run(
        [sys.executable, "-c", program], env=environment, capture_output=True, timeout=600, check=True
    )
    assert done.stdout.decode(signs).splitlines()[1] == {"ascii": "m/s? ? 3", "cp1252": "m/s² ? 3"}[signs]
