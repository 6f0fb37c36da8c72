import multiprocessing
import os
import signal
import subprocess
import sys
import time
from contextlib import closing
from dataclasses import replace

import pytest

from arena_core import ConfigurationError
from arena_core.base.errors import RunFolderError
from arena_core.config.registry import load_registry
from arena_core.hosting import Job, Lost
from arena_core.runs.jobs.compiling import MANY
from arena_core.runs.workers.budgets import Budgets, Watch
from arena_core.runs.workers.executors import ProcessExecutor, SerialExecutor
from arena_core.runs.workers.worker import Task, Worker
from arena_core.testing import check, robot
from arena_core.testing.checks import echo_job

JOBS = [Job({}, "", episode) for episode in range(5)]
BUDGETS = ("first_command", "command", "episode", "memory")
GENEROUS = Budgets(600.0, 60.0, 600.0, 4.0)


def processes(workers=2, budgets=GENEROUS):
    return ProcessExecutor(workers, budgets)


def rows(executor, work=echo_job, jobs=JOBS):
    with closing(executor):
        return list(executor.map(work, jobs))


def numbers(executor, work=echo_job, jobs=JOBS):
    return [row["episode"] for row in rows(executor, work, jobs)]


@pytest.mark.parametrize("executor", [SerialExecutor(), processes()])
def test_keeps_the_contract_of_an_executor(executor):
    assert check("executor", executor, robot())


def test_serial_runs_in_order_and_only_what_is_asked_for():
    begun = []

    def work(job):
        begun.append(job.episode)
        return {"episode": job.episode}

    rows = SerialExecutor().map(work, JOBS)
    assert next(rows) == {"episode": 0}
    assert begun == [0]


def test_processes_give_the_rows_that_serial_gives():
    assert sorted(numbers(processes())) == numbers(SerialExecutor())


def test_no_job_gives_no_row():
    assert numbers(processes(), jobs=[]) == []


def test_without_a_number_there_is_one_worker_a_core():
    assert processes(None).supervisor.workers == os.cpu_count()


@pytest.mark.parametrize("workers", [0, -1, 1.5, "many"])
def test_an_impossible_number_of_workers_is_named(workers):
    with pytest.raises(ConfigurationError, match=r"executor\.workers is .*; allowed: "):
        load_registry().build("executor", {"name": "processes", "workers": workers, "budgets": dict.fromkeys(BUDGETS)})


@pytest.mark.parametrize("budget", BUDGETS)
def test_an_impossible_budget_is_named(budget):
    budgets = {**dict.fromkeys(BUDGETS), budget: 0}
    with pytest.raises(ConfigurationError, match=rf"executor\.budgets\.{budget} is 0; allowed: > 0"):
        load_registry().build("executor", {"name": "processes", "workers": 1, "budgets": budgets})


WORK = """
    import os
    import signal
    import sys
    import threading
    import time

    from arena_core.base.errors import RunFolderError
    from arena_core.base.pulse import pulse

    def where(job):
        return {"episode": job.episode, "pid": os.getpid(), "parent": os.getppid()}

    def bad(job):
        if job.episode == 2:
            BAD[job.config["bad"]]()
        return where(job)

    def compile_some(job):
        for _ in range(job.config["compiled"]):
            pulse.compile()
        pulse.beat()
        return where(job)

    def hang_in_the_first_command(job):
        pulse.beat()
        if job.config.get("compiles"):
            pulse.compile()
        if job.episode == 2:
            time.sleep(1000)
        pulse.finish()
        return where(job)

    def once(job):
        if job.episode == 2 and not os.path.exists(job.folder):
            open(job.folder, "w").close()
            os.kill(os.getpid(), signal.SIGKILL)
        return where(job)

    def hang_later():
        for _ in range(5):
            pulse.beat()
        time.sleep(1000)

    def never_end():
        while True:
            pulse.beat()
            time.sleep(0.01)

    def grow():
        kept = []
        while True:
            kept.append(bytearray(10_000_000))
            time.sleep(0.001)

    def fork():
        if os.fork() == 0:
            pulse.finish()

    def fork_and_hang():
        if os.fork() == 0:
            time.sleep(1000)

    def full():
        raise RunFolderError("cannot write it: No space left on device")

    def ignore_everything():
        for number in (signal.SIGTERM, signal.SIGINT, signal.SIGALRM):
            signal.signal(number, lambda *_: None)
        time.sleep(1000)

    def still(job):
        open(os.path.join(job.folder, str(os.getpid())), "w").close()
        if job.episode % 2:
            time.sleep(1000)
        while True:
            pass

    BAD = {
        "exit": lambda: os._exit(3),
        "exit as if all were well": lambda: os._exit(0),
        "segfault": lambda: os.kill(os.getpid(), signal.SIGSEGV),
        "abort": os.abort,
        "pipe": lambda: os.closerange(3, os.sysconf("SC_OPEN_MAX")),
        "sys.exit": lambda: sys.exit(5),
        "hang": lambda: time.sleep(1000),
        "deadlock": lambda: (lambda lock: (lock.acquire(), lock.acquire()))(threading.Lock()),
        "hang later": hang_later,
        "never end": never_end,
        "grow": grow,
        "ignore": ignore_everything,
        "fork": fork,
        "fork and hang": fork_and_hang,
        "full": full,
        "chdir": lambda: os.chdir("/"),
        "handlers": lambda: signal.signal(signal.SIGUSR1, lambda *_: None),
        "stdout": lambda: os.close(1),
        "print": lambda: sys.stdout.close(),
    }
"""


