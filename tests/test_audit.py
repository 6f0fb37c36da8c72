"""At the end of a run its rows and its records are counted against each other, whatever the executor."""

import csv
from pathlib import Path

PLUGIN = """
from arena_core import hookimpl
from arena_core.hosting import Executor, Finished

class Forgetful(Executor):
    def map(self, work, jobs):
        return iter([work(job) for job in jobs][:2])

class Inventive(Executor):
    def map(self, work, jobs):
        yield work(jobs[0])
        for job in jobs[1:]:
            yield Finished(job, {"episode": job.episode, "outcome": "goal_reached", "error": ""}, True)

class Lazy(Executor):
    def map(self, work, jobs):
        yield work(jobs[0])

@hookimpl
def register_executors(register):
    register("forgetful", Forgetful)
    register("inventive", Inventive)
    register("lazy", Lazy)

@hookimpl
def config_package():
    return "odd.conf"
"""
WORDS = (
    "planner=pure_pursuit",
    "robot=jackal",
    "world=empty",
    "world.width=6",
    "world.height=6",
    "task.pedestrians=0",
    "report=false",
)


def answer_of(third_party, arena, executor):
    third_party.package(
        "odd", PLUGIN, {f"executor/{name}": f"name: {name}\n" for name in ("forgetful", "inventive", "lazy")}
    )
    return arena("run", *WORDS, "task.time_limit=5", "episodes=3", f"executor={executor}", "hydra.run.dir=run")


def test_a_record_whose_row_never_came_has_its_row(third_party, arena):
    assert answer_of(third_party, arena, "forgetful").status == 0
    with Path("run/episodes.csv").open(newline="") as file:
        assert [row["episode"] for row in csv.DictReader(file)] == ["0", "1", "2"]


def test_rows_without_records_end_the_run_with_one_line(third_party, arena):
    answer = answer_of(third_party, arena, "inventive")
    assert answer.status == 1
    assert "0 of 3 episodes have no row, 2 rows have no record" in answer.line


def test_episodes_that_were_never_answered_end_the_run_with_one_line(third_party, arena):
    answer = answer_of(third_party, arena, "lazy")
    assert answer.status == 1
    assert "2 of 3 episodes have no row, 0 rows have no record" in answer.line
