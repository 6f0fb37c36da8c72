"""Every kind of contrast and every ranking rule, on episodes whose figures are given one by one."""

import math
from pathlib import Path

import numpy as np
import pytest

from arena_core.statistics import compare
from arena_metrics.claims.claim_verdicts import claims_table, finding_text, judge_claims
from arena_metrics.claims.contrasts import contrast_findings
from arena_metrics.claims.model import Claim, Claims, Contrast
from arena_metrics.pooling.cells import cells_of
from arena_metrics.pooling.runs import Column, Episode, Run
from arena_metrics.tables.ranking import CommonConditions, common_conditions, planner_ranks

LENGTH = Column("length", "", "m", "lower", "", False)
SPEED = Column("speed", "", "m/s", "higher", "", False)
SUCCESS = Column("success", "", "0/1", "higher", "", False)
COLUMNS = {column.name: column for column in (LENGTH, SPEED, SUCCESS)}
SAME = dict.fromkeys(("world", "pedestrian_model", "reaction", "localizer", "timing", "simulator"), "s")
SAME |= {"task": "random", "code": "", "seed": 0, "stage": -1, "robot": "jackal"}


def episodes(planner, figures, metric="length", people=5):
    """Return an episode of each figure, each of another problem."""
    base = {**SAME, "planner": planner, "preset": planner, "config_hash": f"{planner}{people}", "n_pedestrians": people}
    run = Run(Path("x"), [], {"config": {}})
    return [
        Episode({**base, "episode": i, "scenario": f"random/{i:04d}", "success": 1.0, metric: float(figure)}, run)
        for i, figure in enumerate(figures)
    ]


def cells(*groups):
    return cells_of([episode for group in groups for episode in group])


def finding(expected, ours, theirs=None, margin=0.0, metric="length"):
    """Return what is found of planner a, alone or against planner b."""
    groups = [episodes("a", ours, metric), *([] if theirs is None else [episodes("b", theirs, metric)])]
    than = None if theirs is None else {"planner": "b"}
    contrast = Contrast(metric, {"planner": "a"}, expected, than, margin=margin)
    (found,) = contrast_findings(cells(*groups), COLUMNS, [contrast])
    return found


BASE = np.array([4.0, 5.0, 6.0, 7.0, 8.0, 9.0])  # of problems that are as hard for both


@pytest.mark.parametrize(
    ("expected", "difference", "margin", "state"),
    [
        ("lower", -0.25, 0.0, "holds"),
        ("lower", 0.25, 0.0, "does not hold"),
        ("lower", -0.25, 0.125, "holds"),
        ("lower", -0.25, 0.5, "does not hold"),
        ("lower", -0.25, 0.25, "cannot be decided"),
        ("higher", 0.25, 0.0, "holds"),
        ("higher", -0.25, 0.0, "does not hold"),
        ("higher", 0.25, 0.125, "holds"),
        ("higher", 0.25, 0.5, "does not hold"),
        ("higher", 0.25, 0.25, "cannot be decided"),
        ("not_higher", 0.25, 0.5, "holds"),
        ("not_higher", 0.25, 0.125, "does not hold"),
        ("not_higher", -0.25, 0.125, "holds"),
        ("not_higher", 0.25, 0.25, "cannot be decided"),
        ("not_lower", -0.25, 0.5, "holds"),
        ("not_lower", -0.25, 0.125, "does not hold"),
        ("not_lower", 0.25, 0.125, "holds"),
        ("not_lower", -0.25, 0.25, "cannot be decided"),
        ("alike", 0.25, 0.5, "holds"),
        ("alike", -0.25, 0.5, "holds"),
        ("alike", 0.25, 0.125, "does not hold"),
        ("alike", -0.25, 0.125, "does not hold"),
        ("alike", 0.25, 0.25, "cannot be decided"),
        ("alike", -0.25, 0.25, "cannot be decided"),
    ],
)
def test_a_contrast_holds_on_its_side_of_the_margin(expected, difference, margin, state):
    found = finding(expected, BASE + difference, BASE, margin)
    assert found.state == state
    assert (found.estimate.mean, found.estimate.low, found.estimate.high) == (difference,) * 3, "whatever the margin"


