"""Exploration that keeps its direction, and a horizon in seconds."""

from __future__ import annotations

import math

import numpy as np
import pytest

from arena_core import ConfigurationError

torch = pytest.importorskip("torch", reason="training needs the extra arena-gym[train]")

HORIZON = ("training.optimization.gamma=null", "horizon=60")


@pytest.fixture
def composed(write_recipe):
    """Give a function that composes a recipe that takes no time."""
    from arena_gym.building import compose_environment

    write_recipe("tiny")

    def _compose(*overrides):
        return compose_environment(["recipe=tiny", "robot=turtlebot3", *overrides], primary="train")

    return _compose


def prepared(config, folder):
    from arena_gym.building import build_parts
    from arena_gym.training.session import training_settings
    from arena_gym.training.trainer import prepare_learner
    from arena_gym.vector_environment import NavigationVectorEnv

    return prepare_learner(training_settings(config), NavigationVectorEnv(4, parts=build_parts(config)), folder)


def test_discount_follows_from_horizon_and_decision(composed, tmp_path):
    learner, worlds = prepared(composed(*HORIZON, "environment.every=4"), tmp_path)
    period = worlds.env.batch.parts.decision_period
    assert period == pytest.approx(4 * worlds.env.batch.parts.robot.control_period)
    assert learner.gamma == pytest.approx(math.exp(-period / 60.0))


@pytest.mark.parametrize("words", [("horizon=60",), ("training.optimization.gamma=null",)])
def test_discount_has_one_home(composed, words):
    from arena_gym.training.session import training_settings

    with pytest.raises(ConfigurationError, match=r"gamma is .*; allowed: null with a horizon, a number without"):
        training_settings(composed(*words))


@pytest.mark.parametrize("word", ["training.network.log_std_final=-2", "training.network.log_std_unit=si"])
def test_exploration_that_lasts_has_no_limit_of_its_spread(composed, word):
    from arena_gym.training.session import training_settings

    with pytest.raises(ConfigurationError, match=r"exploration_time is 1; allowed: null where"):
        training_settings(composed("exploration_time=1", word))


def test_exploration_keeps_its_direction_for_as_long_as_it_is_told(composed, tmp_path):
    """As Stable-Baselines3 draws it, in decisions: 1 s is five of .2 s."""
    learner, worlds = prepared(composed("exploration_time=1", "environment.every=2"), tmp_path)
    assert (learner.use_sde, learner.sde_sample_freq) == (True, round(1.0 / worlds.env.batch.parts.decision_period))
    plain, _ = prepared(composed(), tmp_path)
    assert not plain.use_sde


def test_exploration_that_lasts_spreads_actions_as_the_recipe_says(composed, tmp_path):
    from arena_gym.training.learning import scale_exploration

    learner, worlds = prepared(composed("exploration_time=1", "training.network.log_std_init=-1.2"), tmp_path)
    observations = worlds.reset()
    scale_exploration(learner, observations)
    seen = torch.as_tensor(np.repeat(observations, 500, axis=0))
    with torch.no_grad():
        learner.policy.reset_noise(len(seen))
        off = learner.policy(seen)[0] - learner.policy(seen, deterministic=True)[0]
    assert off.square().mean().sqrt().item() == pytest.approx(math.exp(-1.2), rel=0.1)
