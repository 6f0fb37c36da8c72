"""A profile tells where the time of control steps goes; that what it says adds up, not how long anything takes."""

import pytest

from arena_core.cli.main import main
from arena_core.config.configuration import compose
from arena_core.hosting import load_registry
from arena_core.runs.jobs.benchmark import build_benchmark
from arena_core.runs.jobs.profiling import METRICS, TASK, Clock, profile_benchmark

SHORT = [
    "planner=pure_pursuit",
    "robot=jackal",
    "world=empty",
    "task.pedestrians=2",
    "task.time_limit=3",
    "localizer=ground_truth",
]


@pytest.fixture(scope="module")
def found():
    return profile_benchmark(build_benchmark(compose(SHORT), load_registry()), 2)


def test_every_part_is_told(found):
    assert {"simulator", "localizer", "waypoints", "planner", "local map", "loop", TASK, METRICS} <= set(found.parts)
    assert found.episodes == 2
    assert 0 < found.steps <= 2 * 30
    assert found.simulated == pytest.approx(0.1 * found.steps)


def test_compiled_functions_are_told_from_others_however_they_are_called(found):
    kinds = {called.place[2].removesuffix(">").rpartition(".")[2]: called.compiled for called in found.functions}
    assert kinds["run_ticks"]
    assert kinds["compute_velocity"] is False
    assert all(
        spent.compiled >= 0.0 and spent.libraries >= 0.0 and spent.python >= 0.0 for spent in found.parts.values()
    )


def test_a_watched_benchmark_is_as_it_was(found):
    benchmark = build_benchmark(compose(SHORT), load_registry())
    before = vars(benchmark.simulator).keys() - {"advance", "reset"}
    profile_benchmark(benchmark, 1)
    assert "advance" not in vars(benchmark.simulator)
    assert before <= vars(benchmark.simulator).keys()


def test_time_inside_a_part_counts_for_that_part_alone(monkeypatch):
    time = [0.0]
    monkeypatch.setattr("arena_core.runs.jobs.profiling.process_time", lambda: time[0])
    clock = Clock()
    with clock.part("outer"):
        time[0] += 1.0
        with clock.part("inner"):
            time[0] += 4.0
        time[0] += 2.0
    assert clock.spent == {"inner": 4.0, "outer": 3.0}


def test_the_command_prints_parts_and_functions(capsys):
    assert main(["profile", *SHORT, "first=1", "functions=4"]) == 0
    printed, said = capsys.readouterr()
    told = printed.splitlines()
    assert [line.split(":")[1].strip() for line in said.splitlines() if line.startswith("arena: ")] == [
        "1 of 3",
        "2 of 3",
        "3 of 3",
    ]
    assert told[0].startswith("1 episode, ")
    assert any(line.startswith("planner ") for line in told)
    assert len(told[told.index("ms a step  calls  most time in (Python as the profiler slows it)") + 1 :]) == 4


def test_a_wrong_word_is_refused_in_one_line(capsys):
    assert main(["profile", "first=0"]) == 2
    assert "first" in capsys.readouterr().err
