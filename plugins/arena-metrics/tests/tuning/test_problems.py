"""What planners are tuned on: three sets of problems that no one else drives; budgets and objectives."""

import math
from types import SimpleNamespace

import pytest

from arena_core import ConfigurationError, InputFileError
from arena_core.files import option_files, read_text
from arena_core.hosting import compose, load_registry, to_plain
from arena_tuning.budget import read_budget
from arena_tuning.driving import Cells, Driver, compose_cells
from arena_tuning.journal import Journal
from arena_tuning.objective import DEFAULT, Objective, Objectives
from arena_tuning.problems import Problem, problems_of, read_problem_sets, words_of

ROW = {"strict_success": 1.0, "collisions": 0.0, "time_to_goal": 45.0, "human.cost": 3.0, "cost.people_delay": ""}


@pytest.fixture(scope="module")
def sets():
    return read_problem_sets("v1", load_registry())


def test_sets_are_disjoint_and_no_experiment_training_or_default_has_their_seeds(sets):
    seeds = [sets.seed(purpose) for purpose in ("tune", "validate", "test")]
    assert len(set(seeds)) == 3
    assert all(4_000_000_000 < seed < 2**32 for seed in seeds)  # training draws from 2^32 on
    registry = load_registry()
    texts = [
        read_text(file, 10**6, "a configuration")
        for group in ("experiment", "recipe", "task", "scenario")
        for file in option_files(group, registry.manager).values()
    ]
    assert len(texts) > 20
    assert not any(str(seed) in text for seed in seeds for text in texts)


def test_problems_are_new_worlds_of_several_kinds_with_both_kinds_of_people_and_never_the_warehouse(sets):
    cells = compose_cells(sets, ["planner=dwa", "robot=jackal"])
    configs = [to_plain(config) for config in cells.configs]
    assert all(config["world"]["regenerate"] == 1 for config in configs)
    assert all({"indoor", "outdoor", "rooms"} <= set(config["world"]["members"]) for config in configs)
    assert {config["pedestrians"]["reaction"] for config in configs} == {"ignore", "yield"}
    assert {config["task"]["pedestrians"] for config in configs} == {4, 10}
    assert not any("warehouse" in word for words in (sets.words, *sets.cells) for word in words)


def test_problems_alternate_between_cells(sets):
    problems = problems_of(sets, "tune", 6)
    assert [(one.cell, one.number) for one in problems] == [(0, 0), (1, 0), (2, 0), (3, 0), (0, 1), (1, 1)]
    assert problems_of(sets, "tune", 32)[:6] == problems


def test_words_of_the_user_count_instead_of_those_of_the_problems(sets):
    assert words_of(sets, 0, ["world=lab", "task.pedestrians=7"]) == [
        "task=random",
        "localizer=ground_truth",
        "people=slow",
    ]
    cells = compose_cells(sets, ["planner=dwa", "robot=jackal", "world=lab"])
    assert {to_plain(config)["world"]["name"] for config in cells.configs} == {"lab"}


def test_values_are_put_into_a_cell_with_the_seed_of_a_set(sets):
    cells = compose_cells(sets, ["planner=dwa", "robot=jackal"])
    config = cells.config({"roll_out.sim_time": 2.5}, problems_of(sets, "test", 2)[1])
    assert (config["planner"]["roll_out"]["sim_time"], config["seed"]) == (2.5, sets.test.seed)
    assert config["choices"]["planner"] == "dwa"
    assert to_plain(compose(["planner=dwa", "robot=jackal"]))["planner"]["roll_out"]["sim_time"] == 1.0


@pytest.mark.parametrize(
    ("change", "fault"),
    [
        ({"cells": "[]"}, "cells is empty"),
        ({"blocks": "[4, 4]"}, r"blocks is \[4, 4\]; allowed: numbers that grow"),
        ({"entrants": "1"}, "entrants is 1"),
        ({"validate": "{seed: 1, problems: 2}"}, "another one for each set"),
        ({"test": "{seed: 3, problems: 0}"}, "test.problems is 0"),
        ({"more": "1"}, "has no parameter more"),
    ],
)
def test_a_file_that_describes_no_sets_is_refused(tmp_path, monkeypatch, change, fault):
    content = {
        **{"version": "1", "words": "[]", "cells": "[[]]", "entrants": "4", "blocks": "[1, 2]", "tune": "{seed: 1}"},
        **{"validate": "{seed: 2, problems: 2}", "test": "{seed: 3, problems: 2}"},
        **change,
    }
    (tmp_path / "conf/problems").mkdir(parents=True)
    (tmp_path / "conf/problems/mine.yaml").write_text("".join(f"{key}: {text}\n" for key, text in content.items()))
    monkeypatch.chdir(tmp_path)
    with pytest.raises(InputFileError, match=fault):
        read_problem_sets("mine", load_registry())


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("strict_success", 1.0),
        ("-2 * (collisions + 1) / 4", -0.5),
        ("min(time_to_goal, 30) + max(1, 2)", 32.0),
        ("human.cost", 3.0),
        ("known(impact_speed, 7)", 7.0),
        ("time_limit", 180.0),
        (DEFAULT, 0.95),
    ],
)
def test_an_objective_is_an_expression_of_metrics(text, value):
    names = [*ROW, "impact_speed"]
    assert Objective(text, names).value(ROW, 180.0) == pytest.approx(value)
    assert math.isnan(Objective("impact_speed", names).value({**ROW, "impact_speed": ""}, 180.0))
    assert math.isnan(Objective("1 / collisions", names).value(ROW, 180.0))


