"""Every fault at every moment of an episode, with one worker and with two: it costs that episode, and all
others are as without it.
"""

from pathlib import Path

import pytest

pytestmark = pytest.mark.long
FAULTY = 4
ERRORS = {
    "os._exit": "worker died: exit status 0",
    "sys.exit": "SystemExit: 5",
    "segfault": "worker died: SIGSEGV",
    "abort": "worker died: SIGABRT",
    "SIGKILL": "worker died: SIGKILL",
    "BaseException": "BaseException: no Exception",
    "KeyboardInterrupt": "KeyboardInterrupt:",
    "memory": "more than 1 GB",
    "spin": "command within ",
    "sleep": "command within ",
    "deadlock": "command within ",
    "write": "FrozenInstanceError: cannot assign to field 'goal'",
    "NaN": "InvalidCommand: Misbehaving.compute_velocity returned Twist(vx=nan",
    "type": "InvalidCommand: Misbehaving.compute_velocity returned str; allowed: a Twist",
    "huge text": "RuntimeError: xxxx",
    "surrogate": r"RuntimeError: \ud800 \x00 \x1b[31m",
}
HANGS = ("spin", "sleep", "deadlock")
HARMLESS = ("fork", "stdout", "chdir", "handlers")  # the process changes, the episode does not
ANSWERS = ("NaN", "type")  # a command is wrong only where one is asked for
MOMENTS = ("reset", "first step", "later step")


def budget_for(fault):
    """Return a budget in which every worker gets going, for faults that wait for its end."""
    return ("executor.budgets.first_command=60",) if fault in HANGS else ()


@pytest.mark.parametrize("workers", [1, 2])
@pytest.mark.parametrize("moment", MOMENTS)
@pytest.mark.parametrize("fault", [*ERRORS, *HARMLESS])
def test_a_fault_costs_its_episode_alone(misbehaving, fault, moment, workers):
    answer = misbehaving.run("faulty", f"executor.workers={workers}", *budget_for(fault), fault=fault, moment=moment)
    kept, name = misbehaving.whole.of("faulty"), f"{FAULTY:04d}.npz"
    row = kept.rows.pop(FAULTY)
    assert kept.rows == {k: row for k, row in misbehaving.whole.rows.items() if k != FAULTY}
    assert {k: v for k, v in kept.records.items() if k != name} == {
        k: v for k, v in misbehaving.whole.records.items() if k != name
    }
    if fault in HARMLESS or (fault in ANSWERS and moment == "reset"):
        assert row == misbehaving.whole.rows[FAULTY]
        assert (answer.status, answer.errors) == (0, [])
    else:
        assert row["outcome"] == "error"
        assert ERRORS[fault] in row["error"]
        assert (answer.status, answer.line) == (1, f"episode {FAULTY} failed: {row['error']}")


@pytest.mark.parametrize("workers", [1, 2])
@pytest.mark.parametrize("fault", [fault for fault in ERRORS if fault not in ANSWERS])
def test_a_fault_while_the_planner_is_built_is_one_line_and_nothing_runs(misbehaving, fault, workers):
    answer = misbehaving.run(
        "new/run", f"executor.workers={workers}", *budget_for(fault), fault=fault, moment="constructor"
    )
    assert answer.status == 2
    assert "cannot be built: " in answer.line or "plugin misbehaving" in answer.line
    assert not Path("new").exists()


@pytest.mark.parametrize("workers", [1, 2])
@pytest.mark.parametrize("fault", HARMLESS)
def test_what_a_planner_does_to_its_process_when_it_is_built_does_not_matter(misbehaving, fault, workers):
    answer = misbehaving.run("run", f"executor.workers={workers}", fault=fault, moment="constructor")
    assert (answer.status, answer.errors) == (0, [])
    assert misbehaving.whole.of("run") == misbehaving.whole
