"""A planner's fault costs its episode and no other: a share of what
tests/long/test_every_fault.py tries at every moment.
"""

import re
from pathlib import Path

import psutil
import pytest

FAULTY = 4


def rows_after(misbehaving, folder, faults, *words):
    """Let faults befall some episodes of a run; return its answer and their rows, after all other episodes were found
    as they are without.
    """
    misbehaving.befall_each({episode: fault[:2] for episode, fault in faults.items()})
    answer = misbehaving.arena("run", *misbehaving.words(folder), *words)
    kept = misbehaving.whole.of(folder)
    spoilt = {f"{episode:04d}.npz" for episode in faults}
    for found, wanted, names in (
        (kept.rows, misbehaving.whole.rows, set(faults)),
        (kept.records, misbehaving.whole.records, spoilt),
    ):
        assert {k: each for k, each in found.items() if k not in names} == {
            k: each for k, each in wanted.items() if k not in names
        }
    rows = {episode: kept.rows[episode] for episode in faults}
    failed = {episode: row["error"] for episode, row in rows.items() if row["outcome"] == "error"}
    said = sorted(line for line in answer.errors if line.startswith("episode "))  # a worker that dies may say more
    assert said == [f"episode {episode} failed: {failed[episode]}" for episode in sorted(failed)]
    assert answer.status == int(bool(failed))
    assert not [path for path in Path(folder).rglob(".*") if path.is_file()]
    return rows


@pytest.mark.slow
def test_a_fault_costs_its_episode_alone(misbehaving):
    faults = {
        1: ("segfault", "reset", "worker died: SIGSEGV"),
        3: ("memory", "first step", "more than 1 GB"),
        5: ("surrogate", "later step", r"RuntimeError: \ud800 \x00 \x1b[31m"),
        7: ("sleep", "later step", "no command within 20 s"),
    }
    rows = rows_after(misbehaving, "faulty", faults, "executor.workers=2")
    found = {episode: (row["outcome"], row["error"]) for episode, row in rows.items()}
    assert found == {episode: ("error", error) for episode, (*_, error) in faults.items()}


@pytest.mark.slow
def test_what_an_episode_does_to_its_process_does_not_reach_the_next(misbehaving):
    names = ("chdir", "few descriptors", "stack", "seterr", "half a message")
    faults = {2 * number: (name, "reset") for number, name in enumerate(names)}
    rows = rows_after(misbehaving, "moved", faults, "executor.workers=1")
    assert rows == {episode: misbehaving.whole.rows[episode] for episode in faults}


SPOILT = [  # each is followed by an episode without a fault
    {
        0: ("descriptors", "first step", "RunFolderError: cannot write .*0000.npz: Too many open files"),
        2: ("RunFolderError", "reset", "RunFolderError: cannot write it: No space left on device"),
        4: ("file size", "first step", "RunFolderError: cannot write .*0004.npz: File too large"),
    },
    {
        0: ("umask", "reset", ""),
        2: ("np.array", "later step", ".*"),
        4: ("np.hypot", "later step", ""),
        6: ("map", "reset", "worker died: SIG(SEGV|BUS)"),
    },
]


@pytest.mark.slow
@pytest.mark.parametrize("faults", SPOILT, ids=["limits", "parts"])
def test_a_process_or_map_that_an_episode_has_spoilt_costs_that_episode_alone(misbehaving, faults):
    rows = rows_after(misbehaving, "spoilt", faults, "executor.workers=1")
    for episode, (name, _, error) in faults.items():
        assert re.fullmatch(error, rows[episode]["error"]), name


@pytest.mark.slow
def test_processes_that_left_their_session_end_with_the_worker(misbehaving, monkeypatch, tmp_path):
    monkeypatch.setenv("PIDS", str(tmp_path / "pids"))
    faults = {FAULTY: ("sessions", "reset")}
    assert rows_after(misbehaving, "off", faults, "executor.workers=1")[FAULTY] == misbehaving.whole.rows[FAULTY]
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
    assert misbehaving.run("run", "executor.workers=1", fault="abort", moment="later step").status == 1
    assert misbehaving.run_alone("run", "resume=true").status == 0
    assert misbehaving.whole.of("run") == misbehaving.whole
