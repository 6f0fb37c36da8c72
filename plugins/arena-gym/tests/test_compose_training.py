"""What a recipe composes where other components are chosen than its own."""

from __future__ import annotations

import pytest

from arena_core import ConfigurationError
from arena_gym.building import build_parts, compose_environment, compose_training


def test_another_world_takes_the_place_of_the_recipes_with_all_that_it_says_of_it():
    words = ["robot=jackal", "world=indoor", "world.corridor_width=2.0"]
    assert compose_training("rosnav", words)["world"] == compose_environment(words)["world"]
    assert compose_training("rosnav", ["robot=jackal"])["world"]["members"]["corridors"]["regenerate"] == 1
    assert (
        compose_training("rosnav", ["robot=jackal", "world=mixed"])["world"]["members"]["corridors"]["regenerate"] == 1
    )


def test_an_option_of_ones_own_is_another_even_if_it_is_of_the_recipes_class(tmp_path, monkeypatch):
    (tmp_path / "conf" / "task").mkdir(parents=True)
    (tmp_path / "conf" / "task" / "site.yaml").write_text(
        "defaults:\n  - random\n  - _self_\n\npedestrians: 3  # [-]\n"
    )
    monkeypatch.chdir(tmp_path)
    assert (
        compose_training("rosnav", ["robot=jackal", "task=site"])["task"]
        == compose_environment(["robot=jackal", "task=site"])["task"]
    )
    assert compose_training("rosnav", ["robot=jackal", "task=random"])["task"]["pedestrians"] == 12


@pytest.mark.parametrize(("kind", "name"), [("task", "staged"), ("pedestrians", "orca")])
def test_people_are_chosen_for_another_task_or_crowd_too(kind, name):
    words = ["robot=jackal", f"{kind}={name}", "people=lifelike"]
    lifelike, as_released = compose_environment(words)[kind], compose_environment(words[:-1])[kind]
    assert compose_training("rosnav", words)[kind] == lifelike != as_released


def test_folder_of_a_run_is_no_word_of_a_training():
    with pytest.raises(ConfigurationError, match=r"hydra\.run\.dir is for `arena run`; allowed: out=DIR"):
        compose_training("rosnav", ["robot=jackal", "hydra.run.dir=mine"])


@pytest.mark.parametrize("word", ["~reward", "~training", "~seed", "~later"])
def test_what_a_training_needs_cannot_be_taken_away(word):
    with pytest.raises(ConfigurationError, match=f"{word} takes away what a training needs; allowed: ~guide, ~switch"):
        compose_training("rosnav", ["robot=jackal", word])


def test_training_can_do_without_a_guide_but_not_with_half_of_one():
    assert "guide" not in compose_training("gring", ["robot=jackal", "~guide"])
    with pytest.raises(ConfigurationError, match="guide lacks replan"):
        build_parts(compose_training("gring", ["robot=jackal", "~guide.replan"]))


def test_an_environment_says_which_part_it_lacks():
    config = compose_environment()
    del config["reward"]
    with pytest.raises(ConfigurationError, match="the configuration lacks reward"):
        build_parts(config)
