"""Points by several objectives: fronts, their order, and which one of finalists is chosen."""

import pytest

from arena_tuning.judging import Finalist, Judgement, choose
from arena_tuning.pareto import dominates, front_of, rank
from arena_tuning.problems import Problem
from arena_tuning.racing import Entrant, drop_losers

POINTS = [(1.0, 5.0), (0.0, 0.0), (3.0, 3.0), (5.0, 1.0), (2.0, 2.0), ()]


def test_a_point_dominates_what_is_as_good_by_none_and_worse_by_one():
    assert dominates((1.0, 2.0), (1.0, 1.0))
    assert not dominates((1.0, 1.0), (1.0, 1.0))
    assert not dominates((2.0, 0.0), (1.0, 1.0))


def test_fronts_come_one_after_the_other_and_what_is_worth_nothing_known_last():
    assert front_of(POINTS[:5]) == [0, 2, 3]
    order = rank(POINTS)
    assert sorted(order[:3]) == [0, 2, 3]
    assert order[:2] == [0, 3]  # the ends of the front
    assert order[3:] == [4, 1, 5]


def test_one_objective_is_an_order_by_its_values_and_equal_ones_keep_theirs():
    assert rank([(1.0,), (3.0,), (3.0,), (2.0,)]) == [1, 2, 3, 0]


PROBLEMS = [Problem("validate", 0, number) for number in range(12)]


def finalist(name, gains, scores):
    return Finalist({"name": name}, gains, True, dict(zip(PROBLEMS, scores, strict=True)))


def test_of_what_is_not_worse_by_the_first_objective_the_best_by_the_second_is_chosen():
    even = [(1.0 * (number % 2), 0.0) for number in range(12)]
    odd = [(1.0 * ((number + 1) % 2) - 0.01, 1.0) for number in range(12)]  # hardly worse, and better by the second
    behind = [(first - 0.5, 9.0) for first, _ in even]  # by more than chance
    points = [finalist("even", (0.3, 0.0), even), finalist("odd", (0.29, 1.0), odd)]
    assert choose(points).values == {"name": "odd"}
    assert choose([*points, finalist("behind", (-0.2, 9.0), behind)]).values == {"name": "odd"}
    assert (
        choose([finalist("even", (0.3, 0.0), even), finalist("behind", (-0.2, 9.0), behind)]).values["name"] == "even"
    )
    assert choose([]) is None


def test_who_is_worse_by_one_objective_alone_stays_in_a_race():
    def entrant(*worth):
        return Entrant({}, {problem: (worth[0] + 0.01 * problem.number, worth[1]) for problem in PROBLEMS})

    present = {problem: (0.0, 0.0) for problem in PROBLEMS}
    first, second, both, neither = entrant(1.0, 0.0), entrant(0.0, 1.0), entrant(0.6, 0.6), entrant(-1.0, -1.0)
    assert drop_losers([neither, first, second, both], present) == [first, second]
    assert drop_losers([first, second], present) == [first]


@pytest.mark.parametrize(("gains", "better"), [((0.5, 0.0), True), ((0.5, -0.5), False), ((0.0, 0.0), False)])
def test_better_is_what_gains_by_one_objective_and_loses_by_none(gains, better):
    from arena_core.statistics import compare

    noise = [0.01 * (number % 3) for number in range(12)]
    told = [compare([gain + one for one in noise], noise[::-1]) for gain in gains]
    found = Judgement({}, [], told, {}, {})
    assert found.better == better
    assert found.sentence.startswith("better than" if better else "not better than")
    assert found.sentence.count("; ") == 1
