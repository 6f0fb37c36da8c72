"""`arena_gym.train`, the words `test=` and `wandb=` of `arena train`, and the policy that each validation leaves."""

from __future__ import annotations

import json
import subprocess
import sys
from importlib.util import find_spec

import pytest

from arena_core import ConfigurationError
from arena_core.cli.main import main

pytest.importorskip("torch", reason="training needs the extra arena-gym[train]")

BRIEF = ("robot=jackal", "total_steps=512")


@pytest.fixture
def here(write_recipe):
    trip = {"min_distance": 1.5, "max_distance": 4.0}
    return write_recipe(
        "tiny",
        total_steps=512,
        training={"test": {"episodes": 0}},
        task={"pedestrians": 0, "trip": trip, "time_limit": 15.0},
    )


def config_of(policy):
    return json.loads(policy.with_suffix(".json").read_text())["training"]["config"]


@pytest.mark.slow
def test_words_train_from_python_as_on_the_command_line(here):
    import arena_gym

    policy = arena_gym.train(BRIEF, "tiny", "mine")
    assert main(["train", "planner=tiny", *BRIEF, "out=other"]) == 0
    assert policy.read_bytes() == (here / "other" / "policy.onnx").read_bytes()


@pytest.mark.slow
def test_environment_is_what_a_policy_trains_in_and_the_recipe_how(here):
    import gymnasium

    import arena_gym
    import arena_gym.envs

    words = ["environment.worlds=1", "environment.problems_per_world=4", "task.pedestrians=1", "world.width=7"]
    env = gymnasium.make(
        "arena/Navigation-v0", robot="jackal", world="empty", reward="arrival", observation="rosnav", overrides=words
    )
    policy = arena_gym.train(env, "tiny", "mine")
    config = config_of(policy)
    assert (config["reward"]["goal"], config["world"]["width"], config["task"]["pedestrians"]) == (15.0, 7, 1)
    assert (config["planner"], config["observation_encoder"]["name"]) == ("tiny", "rosnav")
    assert policy.parent.name == "mine"


def test_importing_the_plugin_loads_no_learning():
    said = subprocess.run(
        [sys.executable, "-c", "import arena_gym, sys; print([m for m in ('torch', 'gymnasium') if m in sys.modules])"],
        capture_output=True,
        text=True,
        check=True,
    )
    assert said.stdout == "[]\n"


def test_test_is_true_or_false(here, capsys):
    assert main(["train", "planner=tiny", "robot=jackal", "test=no"]) == 2
    assert capsys.readouterr().err == "arena: test is no; allowed: true, false\n"


@pytest.mark.skipif(find_spec("wandb") is not None, reason="wandb is installed")
def test_wandb_that_is_not_installed_is_one_line_and_leaves_nothing(here, capsys):
    assert main(["train", "planner=tiny", *BRIEF, "wandb=mine", "out=mine"]) == 2
    assert "arena: wandb is mine, and the package wandb is not installed; allowed: null" in capsys.readouterr().err
    assert not (here / "mine").exists()


@pytest.mark.parametrize("word", ["horizon=60", "exploration_time=1", "wandb=mine"])
def test_ways_of_training_of_their_own_say_what_they_do_not_read(word):
    from arena_gym.api import train_config
    from arena_gym.building import compose_training

    config = compose_training("cadrl", ["robot=jackal", word])
    with pytest.raises(ConfigurationError, match=rf"{word.partition('=')[0]} is .*; allowed: null for cadrl"):
        train_config(config, None, None, resume=False)


@pytest.mark.slow
def test_each_validation_that_is_the_best_so_far_leaves_a_policy(here, monkeypatch):
    """Which a kill spares, and which training on does not change."""
    from arena_gym.training import trainer

    kept, validate = [], trainer.TrainingCallback.validate

    def look(training):
        validate(training)
        policy = here / "mine" / "policy.json"
        kept.append(json.loads(policy.read_text())["training"] if policy.exists() else None)

    monkeypatch.setattr(trainer.TrainingCallback, "validate", look)
    assert main(["train", "planner=tiny", *BRIEF, "training.validation.every=256", "out=mine"]) == 0
    assert len(kept) == 2
    assert (kept[0]["steps"], kept[0]["weights"], kept[0]["score"]) == (256, "best", None)
