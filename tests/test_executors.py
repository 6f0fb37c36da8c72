import multiprocessing
import os
import signal
import time
from contextlib import closing

import pytest

from arena_core import ConfigurationError, Job
from arena_core.errors import RunStopped
from arena_core.executors import ProcessExecutor, SerialExecutor
from arena_core.registry import load_registry
from arena_core.testing import check, robot
from arena_core.testing.checks import echo

JOBS = [Job({}, "", episode) for episode in range(5)]


def rows(executor, work=echo, jobs=JOBS):
    with closing(executor):
        return list(executor.map(work, jobs))


def numbers(executor, work=echo, jobs=JOBS):
    return [row["episode"] for row in rows(executor, work, jobs)]


@pytest.mark.parametrize("executor", [SerialExecutor(), ProcessExecutor(2)])
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
    assert sorted(numbers(ProcessExecutor(2))) == numbers(SerialExecutor())


def test_a_single_job_needs_no_worker():
    assert [row["pid"] for row in ProcessExecutor(8).map(lambda job: {"pid": os.getpid()}, JOBS[:1])] == [os.getpid()]


def test_no_job_gives_no_row():
    assert numbers(ProcessExecutor(2), jobs=[]) == []


def test_workers_stay_warm_from_one_call_to_the_next(third_party):
    third_party.write("dying.py", DYING)
    import dying

    with closing(ProcessExecutor(1)) as one, closing(ProcessExecutor(2)) as two:
        assert {row["pid"] for row in one.map(dying.say_where, JOBS)} == {os.getpid()}
        list(two.map(dying.say_where, JOBS))
        workers = {child.pid for child in multiprocessing.active_children()}
        assert {row["pid"] for row in two.map(dying.say_where, JOBS[:1])} <= workers
    assert not [child for child in multiprocessing.active_children() if child.is_alive()]


def test_without_a_number_there_is_one_worker_a_core():
    assert ProcessExecutor(None).workers == os.cpu_count()


@pytest.mark.parametrize("workers", [0, -1, 1.5, "many"])
def test_an_impossible_number_of_workers_is_named(workers):
    with pytest.raises(ConfigurationError, match=r"executor\.workers is .*; allowed: "):
        load_registry().build("executor", {"name": "processes", "workers": workers})


DYING = """
    import os
    import signal
    import time

    def work(job):
        if job.episode == 2:
            os._exit(9)
        return {"episode": job.episode}

    def say_where(job):
        return {"pid": os.getpid()}

    def leaves_ctrl_c_alone(job):
        return {"episode": job.episode, "alone": signal.getsignal(signal.SIGINT) is signal.SIG_IGN}

    def interrupt(job):
        if job.episode == 1:
            os.kill(os.getppid(), signal.SIGINT)
            os.kill(os.getpid(), signal.SIGINT)
            time.sleep(0.2)
        return {"episode": job.episode}
"""


def test_a_worker_that_dies_stops_the_run_with_one_line(third_party):
    third_party.write("dying.py", DYING)
    import dying

    with pytest.raises(RunStopped, match=r"a worker process died .*finished episodes are kept, resume=true continues"):
        numbers(ProcessExecutor(2), dying.work)


def test_workers_leave_ctrl_c_to_the_main_process(third_party):
    third_party.write("dying.py", DYING)
    import dying

    assert all(row["alone"] for row in rows(ProcessExecutor(2), dying.leaves_ctrl_c_alone))


def test_ctrl_c_reaches_the_main_process_and_leaves_no_worker_behind(third_party):
    third_party.write("dying.py", DYING)
    before = signal.signal(signal.SIGINT, signal.default_int_handler)  # whatever started the tests may have it ignored
    import dying

    def run():
        numbers(ProcessExecutor(2), dying.interrupt)
        time.sleep(5.0)  # the signal may come after the last row

    try:
        with pytest.raises(KeyboardInterrupt):
            run()
    finally:
        signal.signal(signal.SIGINT, before)
    assert not [child for child in multiprocessing.active_children() if child.is_alive()]
