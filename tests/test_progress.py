"""What a run says while it runs, where there is no terminal."""

from pathlib import Path

import pytest

from arena_core import Finished, Job
from arena_core.runs import progress
from arena_core.runs.code_digest import Code
from arena_core.runs.progress import LINE_EVERY, Progress
from arena_core.runs.schedule import OpenRun


@pytest.fixture
def clock(monkeypatch):
    """Give the list whose last entry is the time."""
    times = [100.0]
    monkeypatch.setattr(progress, "monotonic", lambda: times[-1])
    return times


def finished(episode, succeeded=True):
    return Finished(Job({}, "run", episode), {"episode": episode}, succeeded)


def test_a_line_says_how_far_it_is_every_now_and_then(clock, capsys):
    run = OpenRun({"episodes": 40}, Path("run"), {}, None, Code("", {}), rows={i: {} for i in range(10)})
    with Progress([run]) as said:
        said.add(finished(10))
        assert capsys.readouterr().err == ""
        clock.append(clock[-1] + LINE_EVERY + 1.0)
        said.add(finished(11, succeeded=False))
        assert capsys.readouterr().err == "arena: 12 of 40 episodes, 1 of 2 succeeded, 0.065/s, 434 s left\n"
        said.add(finished(12))
        assert capsys.readouterr().err == ""
