"""Whatever ends a run, its folder is whole: a row for every record, no half-written file, and resume=true
ends as if nothing had been.
"""

import errno
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import psutil
import pytest

from arena_core.base.errors import RunFolderError
from arena_core.base.folders import KEPT, lock_folder
from arena_core.loop.half_written import keep_room, remove_half_written

pytestmark = pytest.mark.slow
WAY_BEYOND = 60.0  # s: that nothing hangs is what is tested, and the tests' machine may be busy
HUNG = ("executor.budgets.command=null", "executor.budgets.first_command=null")


def start(misbehaving, *words, fault="", moment=""):
    """Start a run in a process of its own, as a terminal would."""
    misbehaving.befall(fault, moment)
    return subprocess.Popen(
        [sys.executable, "-m", "arena_core.cli.main", "run", *misbehaving.words("run"), *words],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
        preexec_fn=lambda: [signal.signal(number, signal.SIG_DFL) for number in (signal.SIGINT, signal.SIGTERM)],
    )


def wait_for(process, records):
    """Wait until so many records are there; return the workers."""
    while not Path("run/records").is_dir() or len(list(Path("run/records").glob("*.npz"))) < records:
        assert process.poll() is None, process.communicate()
        time.sleep(0.02)
    return psutil.Process(process.pid).children()


def is_whole(misbehaving):
    """Return whether the run's folder is as one without an interruption, and nothing else is in it."""
    assert not hidden_files()
    return misbehaving.whole.of("run") == misbehaving.whole


def hidden_files(folder="run"):
    return [path for path in Path(folder).rglob(".*") if path.is_file()]


def table_is_complete(misbehaving):
    kept = misbehaving.whole.of("run")
    return {f"{episode:04d}.npz" for episode, row in kept.rows.items() if row["outcome"] != "error"} == set(
        kept.records
    )


@pytest.mark.parametrize(
    ("number", "said"),
    [
        pytest.param(signal.SIGINT, "interrupted", marks=pytest.mark.long),
        (signal.SIGTERM, "ended by SIGTERM"),
    ],
)
def test_a_signal_ends_a_run_whose_planner_hangs_and_the_table_is_complete(misbehaving, number, said):
    process = start(misbehaving, "executor.workers=2", *HUNG, fault="spin", moment="later step")
    workers = wait_for(process, 9)
    os.killpg(process.pid, number)
    _, errors = process.communicate(timeout=WAY_BEYOND)
    assert process.returncode == 128 + number
    assert errors.splitlines(keepends=True)[-1] == f"arena: {said}; {KEPT}\n"
    assert not psutil.wait_procs(workers, timeout=WAY_BEYOND)[1]
    assert len(misbehaving.whole.of("run").records) == 9
    assert table_is_complete(misbehaving)
    assert not hidden_files()
    assert misbehaving.run_alone("run", "resume=true").status == 0
    assert is_whole(misbehaving)


def test_a_second_signal_ends_a_run_at_once(misbehaving):
    process = start(misbehaving, "executor.workers=1", *HUNG, fault="handlers", moment="later step")
    wait_for(process, 2)
    for _ in range(3):
        os.kill(process.pid, signal.SIGINT)
    process.communicate(timeout=WAY_BEYOND)
    assert process.returncode == 130
    assert misbehaving.run_alone("run", "resume=true").status == 0
    assert is_whole(misbehaving)


def test_a_killed_run_leaves_no_worker_and_is_continued(misbehaving):
    process = start(misbehaving, "executor.workers=2")
    workers = wait_for(process, 3)
    process.kill()
    process.communicate()
    assert not psutil.wait_procs(workers, timeout=WAY_BEYOND)[1]
    Path("run/records/.0007.npz.0123abcd").write_bytes(b"half")
    assert misbehaving.run_alone("run", "resume=true").status == 0
    assert is_whole(misbehaving)


def test_a_killed_worker_costs_nothing(misbehaving):
    process = start(misbehaving, "executor.workers=2")
    worker = next(child for child in wait_for(process, 2) if "spawn_main" in " ".join(child.cmdline()))
    worker.kill()
    _, errors = process.communicate(timeout=WAY_BEYOND)
    assert (process.returncode, errors) == (0, "")
    assert is_whole(misbehaving)


def test_of_two_runs_that_start_in_one_folder_one_is_refused_in_one_line(misbehaving):
    both = [start(misbehaving, "resume=true") for _ in range(2)]
    said = {process.wait(WAY_BEYOND): process.communicate()[1] for process in both}
    assert set(said) == {0, 2}
    assert said[0] == ""
    assert said[2].startswith("arena: ")
    assert said[2].count("\n") == 1
    assert "another run is under way there; allowed: its end, or another folder, out=DIR" in said[2]
    assert is_whole(misbehaving)


