"""A planner's fault costs its episode and no other: a share of what
tests/long/test_every_fault.py tries at every moment.
"""

import re
from pathlib import Path

import psutil
import pytest

FAULTY = 4


def row_of(misbehaving, folder, answer, workers):
    """Return the row of the episode that the fault befell, after all others were found as they are without it."""
    kept = misbehaving.whole.of(folder)
    others = {k: row for k, row in kept.rows.items() if k != FAULTY}
    assert others == {k: row for k, row in misbehaving.whole.rows.items() if k != FAULTY}
    name = f"{FAULTY:04d}.npz"
    assert {k: v for k, v in kept.records.items() if k != name} == {
        k: v for k, v in misbehaving.whole.records.items() if k != name
    }
    row = kept.rows[FAULTY]
    assert answer.status == int(row["outcome"] == "error")
    assert not [path for path in Path(folder).rglob(".*") if path.is_file()]
    return row


@pytest.mark.slow
@pytest.mark.parametrize(
    ("fault", "moment", "workers", "error"),
    [
        ("segfault", "reset", 2, "worker died: SIGSEGV"),
        ("sleep", "later step", 1, "no command within 20 s"),
        ("memory", "first step", 2, "more than 1 GB"),
        ("surrogate", "later step", 2, r"RuntimeError: \ud800 \x00 \x1b[31m"),
    ],
)
def test_a_fault_costs_its_episode_alone(misbehaving, fault, moment, workers, error):
    answer = misbehaving.run("faulty", f"executor.workers={workers}", fault=fault, moment=moment)
    assert answer.line == f"episode {FAULTY} failed: {error}"
    row = row_of(misbehaving, "faulty", answer, workers)
    assert (row["outcome"], row["error"]) == ("error", error)


@pytest.mark.slow
@pytest.mark.parametrize("fault", ["chdir", "few descriptors", "stack", "seterr", "half a message"])
def test_what_an_episode_does_to_its_process_does_not_reach_the_next(misbehaving, fault):
    answer = misbehaving.run("moved", "executor.workers=1", fault=fault, moment="reset")
    assert row_of(misbehaving, "moved", answer, 1) == misbehaving.whole.rows[FAULTY]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("fault", "moment", "error"),
    [
        ("descriptors", "first step", "RunFolderError: cannot write .*0004.npz: Too many open files"),
        ("RunFolderError", "reset", "RunFolderError: cannot write it: No space left on device"),
        ("elsewhere", "later step", "RunFolderError: cannot write /proc/nowhere/a.txt: No such file or directory"),
        ("file size", "first step", "RunFolderError: cannot write .*0004.npz: File too large"),
        ("few files", "reset", "RunFolderError: cannot write .*0004.npz: Too many open files"),
        ("umask", "reset", ""),
        ("np.array", "later step", ".*"),
        ("np.hypot", "later step", ""),
        ("map", "reset", "worker died: SIG(SEGV|BUS)"),
    ],
)
def test_a_process_or_map_that_an_episode_has_spoilt_costs_that_episode_alone(misbehaving, fault, moment, error):
    answer = misbehaving.run("spoilt", "executor.workers=1", fault=fault, moment=moment)
    row = row_of(misbehaving, "spoilt", answer, 1)
    assert re.fullmatch(error, row["error"])


@pytest.mark.slow
def test_processes_that_left_their_session_end_with_the_worker(misbehaving, monkeypatch, tmp_path):
    monkeypatch.setenv("PIDS", str(tmp_path / "pids"))
    answer = misbehaving.run("off", "executor.workers=1", fault="sessions", moment="reset")
    assert row_of(misbehaving, "off", answer, 1) == misbehaving.whole.rows[FAULTY]
    pids = [int(pid) for pid in (tmp_path / "pids").read_text().split()]
    assert len(pids) == 3
    assert not [pid for pid in pids if psutil.pid_exists(pid) and psutil.Process(pid).status() != psutil.STATUS_ZOMBIE]


@pytest.mark.slow
@pytest.mark.parametrize("executor", ["serial", "processes"])
def test_a_run_whose_folder_is_moved_away_ends_with_one_line(misbehaving, monkeypatch, executor):
    monkeypatch.setenv("MOVED", "run")
    own = ["executor=serial"] if executor == "serial" else ["executor.workers=1"]
    misbehaving.befall("move", "later step")
    words = [
        word for word in misbehaving.words("run") if executor == "processes" or not word.startswith("executor.budgets")
    ]
    answer = misbehaving.arena("run", *words, *own)
    assert answer.status == 1
    assert "/run was moved, removed or replaced while its run was under way" in answer.line.replace(
        "moved or removed", "moved, removed or replaced"
    )
    assert not Path("run").exists()
    assert len(list(Path("run.away/records").iterdir())) == FAULTY


@pytest.mark.slow
def test_a_fault_while_the_planner_is_built_is_one_line_and_leaves_nothing(misbehaving):
    answer = misbehaving.run("built/run", "executor.workers=2", fault="segfault", moment="constructor")
    assert (answer.status, answer.line) == (
        2,
        "arena: planner misbehaving, or what it runs with, cannot be built: worker died: SIGSEGV",
    )
    assert not Path("built").exists()


@pytest.mark.slow
def test_a_run_with_a_fault_is_completed_once_the_fault_is_mended(misbehaving):
    assert misbehaving.run("run", "executor.workers=2", fault="abort", moment="later step").status == 1
    assert misbehaving.run("run", "executor.workers=2", "resume=true").status == 0
    assert misbehaving.whole.of("run") == misbehaving.whole