@pytest.mark.parametrize(
    ("expected", "value", "state"),
    [
        ("at_most", 0.25, "holds"),
        ("at_most", 0.5, "holds"),
        ("at_most", 0.75, "does not hold"),
        ("at_least", 0.75, "holds"),
        ("at_least", 0.5, "holds"),
        ("at_least", 0.25, "does not hold"),
    ],
)
def test_a_bound_counts_itself(expected, value, state):
    found = finding(expected, [value] * 6, margin=0.5, metric="speed")
    assert (found.state, found.estimate.mean) == (state, value)


def test_differences_are_written_with_their_sign_and_means_without():
    assert ": +0.25 [+0.25, +0.25], p" in finding_text(finding("lower", BASE + 0.25, BASE))
    assert finding_text(finding("at_most", [0.25] * 6, margin=0.5, metric="speed")).endswith(
        ": at most 0.5: 0.25 [0.25, 0.25], holds"
    )
    assert finding_text(finding("lower", [], BASE)).endswith(": not tested")


@pytest.mark.parametrize("expected", ["at_most", "at_least"])
def test_a_bound_within_the_interval_decides_nothing(expected):
    assert finding(expected, [0.0, 1.0] * 4, margin=0.5, metric="speed").state == "cannot be decided"


@pytest.mark.parametrize("expected", ["lower", "higher", "alike", "not_lower", "not_higher"])
def test_four_problems_decide_nothing(expected):
    assert finding(expected, BASE[:4] - 5.0, BASE[:4], 0.5).state == "cannot be decided"
    assert finding("at_most", BASE[:4], margin=100.0).state == "cannot be decided"


NOISE = np.array([0.3, -0.2, 0.5, 0.1, -0.4, 0.2])


def test_p_and_interval_with_a_margin_are_those_of_the_shifted_pairs():
    found, shifted = finding("not_lower", BASE + NOISE, BASE, 0.25), compare(BASE + NOISE + 0.25, BASE)
    assert found.p == pytest.approx(shifted.p)
    assert found.estimate.low == pytest.approx(shifted.difference.low - 0.25)
    assert found.estimate.high == pytest.approx(shifted.difference.high - 0.25)


def test_more_problems_are_those_that_make_the_difference_2_8_standard_errors():
    """Cohen 1988, section 2.4: 1.96 of 5 % and 0.84 of 80 % power; the error is the interval's half over 1.96."""
    found = finding("lower", BASE + NOISE, BASE)
    error = (found.estimate.high - found.estimate.low) / 3.92
    assert found.state == "cannot be decided"
    assert found.more == pytest.approx(((2.8 * error / NOISE.mean()) ** 2 - 1.0) * 6.0)


def test_more_problems_with_a_margin_are_counted_from_the_margin():
    found = finding("not_lower", BASE + NOISE, BASE, 0.25)
    error = (found.estimate.high - found.estimate.low) / 3.92
    assert found.more == pytest.approx(max(0.0, ((2.8 * error / (NOISE.mean() + 0.25)) ** 2 - 1.0) * 6.0))
    bound = finding("at_most", BASE, margin=6.0)
    error = (bound.estimate.high - bound.estimate.low) / 3.92
    assert bound.estimate.mean == 6.5
    assert bound.more == pytest.approx(((2.8 * error / 0.5) ** 2 - 1.0) * 6.0)


def test_no_number_of_problems_shows_what_is_not_there_and_none_is_needed_for_what_is_sure():
    assert finding("lower", BASE + NOISE - NOISE.mean(), BASE).more == math.inf
    assert finding("lower", BASE - 1.0, BASE).more == 0.0
    assert math.isnan(finding("lower", BASE[:4] - 5.0, BASE[:4]).more)
    assert math.isnan(finding("lower", [], BASE).more)


def test_a_change_is_how_much_more_one_side_grows():
    groups = [episodes("a", BASE, people=5), episodes("a", BASE + 2.0, people=10)]
    groups += [episodes("b", BASE, people=5), episodes("b", BASE + 0.5, people=10)]
    contrast = Contrast("length", {"planner": "a"}, "higher", {"planner": "b"}, change={"people": [5, 10]}, margin=1.0)
    (found,) = contrast_findings(cells(*groups), COLUMNS, [contrast])
    assert (found.estimate.mean, found.state) == (1.5, "holds")