def test_a_disk_that_is_full_ends_a_run_that_can_be_continued(misbehaving):
    Path("run").mkdir()
    mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=200k", "tmpfs", "run"], capture_output=True)
    if mounted.returncode:
        pytest.skip("no one but root mounts a small disk")
    try:
        answer = misbehaving.run("run", "executor.workers=2")
        assert answer.status == 1
        assert answer.line.endswith("No space left on device; " + KEPT)
        assert 0 < len(misbehaving.whole.of("run").records) < 10
        assert table_is_complete(misbehaving)
        assert not hidden_files()
        subprocess.run(["mount", "-o", "remount,size=10m", "run"], check=True)
        assert misbehaving.run_alone("run", "resume=true").status == 0
        assert is_whole(misbehaving)
    finally:
        subprocess.run(["umount", "run"], check=True)


def test_room_that_is_kept_for_a_table_is_given_back(tmp_path):
    keep_room(tmp_path, 5000)
    assert [path.stat().st_size for path in tmp_path.iterdir()] == [5000]
    remove_half_written(tmp_path)
    assert not list(tmp_path.iterdir())
    keep_room(tmp_path / "missing", 5000)  # where none can be kept, none is


def test_a_refused_multirun_leaves_nothing_behind_and_changes_nothing(misbehaving):
    sweep = ("-m", "hydra.sweep.dir=sweep")
    wrong = misbehaving.run_alone("unused", *sweep, "timing.latency=0.0,-1.0")
    assert (wrong.status, wrong.line) == (2, "arena: timing.latency is -1.0; allowed: >= 0")
    assert not Path("sweep").exists()
    assert misbehaving.run_alone("unused", *sweep, "timing.latency=0.0,0.1", "episodes=1").status == 0
    before = {path: path.read_bytes() for path in Path("sweep").rglob("*") if path.is_file()}
    again = misbehaving.run_alone("unused", *sweep, "timing.latency=0.0,0.1,0.2", "episodes=1")
    assert again.status == 2
    assert "holds a run already" in again.line
    assert {path: path.read_bytes() for path in Path("sweep").rglob("*") if path.is_file()} == before
    assert not Path("sweep/2").exists()


def test_a_refused_run_leaves_folders_as_they_were(misbehaving):
    Path("mine").mkdir()
    assert misbehaving.run("mine", "timing.latency=-1").status == 2
    assert list(Path("mine").iterdir()) == []
    assert misbehaving.run("mine/new/run", "timing.latency=-1").status == 2
    assert list(Path("mine").iterdir()) == []


def test_two_runs_of_a_sweep_cannot_share_a_folder(misbehaving):
    answer = misbehaving.run(
        "unused", "-m", "hydra.sweep.dir=sweep", "hydra.sweep.subdir=one", "timing.latency=0.0,0.1"
    )
    assert answer.status == 2
    assert "sweep/one; allowed: a hydra.sweep.subdir for each" in answer.line
    assert not Path("sweep").exists()


def test_a_locked_folder_is_free_again_afterwards(tmp_path):
    with lock_folder(tmp_path / "new"):
        with pytest.raises(RunFolderError, match="another run is under way there"), lock_folder(tmp_path / "new"):
            pass
        assert (tmp_path / "new" / ".lock").exists()
    assert not (tmp_path / "new").exists()
    with lock_folder(tmp_path):
        pass
    assert list(tmp_path.iterdir()) == []


def test_half_written_files_alone_are_removed(tmp_path):
    (tmp_path / "records").mkdir()
    stay = [".lock", ".hidden", "records/0001.npz", "records/.0001.npz.0123abcg"]
    for name in (*stay, ".episodes.csv.0123abcd", "records/.0001.npz.0123abcd"):
        (tmp_path / name).write_text("")
    remove_half_written(tmp_path)
    assert sorted(str(path.relative_to(tmp_path)) for path in tmp_path.rglob("*") if path.is_file()) == sorted(stay)


def test_a_folder_that_cannot_be_locked_is_named(tmp_path):
    (tmp_path / "file").write_text("")
    with (
        pytest.raises(RunFolderError, match=r"cannot use the run's folder .*file/run: " + os.strerror(errno.ENOTDIR)),
        lock_folder(tmp_path / "file/run"),
    ):
        pass
