"""One worker compiles, the others find the kernels on disk; who waits is told."""

import subprocess
import sys
from collections import deque
from pathlib import Path

import pytest

from arena_core.hosting import Job, compose, to_plain
from arena_core.runs.jobs.compiling import NOTICE, Turns, parts_of
from arena_core.runs.jobs.working import compile_job

CONFIG = {
    "planner": {"name": "switch", "members": [], "first": {"name": "dwa"}},
    "simulator": {"name": "sim2d"},
    "robot": {"name": "jackal"},
}


def jobs(*planners):
    return [Job({"planner": {"name": planner}}, "", number) for number, planner in enumerate(planners)]


def waiting(*planners):
    return deque((job, 1) for job in jobs(*planners))


def taken(turns, worker, queue):
    found = turns.take(worker, queue)
    return None if found is None else found[0].episode


def test_parts_are_the_names_of_what_has_kernels_and_of_what_it_is_made_of():
    assert parts_of(Job(CONFIG, "", 0)) == ("sim2d", "switch", "dwa")


def test_others_wait_until_the_first_command_is_given_then_go_in_order():
    turns, queue = Turns(), waiting("dwa", "dwa", "dwa")
    turns.expect(job for job, _ in queue)
    assert [taken(turns, worker, queue) for worker in "abc"] == [0, None, None]
    turns.given("b")
    assert taken(turns, "b", queue) is None
    turns.given("a")
    assert [taken(turns, worker, queue) for worker in "bc"] == [1, 2]


def test_while_one_begins_with_another_planner_the_others_go_on_with_what_has_been_driven():
    turns, queue = Turns(), waiting("dwa", "dwa", "dwa", "teb", "teb")
    turns.expect(job for job, _ in queue)
    assert taken(turns, "a", queue) == 0
    turns.given("a")
    assert [taken(turns, worker, queue) for worker in "bcab"] == [3, 1, 2, None]
    turns.given("b")
    assert taken(turns, "b", queue) == 4


def test_what_has_been_driven_in_an_earlier_round_needs_no_turn():
    turns = Turns()
    for queue in (waiting("dwa"), waiting("dwa", "dwa")):
        turns.expect(job for job, _ in queue)
        first = taken(turns, "a", queue)
        assert first == 0
        if not queue:
            turns.given("a")
    assert taken(turns, "b", queue) == 1


def test_a_worker_that_dies_before_its_first_command_leaves_the_turn_to_others():
    turns, queue = Turns(), waiting("dwa", "dwa")
    turns.expect(job for job, _ in queue)
    found = turns.take("a", queue)
    turns.given("a")  # what an executor says of a worker that it dismisses
    queue.appendleft(found)
    assert taken(turns, "b", queue) == 0


def test_idle_workers_rehearse_each_brain_once_the_leaders_first():
    config = {"simulator": {"name": "sim2d"}, "localizer": {"name": "amcl"}}
    queue = deque(
        (Job(config | {"planner": {"name": planner}}, "", n), 1) for n, planner in enumerate(("dwa", "teb", "teb"))
    )
    queue.append((Job({**config, "simulator": {"name": "other"}, "planner": {"name": "dwa"}}, "", 3), 1))
    turns = Turns()
    turns.expect(job for job, _ in queue)
    assert turns.rehearsal() is None
    assert taken(turns, "a", queue) == 0
    assert [job and job.episode for job in (turns.rehearsal(), turns.rehearsal(), turns.rehearsal())] == [0, 1, None]
    turns.given("a")
    assert turns.rehearsal() is None


REHEARSED = """
    from pathlib import Path
    from typing import ClassVar

    from arena_core import Planner, Twist, hookimpl


    class Silent(Planner):
        def reset(self, episode):
            pass

        def compute_velocity(self, observation):
            with Path("asked").open("a") as file:
                file.write(f"{observation.local_map.costs.shape[0] > 0} {len(observation.scan.ranges)}\\n")
            if observation.stamp > 0.15:
                raise SystemExit(3)
            return Twist(0.1, 0.0, 0.0)


    class Compiling(Silent):
        compiles: ClassVar[bool] = True


    @hookimpl
    def register_planners(register):
        register("silent", Silent)
        register("compiling", Compiling)


    @hookimpl
    def config_package():
        return "rehearsed.conf"
"""