def test_success_counts_more_than_collisions_and_these_more_than_time():
    objective = Objective(DEFAULT, list(ROW))

    def worth(**changed):
        return objective.value({**ROW, **changed}, 180.0)

    assert worth(time_to_goal=180.0) > worth(strict_success=0.0, time_to_goal=1.0)
    assert worth(strict_success=0.0, collisions=1.0) > worth(strict_success=0.0, collisions=5.0)
    assert worth(time_to_goal=20.0) > worth()
    assert worth(strict_success=0.0, time_to_goal="") < worth(strict_success=0.0)


def test_what_people_lose_counts_least_and_where_it_is_known():
    objective = Objective(DEFAULT, list(ROW))

    def worth(**changed):
        return objective.value({**ROW, **changed}, 180.0)

    assert worth() == worth(**{"cost.people_delay": 0.0}) == worth(**{"cost.people_delay": -3.0})
    late = {"cost.people_delay": 10.0}  # of each person, which is worth five seconds of the robot
    assert worth(**late) == pytest.approx(worth(time_to_goal=50.0))
    assert worth(**{"cost.people_delay": 1e6}) > worth(collisions=5.0)


def test_what_people_lose_counts_in_the_last_block_and_where_sets_of_values_are_judged(sets, tmp_path):
    cells = Cells([SimpleNamespace(task={"time_limit": 180.0})], [{}], sets)
    row = {**ROW, "outcome": "goal_reached", "cost.people_delay": 10.0}
    journal, problems = Journal(tmp_path), [Problem("tune", 0, 0), Problem("tune", 0, 1), Problem("test", 0, 0)]
    for problem in problems:
        journal.add({}, problem, row)
    driver = Driver(cells, None, journal, Objectives(DEFAULT, [*ROW]), tmp_path)
    assert len({driver.score({}, problem) for problem in problems}) == 1
    driver.late = frozenset(problems[1:2])
    early, late, judged = (driver.score({}, problem)[0] for problem in problems)
    assert (early - late, late) == (pytest.approx(0.1 * 10.0 / 180.0), judged)
    plain = Driver(cells, None, journal, Objectives("[strict_success, -collisions]", [*ROW]), tmp_path)
    assert not any(plain.costs(problem) for problem in problems)


def test_several_objectives_stand_between_brackets():
    found = Objectives("[strict_success, -min(collisions, 2), human.cost]", list(ROW))
    assert found.value({**ROW, "collisions": 4.0}, 180.0) == (1.0, -2.0, 3.0)
    assert [one.text for one in found.parts] == ["strict_success", "-min(collisions, 2)", "human.cost"]
    assert Objectives("strict_success", list(ROW)).value(ROW, 180.0) == (1.0,)


@pytest.mark.parametrize("text", ["[]", "[collisions]", "[collisions, collisions]", "[collisions", "[1,2,3,4,5]"])
def test_other_than_two_to_four_of_them_are_refused(text):
    with pytest.raises(ConfigurationError, match=r"objective is .*; allowed: \[A, B\], two to 4 different expressions"):
        Objectives(text, list(ROW))


@pytest.mark.parametrize(
    "text",
    ["", "1 +", "import os", "__import__('os')", "'a'", "success.real()", "[1]", "min(1)", "a if b else c", "1 ** 2",
     "lambda: 1", "min(a=1, b=2)", "(" * 500, "success" * 500, "True"],
)  # fmt: skip
def test_anything_else_is_no_objective(text):
    with pytest.raises(ConfigurationError, match="objective"):
        Objective(text, list(ROW))


@pytest.mark.parametrize(
    ("text", "episodes", "seconds"),
    [("2000", 2000, math.inf), ("20min", None, 1200.0), ("90s", None, 90.0), ("1.5h", None, 5400.0)],
)
def test_a_budget_is_a_number_of_episodes_or_a_time(text, episodes, seconds):
    found = read_budget(text)
    assert (found.episodes, found.seconds) == (episodes, seconds)
    assert found.allows(2000, 89.0)
    assert not found.allows(2001, 5400.0)


@pytest.mark.parametrize("text", ["0", "-5", "1.5", "1e3", "20 parsecs", "0s", "", "9" * 30])
def test_anything_else_is_no_budget(text):
    with pytest.raises(ConfigurationError, match="budget is"):
        read_budget(text)
