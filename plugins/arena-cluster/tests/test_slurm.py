"""Jobs of submitit give the records that processes give, also when one is killed in the middle.

No Slurm is here: cluster=local.
"""

import csv
import json
import os
import signal
import subprocess
import sys
import threading
import time
from contextlib import closing
from dataclasses import replace
from pathlib import Path

import psutil
import pytest

from arena_core import ConfigurationError, InputFileError
from arena_core import run as run_benchmark
from arena_core.files import write_text_whole
from arena_core.hosting import Budgets, Finished, Job, Lost, RunFolderError, compose, load_registry, to_plain
from arena_core.testing import check, robot
from arena_core.testing.checks import echo_job
from arena_slurm.share import Share, _answer_identity, _encode_answer, _read_answer, new_answers, starts_of

ROOM = (
    "planner=pure_pursuit",
    "robot=jackal",
    "world=empty",
    "world.width=7",
    "world.height=7",
    "task.pedestrians=2",
    "report=false",
)
LOCAL = ("executor=slurm", "executor.cluster=local", "executor.workers=1", "executor.jobs=2")
WORK = """
import os
import time
from arena_core.hosting import RunFolderError

def bad(job):
    if job.episode == 2:
        os._exit(3)
    return {"episode": job.episode}

def full(job):
    raise RunFolderError("cannot write it: No space left on device")
"""


def executor(**values):
    config = to_plain(compose(["executor=slurm", "executor.cluster=local", "executor.workers=1", "executor.jobs=2"]))[
        "executor"
    ]
    return load_registry().build("executor", {**config, **values})


def kept(folder):
    """Return a run's records by name, and its rows without wall times."""
    with Path(folder, "episodes.csv").open(newline="") as file:
        rows = [{k: v for k, v in row.items() if not k.startswith("planning_")} for row in csv.DictReader(file)]
    files = [path for part in ("records", "worlds") for path in sorted(Path(folder, part).iterdir())]
    return rows, {f"{path.parent.name}/{path.name}": path.read_bytes() for path in files}


@pytest.fixture(scope="module")
def by_processes(tmp_path_factory):
    folder = tmp_path_factory.mktemp("processes") / "run"
    run_benchmark([*ROOM, "episodes=60", "executor.workers=1"], folder)
    return kept(folder)


@pytest.fixture
def slurm_work(tmp_path, monkeypatch):
    (tmp_path / "site").mkdir()
    (tmp_path / "site" / "slurm_work.py").write_text(WORK)
    monkeypatch.syspath_prepend(str(tmp_path / "site"))
    monkeypatch.setenv("PYTHONPATH", str(tmp_path / "site"))
    import slurm_work

    return slurm_work


