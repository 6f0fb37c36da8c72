"""Intervals of breaking densities over maps, on simulated ladders of known truth, and what is said beyond the rungs."""

import math
from dataclasses import replace

import numpy as np
import pytest

from arena_ladder.allocation import Block, next_rungs
from arena_ladder.breaking import Breaking, Drive, find_breaking, make_sample
from arena_ladder.comparing import PairFinding, compare_ladders, summary_sentences
from arena_ladder.plan import make_plan
from arena_ladder.results import Ladder, make_curve

PLAN = make_plan("hall,rooms", "slow", 48, 0.2)


def success(density, half, lapse=0.01, slope=2.5):
    return (1.0 - lapse) / (1.0 + (density / half) ** slope)


def drive_ladder(half, seed):
    """Return a simulated ladder's episodes and blocks; maps bear more or fewer people than others."""
    random, shifts = np.random.default_rng(seed), np.random.default_rng(99).normal(0.0, 0.3, (2, 20, PLAN.block))
    driven, drives = {name: [] for name in PLAN.names}, []
    while due := next_rungs(PLAN, driven):
        for name, rung in due.items():
            number, cell = len(driven[name]), PLAN.names.index(name)
            own = half * np.exp(shifts[cell, number])
            won = random.random(PLAN.block) < success(PLAN.rungs[rung], own)
            world = name.partition("_")[0]
            drives += [
                Drive(name, rung, PLAN.rungs[rung], (world, PLAN.seed + number, i), bool(w), bool(w))
                for i, w in enumerate(won)
            ]
            driven[name].append(Block(rung, 0, PLAN.block, int(won.sum()), PLAN.rungs[rung]))
    return drives, driven


def ladder(planner, half, seed):
    drives, blocks = drive_ladder(half, seed)
    curve = make_curve(PLAN, drives)
    return Ladder(planner, "jackal", PLAN, drives, blocks, curve, curve)


@pytest.fixture(scope="module")
def ladders():
    return [ladder("weak", 4.0, 1), ladder("strong", 16.0, 2), ladder("alike", 16.0, 3)]


def test_simulated_ladders_of_known_truth_lie_in_their_intervals(ladders):
    for one, half in zip(ladders, (4.0, 16.0, 16.0), strict=True):
        for share in (0.9, 0.5):
            true = half * ((0.99 / share) - 1.0) ** (1.0 / 2.5)
            assert all(found.low <= min(true, 24.0) <= found.high for found in one.success.breaking[share])


def test_same_episodes_have_the_same_intervals(ladders):
    again = make_curve(PLAN, ladders[0].drives)
    assert again.breaking == ladders[0].success.breaking


def test_sentences_name_the_better_planner_and_who_cannot_be_told_apart(ladders):
    weak_strong, _, alike = compare_ladders(ladders)
    assert weak_strong.text().startswith("strong bears ")
    assert (
        "times as many people as weak before its success falls to .9; " in weak_strong.text()
        or " as weak " in weak_strong.text()
    )
    assert weak_strong.high < 1.0
    assert "cannot be told apart" in alike.text()
    assert alike.maps >= 24


def test_a_summary_says_whom_each_surely_outdoes():
    pairs = [
        PairFinding("weak", "strong", 0.25, 0.2, 0.5, 24, 2),
        PairFinding("strong", "poor", 8.0, 4.0, 16.0, 24, 2),
        PairFinding("weak", "poor", 2.0, 0.9, 4.0, 24, 2),
        PairFinding("strong", "unmet", 1.0, 1.0, 1.0, 2, 2),
    ]
    assert summary_sentences(pairs) == ["strong surely bears more people than weak, poor: 4.0 to 8.0 times as many."]


def test_planners_on_other_robots_and_on_few_common_maps_are_not_compared(ladders):
    assert compare_ladders([ladders[0], replace(ladders[1], robot="robotino")]) == []
    few = replace(ladders[1], drives=ladders[1].drives[:3])
    assert "fewer than 5 nothing can be said" in compare_ladders([ladders[0], few])[0].text()


def test_what_lies_beyond_the_ladder_is_said():
    assert Breaking(24.0, 24.0, 24.0, 1.0, 24.0).text() == "above 24"
    assert Breaking(1.0, 1.0, 1.0, 1.0, 24.0).text() == "below 1"
    assert Breaking(6.0, 1.0, 24.0, 1.0, 24.0).text() == "6.0 (below 1 – above 24)"
    assert Breaking(6.0, 5.0, 7.2, 1.0, 24.0).precise == pytest.approx(0.2)


def test_cell_without_a_failure_may_bear_more_than_the_ladder_has():
    drives = [
        Drive(name, rung, PLAN.rungs[rung], (name, rung, i), success=True, strict=True)
        for name in PLAN.names
        for rung in PLAN.first
        for i in range(8)
    ]
    _, found = find_breaking(PLAN, make_sample(PLAN, drives), (0.9,))
    assert [one.high for one in found[0.9]] == [24.0, 24.0], "at the end to the last digit, which is called above 24"
    assert all(one.low > 4.0 for one in found[0.9]), "nobody fails in 8 of 8 with 12 people whom 4 break"


def test_episodes_without_room_count_for_nothing():
    drives, _ = drive_ladder(8.0, 4)
    nowhere = [replace(drives[0], no_room=True, success=False, world_map=("hall", 1, 1))] * 30
    _, found = find_breaking(PLAN, make_sample(PLAN, [*drives, *nowhere]), (0.9,))
    _, without = find_breaking(PLAN, make_sample(PLAN, drives), (0.9,))
    assert found == without
    assert all(math.isfinite(one.value) for one in found[0.9])