@pytest.fixture
def working(third_party):
    third_party.write("working.py", WORK)
    import working

    return working


def of(bad):
    return [Job({"bad": bad}, "", episode) for episode in range(5)]


def left():
    return [child for child in multiprocessing.active_children() if child.is_alive()]


def gone(pid):
    """Return whether a process ends within a while."""
    for _ in range(600):
        try:
            os.kill(pid, 0)
        except ProcessLookupError:
            return True
        with open(f"/proc/{pid}/stat") as file:
            if file.read().rpartition(")")[2].split()[0] == "Z":  # an orphan that no one has collected yet
                return True
        time.sleep(0.05)
    return False


@pytest.mark.slow
@pytest.mark.parametrize(
    ("bad", "workers", "tight", "reason"),
    [
        ("exit", 1, {}, "worker died: exit status 3"),
        ("exit as if all were well", 2, {}, "worker died: exit status 0"),
        ("segfault", 1, {}, "worker died: SIGSEGV"),
        ("abort", 2, {}, "worker died: SIGABRT"),
        ("pipe", 1, {}, "worker died: exit status 1"),
        ("hang", 1, {"first_command": 8.0}, "no first command within 8 s"),
        ("deadlock", 2, {"first_command": 8.0}, "no first command within 8 s"),
        ("hang later", 2, {"command": 5.0}, "no command within 5 s"),
        ("never end", 1, {"episode": 15.0}, "not over within 15 s"),
        ("grow", 2, {"memory": 0.6}, "more than 0.6 GB"),
        ("ignore", 1, {"first_command": 8.0}, "no first command within 8 s"),
    ],
)
def test_whatever_a_job_does_costs_that_job_alone(working, workers, bad, tight, reason):
    answers = rows(processes(workers, replace(GENEROUS, **tight)), working.bad, of(bad))
    assert [answer.reason for answer in answers if isinstance(answer, Lost)] == [reason]
    assert [answer.job.episode for answer in answers if isinstance(answer, Lost)] == [2]
    assert sorted(answer["episode"] for answer in answers if not isinstance(answer, Lost)) == [0, 1, 3, 4]
    assert not left()


def test_a_worker_that_somebody_killed_once_costs_nothing(working, tmp_path):
    jobs = [Job({}, str(tmp_path / "killed"), episode) for episode in range(5)]
    assert sorted(numbers(processes(1), working.once, jobs)) == [0, 1, 2, 3, 4]
    assert (tmp_path / "killed").exists()


def test_workers_stay_warm_from_one_call_to_the_next(working):
    with closing(processes(1)) as executor:
        pids = {row["pid"] for jobs in (JOBS, JOBS[:1]) for row in executor.map(working.where, jobs)}
        assert len(pids) == 1
        assert pids != {os.getpid()}
        checked = {row["pid"] for row in executor.prepare(working.where, JOBS)}
        assert checked == pids
    assert not left()


@pytest.mark.parametrize("bad", ["chdir", "handlers", "stdout", "print"])
def test_a_process_that_a_job_has_changed_is_not_used_again(working, bad):
    pids = [row["pid"] for row in rows(processes(1), working.bad, of(bad))]
    assert len(pids) == 5
    assert len({*pids[:3]}) == len({*pids[3:]}) == 1
    assert pids[2] != pids[3]


@pytest.mark.parametrize(("compiled", "used_again"), [(MANY - 1, True), (MANY, False)])
def test_a_process_that_compiled_for_the_first_of_its_kind_is_not_used_again(working, compiled, used_again):
    jobs = [Job({"planner": {"name": "new"}, "compiled": compiled}, "", episode) for episode in range(3)]
    pids = [row["pid"] for row in rows(processes(1), working.compile_some, jobs)]
    assert (pids[0] == pids[1]) == used_again
    assert pids[1] == pids[2]


def test_a_forked_child_that_comes_back_gives_no_second_row(working):
    assert sorted(numbers(processes(1), working.bad, of("fork"))) == [0, 1, 2, 3, 4]


