"""Races: losers are dropped early, the best one wins, and what fails is out."""

import random

import pytest

from arena_tuning.problems import Problem
from arena_tuning.racing import Entrant as Entered
from arena_tuning.racing import cost_of_race, loses, run_race

BLOCKS = [4, 8, 16, 32]
PROBLEMS = [Problem("tune", 0, number) for number in range(BLOCKS[-1])]


def hardness(problem):
    return random.Random(problem.number).uniform(0.0, 1.0)


class Drives:
    """Scores without a simulator: a set of values is worth ``worth``, less how hard the problem is."""

    def __init__(self, noise=0.05, fails=()):
        self.noise, self.fails, self.episodes = noise, fails, 0

    def __call__(self, sets_of_values, problems):
        self.episodes += len(sets_of_values) * len(problems)
        return [{problem: self.score(values, problem) for problem in problems} for values in sets_of_values]

    def score(self, values, problem):
        if values["worth"] in self.fails:
            return None
        draw = random.Random(f"{values['worth']}, {problem.number}")
        return (values["worth"] - hardness(problem) + draw.gauss(0.0, self.noise),)


def race(worths, **settings):
    drives = Drives(**settings)
    (present,) = drives([{"worth": 0.5}], PROBLEMS)
    drives.episodes = 0
    return run_race([{"worth": worth} for worth in worths], BLOCKS, PROBLEMS, present, drives), present, drives


WORTHS = [0.1, 0.9, 0.3, 0.55, 0.2, 0.45, 0.7, 0.6]


def test_the_best_drives_all_problems_and_the_others_are_dropped():
    entrants, present, drives = race(WORTHS)
    (whole,) = (one for one in entrants if len(one.scores) == 32)
    assert whole.values == {"worth": 0.9}
    assert whole.advantage(present) == pytest.approx(0.4, abs=0.05)
    assert drives.episodes <= cost_of_race(8, BLOCKS) == 80  # a full evaluation takes 256


def test_who_is_far_behind_is_dropped_before_its_half():
    entrants, _, drives = race([0.9, *[0.1 + 0.01 * number for number in range(7)]])
    assert sorted(one.blocks for one in entrants)[:4] == [1] * 4
    assert drives.episodes < 80


def test_what_fails_where_the_present_values_do_not_is_out():
    entrants, _, _ = race(WORTHS, fails=[0.9])
    assert [one.values["worth"] for one in entrants if one.failed] == [0.9]
    assert max((len(one.scores), one.values["worth"]) for one in entrants) == (32, 0.7)


def test_all_may_fail():
    entrants, _, drives = race(WORTHS, fails=WORTHS)
    assert all(one.failed for one in entrants)
    assert drives.episodes == 8 * 4


def test_a_problem_that_the_present_values_cannot_drive_counts_for_no_one():
    drives = Drives()
    present = {problem: drives.score({"worth": 0.5}, problem) for problem in PROBLEMS} | {PROBLEMS[0]: None}
    one = Entered({"worth": 0.9}, {problem: None if problem == PROBLEMS[0] else (1.0,) for problem in PROBLEMS})
    assert one.advantage(present) == pytest.approx(1.0 - sum(score[0] for score in present.values() if score) / 31)


def test_a_difference_that_is_chance_drops_no_one():
    same = {problem: ((problem.number % 2) * 1.0,) for problem in PROBLEMS[:8]}
    other = {problem: (((problem.number + 1) % 2) * 1.01,) for problem in PROBLEMS[:8]}
    assert not loses(Entered({}, same), Entered({}, other))
    assert loses(Entered({}, {key: (score[0] - 1.0,) for key, score in same.items()}), Entered({}, same))
    assert not loses(Entered({}, {}), Entered({}, same))
