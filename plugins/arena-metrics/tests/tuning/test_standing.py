"""How a tuning stands, read from what a search without a simulator has left on disk."""

import json
import math
import sqlite3

import pytest

from arena_core import InputFileError
from arena_core.hosting import SearchRange, SearchSpace
from arena_tuning.budget import read_budget
from arena_tuning.folder import open_folder
from arena_tuning.problems import JudgingSet, ProblemSets, SearchSet
from arena_tuning.standing import read_standing
from arena_tuning.study import Plan, run_search

SPACE = SearchSpace(
    {
        "weight": SearchRange("it follows", "1/m", low=0.1, high=10.0, log=True),
        "samples": SearchRange("it sees more", "-", low=1, high=9, integer=True),
        "form": SearchRange("it differs", "-", choices=["one", "two"]),
    }
)
SETS = ProblemSets(1, [], [[]], 8, [2, 4], SearchSet(1), JudgingSet(2, 4), JudgingSet(3, 4))
PRESENT = {"form": "one", "samples": 3, "weight": 1.0}
SETTINGS = {
    **{"planner": "teb", "preset": "teb", "robot": "jackal", "words": [], "sampler": "tpe", "seed": 0},
    **{"objective": "success", "present": PRESENT},
    "problems": {"name": "tiny", "entrants": 8, "blocks": [2, 4]},
}


class Scored:
    """Drives without a simulator: best at weight 4, and what has seven samples or more fails."""

    def drive(self, sets_of_values, problems):
        return [{problem: self.score(values, problem) for problem in problems} for values in sets_of_values]

    def score(self, values, problem):
        return None if values["samples"] >= 7 else (-(math.log(values["weight"] / 4.0) ** 2) - 0.1 * problem.number,)


@pytest.fixture(scope="module")
def tuning(tmp_path_factory):
    """Return the folder of a search of ten races, and what it came to."""
    folder = tmp_path_factory.mktemp("tuning")
    open_folder(folder, SETTINGS, resume=False)
    plan = Plan(SPACE, "tpe", 0, read_budget("244"), SETS)
    return folder, run_search(plan, PRESENT, Scored(), folder, lambda line: None)


def test_a_running_tuning_is_read_as_it_stands_in_the_search(tuning):
    folder, search = tuning
    found = read_standing(folder)
    assert found["curve"] == search.curve
    assert (found["races"], found["finished"], found["verdict"]) == (search.races, False, None)
    ended = {"failed": lambda one: one.failed, "whole": lambda one: one in search.whole}
    for name, holds in ended.items():
        assert [one["ended"] == name for one in found["sets"]] == [holds(one) for one in search.entrants]
    assert [one["values"] for one in found["sets"]] == [one.values for one in search.entrants]
    assert [one["episodes"] for one in found["sets"]] == [len(one.scores) for one in search.entrants]
    best = search.whole[0]
    advantage = best.advantage(search.scores)
    assert found["best"] == {"values": best.values, "advantage": advantage, "winner": False}


def test_parameters_have_their_range_their_values_and_their_importance(tuning):
    rows = {row["key"]: row for row in read_standing(tuning[0])["parameters"]}
    assert list(rows) == sorted(SPACE.parameters)
    assert {key: rows["weight"][key] for key in ("low", "high", "log", "present")} == {
        **{"low": 0.1, "high": 10.0},
        **{"log": True, "present": 1.0},
    }
    assert rows["form"]["choices"] == ["one", "two"]
    assert max(rows.values(), key=lambda row: row["importance"])["key"] == "weight"
    assert sum(row["importance"] for row in rows.values()) == pytest.approx(1.0)


def test_a_finished_tuning_is_what_its_card_says(tuning, tmp_path):
    card = {"curve": [[4, 0.0], [28, 0.5]], "values": {"weight": 3.5}, "verdict": "better", "better": True, "space": {}}
    (tmp_path / "settings.json").write_text(json.dumps(SETTINGS))
    (tmp_path / "study.db").write_bytes((tuning[0] / "study.db").read_bytes())
    (tmp_path / "card.json").write_text(json.dumps({**card, "importance": {"weight": 0.9}}))
    found = read_standing(tmp_path)
    assert (found["finished"], found["verdict"], found["curve"]) == (True, "better", [[4, 0.0], [28, 0.5]])
    assert found["best"]["winner"]
    assert next(row for row in found["parameters"] if row["key"] == "weight")["importance"] == 0.9


def test_a_tuning_that_has_just_begun_has_no_sets_and_half_a_line_is_no_episode(tmp_path):
    (tmp_path / "settings.json").write_text(json.dumps(SETTINGS))
    line = json.dumps({"key": "ab", "values": {}, "problem": ["tune", 0, 0], "row": {}})
    other = line.replace("tune", "test")
    (tmp_path / "episodes.jsonl").write_text(f"{line}\n{line}\n{other}\n{line[:-4]}")
    found = read_standing(tmp_path)
    assert found["episodes"] == {"tune": 2, "validate": 0, "test": 1}
    assert (found["sets"], found["best"]["values"]) == ((), {})
    assert found["curve"] == [(4, 0.0)]


@pytest.mark.parametrize(
    ("name", "content", "told"),
    [
        ("settings.json", b"[]", "settings.json: holds no mapping"),
        ("settings.json", b'{"planner": "teb"}', "settings.json: holds no tuning"),
        ("settings.json", b'{"planner": "teb", "problems": {}, "present": {}}', "holds no tuning (KeyError('preset'))"),
        ("study.db", b"SQLite", "study.db: cannot be read (file is not a database)"),
        ("card.json", b'{"space": ', "card.json: is no JSON"),
    ],
)
def test_what_is_no_tuning_is_told_in_one_line(tmp_path, name, content, told):
    (tmp_path / "settings.json").write_text(json.dumps(SETTINGS))
    (tmp_path / name).write_bytes(content)
    with pytest.raises(InputFileError) as raised:
        read_standing(tmp_path)
    assert told in str(raised.value)
    assert "\n" not in str(raised.value)


def test_a_study_of_something_else_is_told_in_one_line(tmp_path):
    (tmp_path / "settings.json").write_text(json.dumps(SETTINGS))
    with sqlite3.connect(tmp_path / "study.db") as base:
        base.execute("CREATE TABLE trials (trial_id INTEGER)")
    base.close()
    with pytest.raises(InputFileError, match=r"study\.db: cannot be read \(no such column: number\)"):
        read_standing(tmp_path)