def test_what_a_job_has_forked_ends_with_its_worker(working):
    with closing(processes(1)) as executor:
        (worker,) = {row["pid"] for row in executor.map(working.bad, of("fork and hang"))}
        with open(f"/proc/{worker}/task/{worker}/children") as file:
            (child,) = map(int, file.read().split())
    assert gone(child)


def test_a_job_that_ends_with_sys_exit_is_lost_with_that_word(working):
    answers = rows(processes(1), working.bad, of("sys.exit"))
    assert [answer.reason for answer in answers if isinstance(answer, Lost)] == ["SystemExit: 5"]


def test_what_work_raises_is_raised(working):
    with pytest.raises(RunFolderError, match="cannot write it: No space left on device"):
        rows(processes(2), working.bad, of("full"))
    assert not left()


def test_time_in_which_the_supervisor_sleeps_counts_for_nobody():
    watch = Watch(Budgets(None, 2.5, None, None))
    assert watch.look(2, 0.1, 0) is None
    assert watch.look(2, 3600.0, 0) is None
    assert [watch.look(2, 0.9, 0) for _ in range(2)] == [None, "no command within 2.5 s"]


@pytest.mark.parametrize(
    ("beats", "warm", "seconds"),
    [(0, False, 600), (1, False, 600), (0, True, 60), (1, True, 5), (2, False, 5), (2, True, 5)],
)
def test_a_warm_worker_has_no_longer_for_its_first_command_than_for_any_other(beats, warm, seconds):
    watch = Watch(Budgets(600.0, 5.0, None, None))
    told = [watch.look(beats, 1.0, 0, warm=warm) for _ in range(700)]
    assert told.index(f"no {'first ' * (beats < 2)}command within {seconds} s") == seconds + 1


@pytest.mark.parametrize(
    ("first", "command", "limit"), [(3.0, 5.0, 3.0), (None, 5.0, 5.0), (3.0, None, 3.0), (None, None, None)]
)
def test_the_lesser_budget_holds_in_a_warm_worker(first, command, limit):
    assert Watch(Budgets(first, command, None, None))._time_limit(warm=False) is None, "it has not begun"
    watch = Watch(Budgets(first, command, None, None))
    watch.look(1, 0.0, 0, warm=True)
    assert watch._time_limit(warm=True) == limit


def test_a_planner_that_hangs_in_its_first_command_costs_a_warm_worker_a_command(working):
    answers = rows(processes(1, Budgets(600.0, 5.0, None, None)), working.hang_in_the_first_command)
    assert [answer.reason for answer in answers if isinstance(answer, Lost)] == ["no first command within 5 s"]


@pytest.mark.slow
@pytest.mark.parametrize("config", [{"compiles": True}, {"planner": {"name": "new"}}], ids=["compiles", "others"])
def test_a_worker_that_compiles_or_has_other_components_has_the_first_budget(working, config):
    jobs = [JOBS[0], Job(config, "", 2)]
    answers = rows(processes(1, Budgets(8.0, 5.0, None, None)), working.hang_in_the_first_command, jobs)
    assert [answer.reason for answer in answers if isinstance(answer, Lost)] == ["no first command within 8 s"]


SUPERVISOR = """
import sys
from arena_core.hosting import Job
from arena_core.runs.workers.budgets import Budgets
from arena_core.runs.workers.executors import ProcessExecutor
import working

if __name__ == "__main__":
    jobs = [Job({}, sys.argv[1], k) for k in range(2)]
    for _ in ProcessExecutor(2, Budgets(None, None, None, None)).map(working.still, jobs):
        pass
"""


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGTERM])
def test_workers_end_when_their_parent_has_gone_whatever_they_are_at(working, third_party, tmp_path, number):
    third_party.write("supervisor.py", SUPERVISOR)
    (tmp_path / "pids").mkdir()
    words = [sys.executable, str(third_party.folder / "supervisor.py"), str(tmp_path / "pids")]
    parent = subprocess.Popen(words, env=third_party.environment)
    while len(pids := [int(path.name) for path in (tmp_path / "pids").iterdir()]) < 2:
        assert parent.poll() is None
        time.sleep(0.05)
    parent.send_signal(number)
    parent.wait()
    assert all(gone(pid) for pid in pids)


@pytest.mark.parametrize("work", [echo_job, time.sleep], ids=["answers", "raises"])
def test_what_comes_of_a_rehearsal_is_nobodys_row(work):
    with closing(processes(1)) as executor:
        worker = Worker()
        executor.supervisor._staff.append(worker)
        assert worker.begin(work, Task(JOBS[0], 1, Watch(GENEROUS), rehearsal=True))
        while worker.task:
            assert list(executor.supervisor._check_worker(worker, 0.0)) == []
            time.sleep(0.02)
        assert not executor.supervisor.unfinished
