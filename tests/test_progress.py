"""What a run says while it runs, where there is no terminal."""

import heapq
from pathlib import Path

import numpy as np
import pytest

from arena_core.base.notices import activity
from arena_core.hosting import Finished, Job
from arena_core.runs import progress
from arena_core.runs.folders.schedule import OpenRun
from arena_core.runs.jobs.code_digest import Code
from arena_core.runs.pace import Pace
from arena_core.runs.progress import COUNT_EVERY, LINE_EVERY, Progress, print_progress


@pytest.fixture
def clock(monkeypatch):
    """Give the list whose last entry is the time."""
    times = [100.0]
    monkeypatch.setattr(progress, "monotonic", lambda: times[-1])
    return times


def finished(episode, succeeded=True):
    return Finished(Job({}, "run", episode), {"episode": episode}, succeeded)


def a_run(episodes, name="run", rows=0, **config):
    return OpenRun(
        {"episodes": episodes, **config}, Path(name), {}, None, Code("", {}), rows={i: {} for i in range(rows)}
    )


def test_a_line_says_how_far_it_is_every_now_and_then(clock, capsys):
    with Progress([a_run(40, rows=10)]) as said:
        said.add(finished(10))
        assert capsys.readouterr().err == ""
        clock.append(clock[-1] + LINE_EVERY + 1.0)
        said.add(finished(11, succeeded=False))
        assert capsys.readouterr().err == "arena: 12 of 40 episodes, 1 of 2 succeeded, time left not known yet\n"
        said.add(finished(12))
        assert capsys.readouterr().err == ""


def test_the_bar_says_what_is_compiled_in_place_of_the_time_left(monkeypatch):
    (column,) = (one for one in progress._make_bar(lambda: 90.0).columns if type(one).__name__ == "TimeLeft")
    assert column.render(None).plain == "0:01:30 left"
    monkeypatch.setattr(activity, "doing", "compiling what dwa runs with: kernel 40")
    assert column.render(None).plain == "compiling what dwa runs with: kernel 40"


def test_a_count_is_said_at_once_then_now_and_then_and_not_for_one(clock, capsys):
    for item in print_progress("composing job", "abcd"):
        clock.append(clock[-1] + (COUNT_EVERY if item == "b" else 0.1))
    assert capsys.readouterr().err.splitlines() == ["arena: composing job 1 of 4", "arena: composing job 3 of 4"]
    assert list(print_progress("composing job", ["a"])) == ["a"]
    assert capsys.readouterr().err == ""


def test_time_in_which_kernels_were_compiled_does_not_count_into_the_time_left(clock, capsys):
    with Progress([a_run(20, executor={"workers": 1})]) as said:
        clock.append(clock[-1] + 100.0)
        said.add(finished(0))
        for episode in range(1, 9):
            clock.append(clock[-1] + 2.0)
            said.add(finished(episode))
        assert said._status_text() == "9 of 20 episodes, 9 of 9 succeeded, about 22 s left"
    assert capsys.readouterr().err == "arena: 1 of 20 episodes, 1 of 1 succeeded, time left not known yet\n"


def ends(workers, lengths, compiling):
    """Return when episodes of these lengths end that so many workers drive; the first compiles and is
    replaced, the others wait.
    """
    free, found = [(compiling, 0), *((compiling, number) for number in range(1, workers))], []
    for number, length in enumerate(lengths):
        at, worker = heapq.heappop(free)
        heapq.heappush(free, (at + length + (7.0 if number == 0 else 0.0), worker))
        found.append(at + length)
    return sorted(found)


@pytest.mark.parametrize("workers", [1, 2])
@pytest.mark.parametrize("spread", [0.1, 0.3])
def test_time_left_is_right_within_a_factor_of_one_and_a_half_after_a_fifth_of_a_run(workers, spread):
    known, close = 0, 0
    for seed in range(50):
        lengths = np.random.default_rng(seed).lognormal(1.0, spread, 50)
        times, pace = ends(workers, lengths, 75.0), Pace(workers)
        for time in times[:10]:
            pace.add("", time)
        left = pace.left({"": 40}, times[9])
        known += left is not None
        close += left is not None and 1.0 / 1.5 <= left / (times[-1] - times[9]) <= 1.5
    assert known >= 40
    assert close >= 0.9 * known


def test_time_left_is_not_known_where_the_times_are_too_few_or_too_different():
    few, wild = Pace(1), Pace(1)
    for time in (68.0, 70.0, 72.0, 74.0, 76.0):
        few.add("", time)
    assert few.left({"": 10}, 76.0) is None
    for time in (1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 300.0):
        wild.add("", time)
    assert wild.left({"": 10}, 300.0) is None


def test_runs_that_differ_in_more_than_the_seed_are_no_ground_for_each_other():
    one, other, slow = (
        Pace.kind({"planner": {"name": name}, "seed": seed}) for name, seed in (("dwa", 0), ("dwa", 1), ("mpc", 0))
    )
    pace = Pace(1)
    for time in range(10):
        pace.add(one, float(time))
    assert pace.left({one: 0, other: 20}, 9.0) == pytest.approx(20.0)
    assert pace.left({one: 5, slow: 20}, 9.0) is None
    for time in range(1, 10):
        pace.add(slow, 9.0 + 60.0 * time)
    assert pace.left({one: 0, slow: 3}, 549.0 + 20.0) == pytest.approx(160.0)


def test_time_left_does_not_pass_the_next_end_while_an_episode_hangs():
    pace = Pace(1)
    for time in range(10):
        pace.add("", float(time))
    assert [pace.left({"": 5}, 9.0 + waited) for waited in (0.0, 0.5, 500.0)] == pytest.approx([5.0, 4.5, 4.0])
    assert pace.left({"": 0}, 9.0) == 0.0
