"""What a tuning leaves, from a search whose episodes were scored without a simulator."""

import json
import math
from dataclasses import replace
from pathlib import Path

import pytest
import yaml

from arena_core import ConfigurationError
from arena_core.hosting import SearchRange, SearchSpace
from arena_tuning.preset import check_free, preset_path, write_preset
from arena_tuning.problems import JudgingSet, Problem, ProblemSets, SearchSet, problems_of
from arena_tuning.sampling import distributions_of, importances, make_sampler, plain_values
from arena_tuning.study import Plan, order_problems, run_search

SPACE = SearchSpace(
    {
        "weights.path": SearchRange("it follows", "1/m", low=0.1, high=10.0, log=True),
        "samples": SearchRange("it sees more", "-", low=1, high=9, integer=True),
        "form": SearchRange("it differs", "-", choices=["one", "two"]),
    }
)
SETS = ProblemSets(1, [], [[]], 8, [2, 4], SearchSet(1), JudgingSet(2, 4), JudgingSet(3, 4))
PRESENT = {"form": "one", "samples": 3, "weights.path": 1.0}


class Scored:
    """Drives without a simulator: best at weights.path 4, and what has three samples fails."""

    def __init__(self, fails=()):
        self.fails, self.driven = fails, []

    def drive(self, sets_of_values, problems):
        self.driven += sets_of_values
        return [{problem: self.score(values, problem) for problem in problems} for values in sets_of_values]

    def score(self, values, problem):
        off = math.log(values["weights.path"] / 4.0)
        return None if values["samples"] in self.fails else (-(off**2) - 0.1 * problem.number,)

    def errors(self, sets_of_values, problems):
        return ["it broke"]


def plan(budget, sampler="tpe", seed=0):
    from arena_tuning.budget import read_budget

    return Plan(SPACE, sampler, seed, read_budget(budget), SETS)


@pytest.mark.slow
@pytest.mark.parametrize("sampler", ["tpe", "cmaes"])
def test_a_search_is_the_same_for_one_seed_and_finds_what_is_better(tmp_path, sampler):
    found, driven = [], []
    for number in (0, 1):
        (folder := tmp_path / str(number)).mkdir()
        drives = Scored()
        lines = []
        found.append(run_search(plan("76", sampler), PRESENT, drives, folder, lines.append))
        driven.append(drives.driven)
    assert driven[0] == driven[1]
    assert found[0].curve == found[1].curve
    assert lines[-1].startswith("race 3: 76 of 76 episodes, best +")
    best = found[0].whole[0]
    assert abs(math.log(best.values["weights.path"] / 4.0)) < abs(math.log(1.0 / 4.0))
    other = Scored()
    run_search(plan("28", sampler, seed=1), PRESENT, other, tmp_path, lines.append)
    assert other.driven != driven[0][: len(other.driven)]


class TwiceScored(Scored):
    """Likewise for two objectives: best at weights.path 4 by the first, at 1 by the second."""

    def score(self, values, problem):
        return tuple(-(math.log(values["weights.path"] / best) ** 2) - 0.1 * problem.number for best in (4.0, 1.0))


@pytest.mark.slow
@pytest.mark.parametrize("sampler", ["tpe", "nsga"])
def test_a_search_for_two_objectives_is_the_same_for_one_seed_and_finds_a_front(tmp_path, sampler):
    found = []
    for number in (0, 1):
        (folder := tmp_path / str(number)).mkdir()
        drives = TwiceScored()
        search = run_search(replace(plan("100", sampler), objectives=2), PRESENT, drives, folder, lambda line: None)
        found.append((drives.driven, [trial.values for trial in search.study.best_trials]))
    assert found[0] == found[1]
    assert search.races == 4
    front = [one for one in search.whole if one.advantages(search.scores)[0] > 0.0]
    weights = [one.values["weights.path"] for one in search.whole[: len(front)]]
    assert sum(0.9 < weight < 4.5 for weight in weights) >= 0.8 * len(weights)  # what is best by either, and between
    assert importances(search.study, 0, 1) != importances(search.study, 0)


def test_a_search_in_which_all_others_fail_ends_in_one_line(tmp_path):
    fails = [number for number in range(1, 10) if number != PRESENT["samples"]]
    drives = Scored(fails)
    search = run_search(plan("52"), PRESENT, drives, tmp_path, lambda line: None)
    assert sum(one.failed for one in search.entrants) > 8  # those with three samples do not
    drives.score = lambda values, problem: (0.0,) if values == PRESENT else None
    with pytest.raises(ConfigurationError, match="an episode of every trial ended with an error, such as: it broke"):
        run_search(plan("52"), PRESENT, drives, tmp_path, lambda line: None)


def test_present_values_that_always_fail_end_it_at_once(tmp_path):
    with pytest.raises(ConfigurationError, match="the planner as it is ends every episode with an error: it broke"):
        run_search(plan("52"), PRESENT, Scored([3]), tmp_path, lambda line: None)


def test_races_begin_where_the_present_values_are_worst():
    problems = problems_of(SETS, "tune", 5)
    worths = [(0.5, 1.0), None, (0.5, 0.0), (0.1, 9.0), (0.9, 0.0)]
    ordered = order_problems(problems, dict(zip(problems, worths, strict=True)))
    assert [one.number for one in ordered] == [3, 2, 0, 4, 1]  # where they fail, nothing can be compared


def test_values_are_kept_with_four_digits_inside_their_ranges():
    assert plain_values({"b": 0.123456, "a": 3}) == {"a": 3, "b": 0.1235}
    distributions = distributions_of(SPACE)
    assert list(distributions) == sorted(SPACE.parameters)
    assert distributions["samples"].log is False
    assert make_sampler("cmaes", 0, 8) is not make_sampler("cmaes", 0, 8)


CARD = {
    **{"planner": "teb", "preset": "teb", "robot": "jackal", "settings": "ab", "fixed": {"limits.vx_max": 0.5}},
    "values": {"form": "two", "samples": 4, "weights.path": 3.5},
}


def test_a_preset_is_a_file_of_its_planner_with_a_card_beside_it(tmp_path):
    path = preset_path(tmp_path / "conf/planner", "teb_mine")
    write_preset(path, CARD, SPACE)
    assert yaml.safe_load(path.read_text()) == {
        **{"defaults": ["teb", "_self_"], "name": "teb", "limits": {"vx_max": 0.5}},
        **{"form": "two", "samples": 4, "weights": {"path": 3.5}},
    }
    assert "path: 3.5  # [1/m] it follows (tuned)" in path.read_text()
    card = json.loads(path.with_name("teb_mine.card.json").read_text())
    assert (card["format"], card["values"]) == ("arena-tuning", CARD["values"])


def test_a_preset_is_written_over_by_its_own_tuning_alone(tmp_path):
    path = preset_path(tmp_path / "planner", "teb_mine")
    check_free(path, "ab")
    write_preset(path, CARD, SPACE)
    check_free(path, "ab")
    for change in (lambda: None, lambda: Path(path.with_name("teb_mine.card.json")).unlink()):
        change()
        with pytest.raises(ConfigurationError, match=r"teb_mine.yaml is there already; allowed: preset=NAME"):
            check_free(path, "cd")


def test_problems_are_told_apart():
    assert Problem("tune", 0, 1) != Problem("test", 0, 1)
