"""Tasks that adapt move between levels at the ends of blocks, by finished episodes alone."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from arena_core import ConfigurationError
from arena_core.hosting import Staging
from arena_core.records import is_success
from arena_core.runs.folders.schedule import OpenRun, job_rounds
from arena_core.runs.jobs.code_digest import Code
from arena_core.testing import record

CODE = Code("00000000", {})

RULE = Staging(levels=4, start=0, block=20, promote=0.85, fall_back=0.6)


@pytest.mark.parametrize(
    ("stage", "successes", "following"),
    [(0, 20, 1), (0, 17, 1), (0, 16, 0), (1, 16, 1), (1, 13, 1), (1, 12, 0), (1, 0, 0), (0, 0, 0), (3, 20, 3)],
)
def test_a_block_moves_by_one_level_or_stays(stage, successes, following):
    assert RULE.next(stage, [True] * successes + [False] * (20 - successes)) == following


@given(st.integers(1, 9), st.integers(1, 30), st.data())
def test_levels_move_one_at_a_time_and_never_leave_the_curriculum(levels, block, data):
    rule = Staging(levels, 0, block, 0.85, 0.6)
    stage = data.draw(st.integers(0, levels - 1))
    fewer, more = sorted(data.draw(st.tuples(*[st.integers(0, block)] * 2)))
    low, high = (rule.next(stage, [i < n for i in range(block)]) for n in (fewer, more))
    assert max(0, stage - 1) <= low <= high <= min(levels - 1, stage + 1)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"fall_back": 0.85}, r"task\.promote is 0\.85; allowed: above task\.fall_back, 0\.85"),
        ({"start": 4}, r"task\.start is 4; allowed: 0 \.\. 3, the levels of the curriculum"),
    ],
)
def test_a_rule_that_contradicts_itself_is_refused(changes, message):
    figures = {"levels": 4, "start": 0, "block": 20, "promote": 0.85, "fall_back": 0.6}
    with pytest.raises(ConfigurationError, match=message):
        Staging(**{**figures, **changes})


@dataclass
class World:
    """Give rows as an executor does: an episode succeeds unless its (episode, level) is in ``failing``."""

    failing: set[tuple[int, int]] = field(default_factory=set)

    def run(self, run, jobs):
        for job in reversed(jobs):  # rows may come in any order
            ok = (job.episode, job.stage) not in self.failing
            run.rows[job.episode], run.successes[job.episode] = {"episode": job.episode, "stage": job.stage}, ok


def run_of(episodes, staging):
    return OpenRun({"episodes": episodes}, Path("run"), {}, staging, CODE)


def stages(run):
    return [run.rows[i]["stage"] for i in sorted(run.rows)]


def test_a_task_without_levels_has_everything_due_at_once():
    run = run_of(5, None)
    assert [(job.episode, job.stage) for job in run.due()] == [(i, None) for i in range(5)]
    World().run(run, run.due()[1:3])
    assert [job.episode for job in run.due()] == [0, 3, 4]


def test_a_good_planner_rises_and_a_failing_one_falls_back():
    rule = Staging(levels=3, start=1, block=2, promote=0.85, fall_back=0.6)
    good, bad = run_of(9, rule), run_of(9, rule)
    world = World({(i, k) for i in range(9) for k in range(3)})
    for jobs in job_rounds([good]):
        World().run(good, jobs)
    for jobs in job_rounds([bad]):
        world.run(bad, jobs)
    assert stages(good) == [1, 1, 2, 2, 2, 2, 2, 2, 2]
    assert stages(bad) == [1, 1, 0, 0, 0, 0, 0, 0, 0]


def test_runs_advance_side_by_side_and_those_without_levels_at_once():
    rule = Staging(levels=3, start=0, block=2, promote=0.85, fall_back=0.6)
    staged, plain = run_of(3, rule), OpenRun({"episodes": 3}, Path("plain"), {}, None, CODE)
    asked = []
    for jobs in job_rounds([staged, plain]):
        asked.append([(job.folder, job.episode, job.stage) for job in jobs])
        for run in (staged, plain):
            World().run(run, [job for job in jobs if job.folder == str(run.folder)])
    assert asked == [[("run", 0, 0), ("run", 1, 0), *[("plain", i, None) for i in range(3)]], [("run", 2, 1)]]


@given(st.integers(0, 12), st.sets(st.tuples(st.integers(0, 11), st.integers(0, 2))))
def test_a_run_that_was_interrupted_anywhere_goes_the_same_way(finished, failing):
    rule, world = Staging(levels=3, start=1, block=4, promote=0.75, fall_back=0.5), World(failing)
    whole, continued = run_of(12, rule), run_of(12, rule)
    for jobs in job_rounds([whole]):
        world.run(whole, jobs)
    for i in range(finished):
        continued.rows[i], continued.successes[i] = whole.rows[i], whole.successes[i]
    for jobs in job_rounds([continued]):
        assert all(job.episode >= finished for job in jobs)
        world.run(continued, jobs)
    assert continued.rows == whole.rows


def test_an_episode_of_another_level_is_run_again():
    rule = Staging(levels=2, start=0, block=1, promote=0.85, fall_back=0.6)
    run = run_of(2, rule)
    World().run(run, run.due())
    run.rows[1], run.successes[1] = {"episode": 1, "stage": 0}, True
    assert [(job.episode, job.stage) for job in run.due()] == [(1, 1)]


def test_a_job_whose_row_never_comes_is_not_asked_for_again():
    assert len(list(job_rounds([run_of(3, None), run_of(3, RULE)]))) == 1


def test_success_is_an_arrival_in_time_with_fewer_than_two_collisions():
    clean, touched = record(), record(contact=True)
    assert (is_success(clean), is_success(touched), is_success(touched, collisions_allowed=0)) == (True, True, False)