@pytest.mark.parametrize(("margin", "method"), [(0.0, "Bonett-Price"), (0.1, "studentised bootstrap")])
def test_proportions_with_a_margin_are_figures(margin, method):
    found = finding("not_lower", [1, 1, 0, 1, 0, 1], [1, 0, 1, 1, 0, 1], margin, "success")
    assert found.estimate.method == method


CLAIM = [Contrast("length", {"planner": "a"}, "lower", {"planner": name}) for name in "bcd"]


def test_contrasts_of_a_claim_are_one_family_after_holm():
    groups = [episodes("a", BASE), episodes("b", BASE + 1.0), episodes("c", BASE - NOISE), episodes("d", BASE + NOISE)]
    found = contrast_findings(cells(*groups), COLUMNS, CLAIM)
    alone = [compare(BASE, of).p for of in (BASE + 1.0, BASE - NOISE, BASE + NOISE)]
    assert alone[0] < min(alone[1:])
    assert found[0].p == pytest.approx(3.0 * alone[0])
    assert [one.state for one in found] == ["cannot be decided"] * 3, "0.094: alone it would hold"


def test_a_claim_needs_as_many_problems_as_the_open_contrast_that_needs_most():
    groups = [
        episodes("a", BASE),
        episodes("b", BASE + 1.0),
        episodes("c", BASE + NOISE),
        episodes("d", BASE + 3 * NOISE - 0.1),
    ]
    claims = Claims("us", {"1": Claim("says", CLAIM)})
    (judged,) = judge_claims(cells(*groups), list(COLUMNS.values()), claims)
    assert [one.state for one in judged.findings] == ["cannot be decided"] * 3
    assert judged.more == max(one.more for one in judged.findings) == judged.findings[2].more
    digits = 10 ** (len(str(int(judged.more))) - 2)
    text = f"cannot be decided (about {math.ceil(judged.more / digits) * digits:,} more problems a cell would)"
    assert claims_table([judged], "us").rows[0][1] == text


@pytest.mark.parametrize(
    ("number", "text"), [(0.3, 1), (7.2, 8), (10.0, 10), (12.1, 13), (99.5, 100), (123.4, 130), (1234.0, 1300)]
)
def test_numbers_of_problems_have_two_digits_and_are_rounded_up(number, text):
    from arena_metrics.claims.claim_verdicts import _round_digits

    assert _round_digits(number) == text


def ranked(column, **figures):
    """Return the best and the worst rank of each planner."""
    found = common_conditions(cells(*(episodes(name, of, column.name) for name, of in figures.items())))
    return planner_ranks(found, column)


EIGHT = np.arange(8.0)
SHAKEN = EIGHT + np.array([1.0, -1.0, 0.5, -0.5, 0.2, -0.2, 0.9, -0.9])


def test_ranks_go_by_whether_lower_or_higher_is_better():
    figures = {"x": EIGHT, "y": EIGHT + 1.0, "z": EIGHT + 3.0}
    assert ranked(LENGTH, **figures) == {"x": (1, 1), "y": (2, 2), "z": (3, 3)}
    assert ranked(SPEED, **figures) == {"x": (3, 3), "y": (2, 2), "z": (1, 1)}


def test_a_rank_is_after_all_that_won_and_before_all_that_lost():
    found = ranked(LENGTH, x=EIGHT, y=SHAKEN, z=EIGHT + 9.0)
    assert found == {"x": (1, 2), "y": (1, 2), "z": (3, 3)}
    assert ranked(SPEED, x=EIGHT, y=SHAKEN, z=EIGHT + 9.0) == {"x": (2, 3), "y": (2, 3), "z": (1, 1)}


def test_ranks_are_over_the_conditions_that_all_faced_alone():
    groups = [episodes(name, EIGHT + i) for i, name in enumerate("xyz")]
    groups += [episodes(name, EIGHT - 9.0 * i, people=10) for i, name in enumerate("xy")]
    found = common_conditions(cells(*groups))
    assert isinstance(found, CommonConditions)
    assert found.conditions == 1
    assert planner_ranks(found, LENGTH) == {"x": (1, 1), "y": (2, 2), "z": (3, 3)}


@pytest.mark.parametrize(("planners", "ranked"), [(1, False), (2, True), (12, True), (13, False)])
def test_two_to_twelve_planners_are_ranked(planners, ranked):
    groups = [episodes(f"p{i}", EIGHT) for i in range(planners)]
    assert (common_conditions(cells(*groups)) is not None) == ranked
