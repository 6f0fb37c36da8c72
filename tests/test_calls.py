"""What a control step costs, told by counts: unlike times they are the same on every machine and on a busy one.

Counted are the calls of one and the same episode when it may last two seconds more, by control step: what an episode
costs once is not in them. A ceiling is about a tenth above the count of the day it was set (CPython 3.11; later ones
count no comprehensions). Who adds calls to every step raises it and says why; who removes calls lowers it.
"""

import sys
from types import SimpleNamespace

import pytest

from arena_core.config.configuration import compose, to_plain
from arena_core.config.registry import load_registry
from arena_core.runs.jobs.benchmark import build_benchmark
from arena_core.runs.jobs.profiling import own_folders
from arena_kernels.compiled import TypedDispatch

WORDS = ("robot=jackal", "world=empty", "task.pedestrians=2")
SHORT, LONG = 2.0, 4.0  # s that the episode may last; no one is at the goal before
CEILINGS = {  # by planner: calls of the suite's Python functions, and entries of its kernels
    "pure_pursuit": (263, 11),  # predictions that are made when asked for, and what tells a robot that leans
    "dwa": (308, 15),
}


class Counting:
    """Counts as the interpreter tells calls: of functions in own files, of their dataclasses'
    constructors, and of kernels.
    """

    def __init__(self):
        self.python, self.kernels = 0, 0
        self._own = tuple(own_folders())
        self._entry = TypedDispatch.__call__.__code__

    def __call__(self, frame, event, _):
        if event != "call":
            return
        code = frame.f_code
        generated = code.co_filename == "<string>" and frame.f_globals.get("__name__", "").startswith("arena_")
        self.python += generated or code.co_filename.startswith(self._own)
        self.kernels += code is self._entry


def count(planner, time_limit, folder):
    """Run the first episode, warm, and return its steps, calls and kernels."""
    words = [*WORDS, f"planner={planner}", f"task.time_limit={time_limit}"]
    benchmark = build_benchmark(to_plain(compose(words)), load_registry())
    benchmark.run(0, folder)
    counting, before = Counting(), sys.getprofile()
    sys.setprofile(counting)
    try:
        record = benchmark.run(0, folder)
    finally:
        sys.setprofile(before)
    assert record.meta["outcome"] == "time_out"
    return SimpleNamespace(steps=len(record["stamp"]) - 1, python=counting.python, kernels=counting.kernels)


@pytest.mark.parametrize("planner", CEILINGS)
def test_a_control_step_makes_no_more_calls_than_its_ceiling(planner, tmp_path):
    short, long = (count(planner, time_limit, tmp_path) for time_limit in (SHORT, LONG))
    steps = long.steps - short.steps
    assert steps == 20
    python, kernels = (long.python - short.python) / steps, (long.kernels - short.kernels) / steps
    assert python > kernels > 1.0  # something was counted at all
    counted, (most_python, most_kernels) = f"{python:.1f} calls and {kernels:.1f} kernels a step", CEILINGS[planner]
    assert python <= most_python, counted
    assert kernels <= most_kernels, counted