@pytest.mark.parametrize(("planner", "asked"), [("silent", []), ("compiling", ["True 720"] * 3)])
def test_a_rehearsal_asks_planners_that_compile_and_what_they_do_is_their_own_affair(
    planner, asked, third_party, tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    conf = {f"planner/{name}": f"name: {name}\n" for name in ("silent", "compiling")}
    third_party.package("rehearsed", REHEARSED, conf)
    config = to_plain(compose([f"planner={planner}", "robot=jackal", "world=empty"]))
    compile_job(Job({**config, "choices": {}, "code": ""}, str(tmp_path), 0))
    assert (Path("asked").read_text().splitlines() if asked else []) == asked
    assert Path("asked").exists() == bool(asked)
    assert not (tmp_path / "records").exists()


PLANNER = """
    from os import getpid
    from pathlib import Path

    from numba import njit

    from arena_core import Planner, Twist, hookimpl


    @njit(cache=True)
    def zero(x):
        return x - x


    @njit(cache=True)
    def one(x):
        return zero(x) + 1.0


    @njit(cache=True)
    def two(x):
        return one(x) + one(x)


    @njit(cache=True)
    def three(x):
        return two(x) + one(x)


    @njit(cache=True)
    def four(x):
        return two(x) + two(x)


    class Compiled(Planner):
        def reset(self, episode):
            pass

        def compute_velocity(self, observation):
            speed = 0.1 * (three(1.0) + four(1.0))
            told = Path("misses") / str(getpid())
            told.parent.mkdir(exist_ok=True)
            kernels = (zero, one, two, three, four)
            told.write_text(str(sum(sum(kernel.stats.cache_misses.values()) for kernel in kernels)))
            return Twist(speed, 0.0, 0.0)


    @hookimpl
    def register_planners(register):
        register("compiled", "compiled:Compiled")


    @hookimpl
    def config_package():
        return "compiled.conf"
"""
RUN = (
    *(
        "planner=compiled",
        "robot=jackal",
        "world=empty",
        "world.width=6",
        "world.height=6",
        "task.pedestrians=0",
        "task.time_limit=2",
    ),
    *("localizer=ground_truth", "report=false", "hydra.run.dir=run", "episodes=6"),
)


@pytest.mark.slow
@pytest.mark.parametrize("executor", ["executor=serial", "executor.workers=2"])
def test_each_kernel_is_compiled_once(executor, third_party, arena):
    third_party.package("compiled", PLANNER, {"planner/compiled": "name: compiled\n"})
    assert arena("run", *RUN, executor).status == 0
    told = [int(path.read_text()) for path in Path("misses").iterdir()]
    assert sum(told) == 5
    assert len(told) == 1 if executor == "executor=serial" else 1 < len(told) <= 6  # whoever compiled is replaced


@pytest.mark.slow
def test_who_waits_is_told(third_party):
    third_party.package("compiled", PLANNER, {"planner/compiled": "name: compiled\n"})
    command = [sys.executable, "-m", "arena_core.cli.main", "run", *RUN, "executor.workers=2"]
    done = subprocess.run(command, cwd=third_party.folder, capture_output=True, text=True, check=True)
    # a busy machine takes long enough for those
    told = [line for line in done.stderr.splitlines() if " of 6 episodes, " not in line]
    assert told == [f"arena: {NOTICE}"]


NAMED = """
from numba import njit
from numpy import ones

from arena_core.base.notices import activity
from arena_core.runs.jobs.compiling import announce_compilation

said = []
announce_compilation(lambda: said.append(activity.doing))


@njit
def inner(values):
    return values.sum()


@njit
def outer(values):
    return inner(values) + 1.0


outer(ones(3))
print(said[0], list(dict.fromkeys(said)), repr(activity.doing), sep="; ")
"""


def test_a_kernel_is_named_while_it_is_compiled():
    done = subprocess.run([sys.executable, "-c", NAMED], capture_output=True, text=True, check=True)
    first, said, after = done.stdout.strip().split("; ")
    assert first == "compiling __main__: outer"
    assert said == "['compiling __main__: outer', 'compiling __main__: inner']"
    assert after == "''"
