"""Ray gives the records that processes give, also when a machine is lost in the middle."""

import csv
import os
import subprocess
import sys
from contextlib import closing
from pathlib import Path

import pytest

from arena_core import ConfigurationError
from arena_core import run as run_benchmark
from arena_core.hosting import Job, Lost, RunStopped, compose, load_registry, to_plain
from arena_core.testing import check, robot
from arena_core.testing.checks import echo_job

pytestmark = [
    pytest.mark.slow,
    pytest.mark.filterwarnings("ignore::ResourceWarning"),  # Ray's own, of its logs and pipes
    pytest.mark.filterwarnings("ignore::FutureWarning"),
    pytest.mark.filterwarnings("ignore::DeprecationWarning"),
    pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning"),
]
ROOM = (
    "planner=pure_pursuit",
    "robot=jackal",
    "world=empty",
    "world.width=7",
    "world.height=7",
    "task.pedestrians=2",
    "report=false",
)


def executor(**values):
    config = to_plain(compose(["executor=ray"]))["executor"]
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


def test_a_ray_of_its_own_keeps_the_contract_of_an_executor_and_gives_the_records_of_processes(by_processes, tmp_path):
    assert check("executor", executor(workers=1), robot())
    run_benchmark([*ROOM, "episodes=60", "executor=ray", "executor.workers=2"], tmp_path / "run")
    assert kept(tmp_path / "run") == by_processes
    assert len(list((tmp_path / "run" / "timing").iterdir())) == 60


KILLED = """
import sys, threading, time
from pathlib import Path
from ray.cluster_utils import Cluster
from arena_core import run

folder, *words = sys.argv[1:]

def kill():
    while len(list(Path(folder, "records").glob("[0-9]*.npz"))) < 6:
        time.sleep(0.05)
    cluster.remove_node(nodes[0], allow_graceful=False)

cluster = Cluster(initialize_head=True, head_node_args={"num_cpus": 0, "include_dashboard": False})
try:
    nodes = [cluster.add_node(num_cpus=1) for _ in range(2)]
    threading.Thread(target=kill, daemon=True).start()
    run([*words, f"executor.address={cluster.address}"], folder)
finally:
    cluster.shutdown()
"""


def test_a_machine_that_is_killed_in_the_middle_costs_nothing_but_time(by_processes, tmp_path):
    """In a process of its own: three machines, each a set of processes, one of which has no CPU and one is killed."""
    words = [sys.executable, "-c", KILLED, str(tmp_path / "run"), *ROOM, "episodes=60", "executor=ray"]
    apart = {**os.environ, "RAY_ENABLE_WINDOWS_OR_OSX_CLUSTER": "0", "RAY_AUTH_MODE": "disabled"}
    done = subprocess.run(words, env=apart, capture_output=True, text=True, timeout=1800)
    assert done.returncode == 0, done.stderr[-2000:]
    assert kept(tmp_path / "run") == by_processes
    assert " is lost: " in done.stderr


def test_a_machine_with_other_code_is_left_out_and_nothing_runs_without_any(tmp_path, capfd):
    jobs = [Job({"code": "00000000", "planner": {"name": "pure_pursuit"}}, str(tmp_path), 0)]
    with (
        closing(executor(workers=1)) as ray,
        pytest.raises(RunStopped, match=r"no machine of Ray is left .*has other code"),
    ):
        list(ray.map(echo_job, jobs))
    assert "is left out: " in capfd.readouterr().err


def test_a_worker_that_dies_costs_its_job_alone(third_party_work, tmp_path):
    with closing(executor(workers=1)) as ray:
        answers = list(ray.map(third_party_work.bad, [Job({}, "", k) for k in range(4)]))
    lost = [one for one in answers if isinstance(one, Lost)]
    assert [(one.job.episode, one.reason) for one in lost] == [(2, "worker died: exit status 3")]
    assert sorted(one["episode"] for one in answers if not isinstance(one, Lost)) == [0, 1, 3]


@pytest.fixture
def third_party_work(tmp_path, monkeypatch):
    (tmp_path / "site").mkdir()
    (tmp_path / "site" / "ray_work.py").write_text(
        "import os\n\ndef bad(job):\n    if job.episode == 2:\n        os._exit(3)\n    return {'episode': "
        "job.episode}\n"
    )
    monkeypatch.syspath_prepend(str(tmp_path / "site"))
    monkeypatch.setenv("PYTHONPATH", str(tmp_path / "site"))
    import ray_work

    return ray_work


def test_an_address_where_no_ray_is_is_one_line(tmp_path):
    with (
        closing(executor(address="127.0.0.1:1")) as ray,
        pytest.raises(ConfigurationError, match=r"executor\.address is 127\.0\.0\.1:1"),
    ):
        list(ray.map(echo_job, [Job({}, "", 0)]))