@pytest.mark.slow
def test_it_keeps_the_contract_of_an_executor(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert check("executor", executor(), robot())
    assert list(tmp_path.iterdir()) == []


@pytest.mark.slow
def test_a_job_that_is_killed_in_the_middle_costs_nothing_but_time(by_processes, tmp_path, capfd):
    """Two jobs of 30 episodes; one is killed as a site does that preempts it."""
    records = tmp_path / "run" / "records"

    def kill():
        until = time.monotonic() + 600.0
        while len(list(records.glob("[0-9]*.npz"))) < 6 and time.monotonic() < until:
            time.sleep(0.02)
        ours = [child for child in psutil.Process().children(recursive=True) if "submitit" in " ".join(child.cmdline())]
        os.kill(max(ours, key=lambda child: child.create_time()).pid, signal.SIGKILL)

    thread = threading.Thread(target=kill, daemon=True)
    thread.start()
    run_benchmark([*ROOM, *LOCAL, "episodes=60"], tmp_path / "run")
    thread.join()
    assert kept(tmp_path / "run") == by_processes
    assert "its episodes are begun again" in capfd.readouterr().err


@pytest.mark.slow
def test_what_nobody_disturbs_leaves_nothing_of_submitit(by_processes, tmp_path):
    run_benchmark([*ROOM, *LOCAL, "executor.jobs=1", "episodes=60"], tmp_path / "run")
    assert kept(tmp_path / "run") == by_processes
    assert not (tmp_path / "run" / "slurm").exists()


@pytest.mark.slow
def test_a_worker_that_dies_costs_its_episode_alone(slurm_work, tmp_path):
    with closing(executor()) as slurm:
        answers = list(slurm.map(slurm_work.bad, [Job({}, str(tmp_path / "run"), k) for k in range(4)]))
    assert [(one.job.episode, one.reason) for one in answers if isinstance(one, Lost)] == [
        (2, "worker died: exit status 3")
    ]


@pytest.mark.slow
def test_what_the_work_raises_is_raised_here(slurm_work, tmp_path):
    with closing(executor()) as slurm, pytest.raises(RunFolderError, match="cannot write it: No space left on device"):
        list(slurm.map(slurm_work.full, [Job({}, str(tmp_path / "run"), 0)]))


@pytest.mark.slow
def test_a_job_with_other_code_says_so(tmp_path):
    jobs = [Job({"code": "00000000", "planner": {"name": "pure_pursuit"}}, str(tmp_path), 0)]
    with closing(executor(attempts=1)) as slurm:
        (lost,) = slurm.map(echo_job, jobs)
    assert "has other code, " in lost.reason
    assert "in place of 00000000" in lost.reason


def test_where_no_slurm_is_the_request_is_refused(tmp_path, monkeypatch):
    monkeypatch.setenv("PATH", str(tmp_path))
    with (
        closing(executor(cluster="slurm")) as slurm,
        pytest.raises(ConfigurationError, match=r"executor\.cluster is slurm, and it"),
    ):
        list(slurm.map(echo_job, [Job({}, str(tmp_path / "run"), 0)]))


@pytest.mark.parametrize(
    ("values", "fault"),
    [
        ({"options": {"account": "lab"}}, r"executor\.options has account; allowed: keys that begin with slurm_"),
        ({"cluster": "pbs"}, r"executor\.cluster is 'pbs'; allowed: "),
        ({"jobs": 0}, r"executor\.jobs is 0; allowed: "),
    ],
)
def test_an_impossible_value_is_named(values, fault):
    with pytest.raises(ConfigurationError, match=fault):
        executor(**values)


KILLED = """
import sys
from arena_core import run

if __name__ == "__main__":
    run(sys.argv[2:], sys.argv[1])
"""


@pytest.mark.slow
@pytest.mark.parametrize("resumed_by", [pytest.param("slurm", marks=pytest.mark.long), "processes"])
def test_a_run_whose_parent_was_killed_is_resumed_without_the_answers_of_its_first_start(
    by_processes, tmp_path, resumed_by
):
    words, folder = [*ROOM, *LOCAL, "executor.share=10", "episodes=60"], tmp_path / "run"
    (tmp_path / "start.py").write_text(KILLED)
    first = subprocess.Popen([sys.executable, str(tmp_path / "start.py"), str(folder), *words])
    until = time.monotonic() + 600.0
    while len(list(folder.glob("slurm/*/answers-*/*.json"))) < 8 and time.monotonic() < until:
        time.sleep(0.02)
    first.kill()
    first.wait()
    own = words if resumed_by == "slurm" else [*ROOM, "episodes=60", "executor.workers=1"]
    run_benchmark([*own, "resume=true"], folder)
    assert kept(folder) == by_processes


def test_answer_of_a_team_is_read_back_for_each_of_its_robots(tmp_path):
    job = Job({"code": "a"}, str(tmp_path), 4, None, 2)
    share = Share(echo_job, [job], 1, Budgets(None, None, None, None), str(tmp_path / "answers"), {})
    mate = Finished(replace(job, episode=5), {"episode": 5}, False)
    told = {**_answer_identity(share, job), **_encode_answer(Finished(job, {"episode": 4}, True, (mate,)))}
    write_text_whole(tmp_path / "answers" / "000000.json", json.dumps(told))
    answer = _read_answer(tmp_path / "answers" / "000000.json", share, job)
    assert [(one.job.episode, one.row, one.succeeded) for one in (answer, *answer.team)] == [
        (4, {"episode": 4}, True),
        (5, {"episode": 5}, False),
    ]


def test_answers_of_another_start_run_or_job_are_refused(tmp_path):
    own, other = Job({"code": "a"}, str(tmp_path), 0), Job({"code": "a"}, str(tmp_path), 1)
    share = Share(echo_job, [own], 1, Budgets(None, None, None, None), str(tmp_path / "answers"), {})
    for name, sender, job in (
        ("job", share, other),
        ("start", replace(share, answers="before"), own),
        ("run", share, replace(own, folder="elsewhere")),
        ("code", share, replace(own, config={"code": "b"})),
    ):
        write_text_whole(
            tmp_path / "answers" / "000000.json", json.dumps({**_answer_identity(sender, job), "value": name})
        )
        with pytest.raises(InputFileError, match="it answers another job"):
            list(new_answers(share, set()))
    write_text_whole(tmp_path / "answers" / "000000.json", json.dumps({**_answer_identity(share, own), "value": 5}))
    assert list(new_answers(share, set())) == [(own, 5)]


def test_a_share_ends_without_a_word_once_another_start_has_taken_the_run_over(tmp_path):
    (tmp_path / "answers").mkdir()
    share = Share(
        echo_job,
        [Job({}, str(tmp_path), 0)],
        1,
        Budgets(None, None, None, None),
        str(tmp_path / "answers"),
        starts_of([str(tmp_path)]),
    )
    write_text_whole(tmp_path / "provenance.json", "{}")
    share()
    assert not list((tmp_path / "answers").iterdir())
