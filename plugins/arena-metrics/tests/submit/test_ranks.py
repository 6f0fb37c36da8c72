"""Ranks of the leaderboard and figures of score cards, on successes that are given one by one."""

import math
from pathlib import Path

import numpy as np
import pytest
from statsmodels.stats.proportion import proportion_confint

from arena_core import InputFileError
from arena_metrics.pooling.cells import cells_of
from arena_metrics.pooling.runs import Column, Episode, Run
from arena_submit.cards import ScoreCard, card_text
from arena_submit.leaderboard import _common_standing, _compare_cards, _points_text, _rank_ranges

SUCCESS = Column("success", "", "0/1", "higher", "", False)
SAME = dict.fromkeys(("world", "pedestrian_model", "reaction", "localizer", "timing", "simulator"), "s")
SAME |= {"task": "scenario", "code": "", "seed": 0, "stage": -1, "n_pedestrians": 5}


def cells(planner, robot="jackal", scenario="arena/hall_high", **metrics):
    """Return the cell of a planner's episodes; a metric has a figure for each."""
    run = Run(Path("x"), [], {"config": {"choices": {"scenario": scenario}}})
    base = {**SAME, "planner": planner, "preset": planner, "robot": robot, "config_hash": f"{planner}{robot}{scenario}"}
    return [
        Episode({**base, "episode": i, "scenario": f"{i}/0000", "scenario_hash": scenario, **of}, run)
        for i, of in enumerate(dict(zip(metrics, row, strict=True)) for row in zip(*metrics.values(), strict=True))
    ]


def cards(*successes):
    """Return a card for each planner, whose successes are the first so many of twenty problems."""
    rows = [cells(f"p{k}", success=[float(i < of) for i in range(20)]) for k, of in enumerate(successes)]
    every = cells_of([episode for of in rows for episode in of]).cells
    return [ScoreCard(cell.factors["planner"], "", "", [cell]) for cell in every]


@pytest.mark.parametrize(
    ("successes", "ranks"),
    [
        ([20], [(1, 1)]),
        ([20, 20], [(1, 2), (1, 2)]),
        ([20, 10], [(1, 1), (2, 2)]),
        ([20, 16, 12, 9], [(1, 2), (1, 3), (2, 4), (3, 4)]),
        ([20, 10, 0], [(1, 1), (2, 2), (3, 3)]),
        ([20, 20, 8, 8], [(1, 2), (1, 2), (3, 4), (3, 4)]),
    ],
)
def test_a_rank_is_the_range_that_all_pairs_leave(successes, ranks):
    """20 against 12 successes: McNemar's p is 2 / 2^8, times 5 after Holm .039; 16 against 9: 2 / 2^7, times 4 .063
    exactly, .031 by mid-p; 16 against 12 and 12 against 9 are not told apart.
    """
    assert _rank_ranges(len(successes), _compare_cards(cards(*successes), SUCCESS)) == ranks


def test_a_difference_to_the_first_is_told_in_points_with_its_interval():
    (one,) = _compare_cards(cards(20, 10), SUCCESS).values()
    assert _points_text(one) == f"50 ({100 * one.difference.low:.0f} to {100 * one.difference.high:.0f})"
    (same,) = _compare_cards(cards(20, 20), SUCCESS).values()
    assert _points_text(same).startswith("0 (")


def test_no_pack_is_refused():
    with pytest.raises(InputFileError, match="no pack given"):
        _common_standing([])


def card(*groups):
    return ScoreCard("p", "", "", cells_of([episode for of in groups for episode in of]).cells)


FIGURES = {
    "success": [1.0, 1.0, 0.0, 1.0, math.nan, 1.0],
    "strict_success": [1.0, 0.0, 0.0, 1.0, math.nan, 1.0],
    "collisions": [0.0, 1.0, 4.0, 0.0, math.nan, 0.0],
    "time_to_goal": [10.0, 20.0, 99.0, 30.0, math.nan, 40.0],
    "planning_cpu_mean": [1.0, 2.0, 3.0, 4.0, math.nan, 5.0],
    "planning_cpu_p99": [6.0, 7.0, 8.0, 7.0, math.nan, 7.0],
}


def test_an_error_is_no_success_and_counts():
    found = card(cells("p", **FIGURES)).success()
    assert (found.mean, found.n, found.problems) == (pytest.approx(4.0 / 6.0), 6, 6)
    assert (found.low, found.high) == pytest.approx(proportion_confint(4, 6, method="agresti_coull"))


def test_a_line_has_successes_collisions_and_means_of_what_is_known():
    one = card(cells("p", **FIGURES))
    low, high = (round(100 * end) for end in proportion_confint(4, 6, method="agresti_coull"))
    assert one.row("all", one.cells) == [
        "all",
        "6",
        "67 %",
        f"{low}–{high}",
        "60 %",
        "1.00",
        "25.0 s",
        "3.0 ms",
        "7.0 ms",
    ]


def test_what_is_not_known_is_a_dash():
    one = card(cells("p", success=[0.0] * 4))
    assert one.row("all", one.cells) == ["all", "4", "0 %", *["–"] * 6]


def test_parts_are_of_a_robot_or_of_a_situation_whatever_its_density():
    rows = [
        cells("p", robot, f"arena/{scenario}", success=[share] * 5)
        for robot, scenario, share in (
            ("jackal", "hall_05", 1.0),
            ("jackal", "hall_20", 0.0),
            ("robotino", "blind_corner_high", 1.0),
        )
    ]
    one = card(*rows)
    assert {name: len(of) for name, of in one.parts("robot").items()} == {"jackal": 2, "robotino": 1}
    assert {name: len(of) for name, of in one.parts("situation").items()} == {"blind_corner": 1, "hall": 2}
    assert [row[:3] for row in one.rows()] == [
        ["all", "15", "67 %"],
        ["jackal", "10", "50 %"],
        ["robotino", "5", "100 %"],
        ["blind_corner", "5", "100 %"],
        ["hall", "10", "50 %"],
    ]
    assert card_text(one).splitlines()[0].split()[:3] == ["p", "episodes", "success"]


def test_problems_of_scenarios_are_strata():
    """What differs between scenarios is no luck of the draw: two that are all won and all lost are quite sure."""
    split = card(*(cells("p", scenario=f"arena/{name}", success=[share] * 20) for name, share in (("a", 1), ("b", 0))))
    mixed = card(cells("p", success=[1.0, 0.0] * 20))
    assert split.success().mean == mixed.success().mean == 0.5
    assert split.success().problems == 40
    assert np.isfinite(split.success().high)
