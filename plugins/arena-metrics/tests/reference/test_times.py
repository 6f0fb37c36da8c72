"""Times left to go, all held at once or a few instants at a time."""

from __future__ import annotations

import numpy as np
import pytest

import arena_reference.times as times_module
from arena_reference.body import Moving, Walkers
from arena_reference.times import layer_number, show_until, times_left
from arena_reference.values import STRIDE, Course, goal_values, static_times

SIZE, INSTANTS, REACH = 60, 31, 3


@pytest.fixture(scope="module")
def course() -> Course:
    """Return a hall with a wall and six people who walk through it."""
    random = np.random.default_rng(5)
    walked = random.uniform(0, SIZE, (1, 6, 2)) + np.cumsum(random.normal(0, 2, (INSTANTS, 6, 2)), 0)
    free = np.ones((SIZE, SIZE), np.bool_)
    free[10:50, 30:33] = False
    moving = Moving(Walkers(walked, np.zeros(6), 0.0, 1.0), np.full(6, 6.0), STRIDE)
    return Course(free, goal_values(SIZE, SIZE, 50.5, 30.5, 4.0), np.arange(float(INSTANTS)), moving)


def test_a_window_shows_the_very_times_that_are_held_all_at_once(course: Course, monkeypatch) -> None:
    last = static_times(course.free, course.goal)
    whole = times_left(course, last, REACH)
    monkeypatch.setattr(times_module, "MOST", 0)
    shown = times_left(course, last, REACH)
    assert len(shown.layers) + len(shown.kept) < 0.7 * len(whole.layers)
    for now in np.arange(0.0, INSTANTS + 4.0, 0.7):
        show_until(shown, now + REACH - 1)
        for step in np.append(np.linspace(now, now + REACH - 1, 7), np.inf):
            one, other = shown.layers[layer_number(shown, step)], whole.layers[layer_number(whole, step)]
            assert (one == other).all()
