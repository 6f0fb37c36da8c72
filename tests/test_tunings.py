"""Provenance says of the planner how it was tuned, with which budget, and how it learned."""

import json
from pathlib import Path

import pytest

from arena_core.files import option_files
from arena_core.hosting import compose, load_registry, to_plain
from arena_core.runs.folders.tunings import tuning_of
from arena_core.testing import component
from arena_policies.learning_facts import NOT_TOLD, learned_by


def config_of(*words):
    chosen = compose(words, hydra=True).hydra.runtime.choices
    choices = {str(group): option for group, option in chosen.items() if option is not None}
    return {**to_plain(compose(words)), "choices": choices}


@pytest.mark.parametrize(
    ("words", "tuned"),
    [
        (["planner=dwa", "robot=jackal"], "by hand, no card"),
        (["planner=pure_pursuit", "robot=jackal"], "by hand, no card"),
        (["planner=mppi", "robot=jackal_ackermann"], "not for this robot"),
        (["planner=teb_as_released", "robot=jackal"], "as released, no card"),
        (["planner=mppi_as_nav2", "robot=jackal"], "as nav2, no card"),
    ],
)
def test_a_preset_without_a_card_has_no_budget(words, tuned):
    found = tuning_of(config_of(*words), load_registry().manager)
    assert (found["preset"], found["tuned"], found["budget"]) == (words[0].removeprefix("planner="), tuned, 0)


def test_every_shipped_preset_says_how_it_was_tuned():
    manager = load_registry().manager
    for preset in option_files("planner", manager):
        if "/" not in preset:
            config = {"planner": {"name": preset}, "choices": {"planner": preset}}
            assert tuning_of(config, manager)["tuned"]


CARD = {
    "values": {"gain": 3.0},
    "robot": "jackal",
    "code": "abcd",
    "seed": 0,
    "verdict": "better",
    "budget": {"episodes": 2256},
}


@pytest.fixture
def mine(tmp_path, monkeypatch):
    """A preset of the user's own, with a card beside it."""
    folder = tmp_path / "conf/planner"
    folder.mkdir(parents=True)
    (folder / "mine.yaml").write_text("defaults: [pure_pursuit, _self_]\nname: pure_pursuit\ngain: 3.0\n")
    card = folder / "mine.card.json"
    card.write_text(json.dumps(CARD))
    monkeypatch.chdir(tmp_path)
    return card


def test_a_card_tells_budget_robot_and_code(mine):
    found = tuning_of(config_of("planner=mine", "robot=jackal"), load_registry().manager)
    assert (found["tuned"], found["budget"]) == ("by arena tune for jackal", 2256)
    assert found["card"] == {"code": "abcd", "seed": 0, "robot": "jackal", "verdict": "better"}


def test_what_a_preset_has_for_a_robot_may_have_a_card_of_its_own(tmp_path, monkeypatch):
    folder = tmp_path / "conf/planner/mine_tuning"
    folder.mkdir(parents=True)
    preset = "defaults: [pure_pursuit, _self_, optional mine_tuning@_here_: '${robot}']\nname: pure_pursuit\n"
    (folder.parent / "mine.yaml").write_text(preset)
    (folder / "jackal.yaml").write_text("gain: 3.0\n")
    (folder / "jackal.card.json").write_text(json.dumps(CARD))
    monkeypatch.chdir(tmp_path)
    manager = load_registry().manager
    found = tuning_of(config_of("planner=mine", "robot=jackal"), manager)
    assert (found["preset"], found["tuned"], found["budget"]) == ("mine", "by arena tune for jackal", 2256)
    changed = config_of("planner=mine", "robot=jackal", "planner.gain=4.0")
    assert tuning_of(changed, manager)["tuned"] == "by arena tune for jackal, but for gain"
    assert tuning_of(config_of("planner=mine", "robot=turtlebot3"), manager)["budget"] == 0


def test_a_stack_tells_its_card_beside_that_of_the_planner(mine, tmp_path):
    (tmp_path / "conf/stack").mkdir()
    text = "# @package _global_\ndefaults: [override /tracker: kalman, _self_]\ntracker: {gate: 9.0}\n"
    (tmp_path / "conf/stack/good.yaml").write_text(text)
    card = {**CARD, "planner": "teb", "values": {"tracker.gate": 9.0}, "budget": {"episodes": 300}}
    (tmp_path / "conf/stack/good.card.json").write_text(json.dumps(card))
    manager = load_registry().manager
    found = tuning_of(config_of("planner=mine", "robot=jackal", "stack=good"), manager)
    assert (found["tuned"], found["budget"]) == ("by arena tune for jackal", 2256)
    assert (found["stack"]["tuned"], found["stack"]["budget"]) == ("by arena tune for jackal, with teb", 300)
    changed = tuning_of(config_of("planner=mine", "robot=jackal", "stack=good", "tracker.gate=8.0"), manager)
    assert changed["stack"]["tuned"] == "by arena tune for jackal, but for tracker.gate, with teb"
    shipped = tuning_of(config_of("planner=mine", "robot=jackal", "stack=as_ros"), manager)["stack"]
    assert (shipped["tuned"], shipped["budget"]) == ("as ros, no card", 0)
    assert "stack" not in tuning_of(config_of("planner=mine", "robot=jackal"), manager)


def test_values_that_are_no_longer_those_of_the_card_are_named(mine):
    config = config_of("planner=mine", "robot=jackal", "planner.gain=4.0")
    assert tuning_of(config, load_registry().manager)["tuned"] == "by arena tune for jackal, but for gain"


@pytest.mark.parametrize("text", ["{", "[]", "{}", '{"values": 3}', '{"values": {}, "budget": 7}'])
def test_a_card_that_cannot_be_read_is_none(mine, text):
    Path(mine).write_text(text)
    assert tuning_of(config_of("planner=mine", "robot=jackal"), load_registry().manager)["budget"] == 0


def training(teacher=None, steps=0, reward="progress", **more):
    return {"steps": steps, "config": {"teacher": {"planner": teacher}, "reward": {"name": reward}}, **more}


@pytest.mark.parametrize(
    ("card", "said"),
    [
        (training("teb", 0), "imitation of teb"),
        (training(None, 4000, seed=3), "rewards (progress), 4000 steps, seed 3"),
        (training("teb", 4000), "imitation of teb, then rewards (progress), 4000 steps"),
        ({"steps": 10, "config": {"trainer": {"teacher": "orca"}}}, "imitation of orca"),
        ({}, NOT_TOLD),
        ({"config": [], "steps": "many", "seed": "x"}, NOT_TOLD),
    ],
)
def test_a_policy_learned_as_its_card_says(card, said):
    assert learned_by(card) == said


@pytest.mark.parametrize(
    ("planner", "said"),
    [("rosnav", "imitation of teb, then rewards (progress)"), ("cadrl", "imitation of orca"), ("dwa", "")],
)
def test_learned_planners_say_how_they_learned(planner, said):
    built = component("planner", planner, [], "jackal", robot=component("robot", "jackal"))
    assert built.learned_by.startswith(said)
    assert bool(built.learned_by) == bool(said)
