"""Times of parts are told apart, whoever calls whom; a clock that ticks as told stands for the real one."""

import pytest

from arena_core.base import stopwatch
from arena_core.base.stopwatch import Duration, Stopwatch


@pytest.fixture
def tick(monkeypatch):
    """Return a function that lets the clocks go on."""
    time = [0.0, 0.0]
    monkeypatch.setattr(stopwatch, "_current_time", lambda: Duration(*time))

    def tick(wall, cpu=0.0):
        time[:] = time[0] + wall, time[1] + cpu

    return tick


def test_a_part_that_another_calls_counts_once(tick):
    watch = Stopwatch()

    def inner():
        tick(2.0, 8.0)
        return "seen"

    def outer():
        tick(1.0, 1.0)
        found = watch.timed("inner", inner)
        tick(4.0, 2.0)
        return found

    assert watch.timed("outer", outer) == "seen"
    assert watch.spent == {"inner": Duration(2.0, 8.0), "outer": Duration(5.0, 3.0)}


def test_parts_that_come_again_add_up_and_sum_to_the_whole(tick):
    watch = Stopwatch()

    def three():
        for _ in range(3):
            tick(1.0)
            watch.timed("part", lambda: watch.timed("deeper", lambda: tick(0.25)) or tick(0.5))

    watch.timed("whole", three)
    assert {name: spent.wall for name, spent in watch.spent.items()} == {"deeper": 0.75, "part": 1.5, "whole": 3.0}


def test_what_fails_is_timed_too(tick):
    watch = Stopwatch()

    def fails():
        tick(3.0)
        raise ValueError

    def outer():
        with pytest.raises(ValueError):  # noqa: PT011 (ours)
            watch.timed("fails", fails)
        tick(1.0)

    watch.timed("outer", outer)
    assert {name: spent.wall for name, spent in watch.spent.items()} == {"fails": 3.0, "outer": 1.0}
