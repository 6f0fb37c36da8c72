"""Which rung is next follows from finished blocks alone; cells end when they are known, at the cap or without room."""

from dataclasses import replace

import numpy as np
import pytest

from arena_core import ConfigurationError
from arena_ladder.allocation import Block, count_blocks, is_finished, next_rungs, rungs_without_room
from arena_ladder.fitting import covariance, fit_counts
from arena_ladder.plan import make_plan

PLAN = make_plan("hall,rooms", "slow", 96, 0.2)


def block(rung, successes, no_room=0):
    return Block(rung, no_room, 8 - no_room, successes, PLAN.rungs[rung])


def first_blocks(*successes):
    return [block(rung, won) for rung, won in zip(PLAN.first, successes, strict=True)]


def test_first_blocks_lie_on_fixed_rungs():
    assert next_rungs(PLAN, {"hall_slow": [], "rooms_slow": [block(0, 8)]}) == {"hall_slow": 0, "rooms_slow": 3}


def test_next_block_lies_where_success_begins_to_fall():
    driven = {"hall_slow": first_blocks(8, 7, 1), "rooms_slow": first_blocks(8, 8, 8)}
    due = next_rungs(PLAN, driven)
    assert PLAN.rungs[due["hall_slow"]] <= 8.0
    assert PLAN.rungs[due["rooms_slow"]] >= PLAN.rungs[due["hall_slow"]]
    assert next_rungs(PLAN, driven) == due


def test_cell_ends_at_the_cap():
    driven = {"hall_slow": first_blocks(8, 7, 1) * 4, "rooms_slow": first_blocks(8, 7, 1)}
    assert list(next_rungs(PLAN, driven)) == ["rooms_slow"]


def test_cell_ends_when_it_is_known():
    sure = [Block(rung, 0, 4000, won, PLAN.rungs[rung]) for rung, won in ((0, 3960), (3, 3700), (5, 2000))]
    driven = {"hall_slow": sure, "rooms_slow": first_blocks(8, 7, 1)}
    assert list(next_rungs(PLAN, driven)) == ["rooms_slow"]


def test_planner_that_surely_fails_without_people_ends_early_and_one_that_may_not_drives_there():
    driven = {
        "hall_slow": [Block(0, 0, 400, 200, 0.0), *first_blocks(4, 3, 1)[1:]],
        "rooms_slow": first_blocks(3, 3, 1),
    }
    assert "hall_slow" not in next_rungs(PLAN, driven)


def test_rung_without_room_and_all_above_are_left_out():
    full = [block(0, 8), block(3, 8), block(5, 0, no_room=8)]
    assert rungs_without_room(PLAN, full) == {5, 6, 7}
    assert PLAN.rungs[next_rungs(PLAN, {"hall_slow": full, "rooms_slow": full})["hall_slow"]] < 12.0


def test_cell_without_room_for_anything_ends():
    nowhere = [block(0, 0, no_room=8), block(3, 0, no_room=8), block(5, 0, no_room=8)]
    assert list(next_rungs(PLAN, {"hall_slow": nowhere, "rooms_slow": first_blocks(8, 7, 1)})) == ["rooms_slow"]


def test_strict_precision_takes_more_episodes():
    driven = {
        name: [Block(rung, 0, 90, won, PLAN.rungs[rung]) for rung, won in ((0, 90), (3, 80), (5, 40))]
        for name in PLAN.names
    }
    counts = count_blocks(PLAN, driven)
    fit = fit_counts(counts)
    spread = covariance(fit, counts)
    assert is_finished(replace(PLAN, precision=1.0), fit, spread, 0)
    assert not is_finished(replace(PLAN, precision=0.01), fit, spread, 0)
    assert np.isfinite(spread).all()


@pytest.mark.parametrize(
    ("words", "said"),
    [(("cellar", None, None, None), "allowed: hall, aisles, rooms"), ((None, None, 8, None), "24 or more")],
)
def test_a_plan_of_what_there_is_not_is_refused(words, said):
    with pytest.raises(ConfigurationError, match=said):
        make_plan(*words)
