"""Evaluations: problems of their own, which end at the first collision."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from arena_core import ConfigurationError

pytest.importorskip("torch", reason="training needs the extra arena-gym[train]")

SMALL = ["recipe=rosnav", "robot=jackal", "environment.worlds=1", "environment.problems_per_world=2"]


def test_evaluation_never_meets_the_problems_of_training():
    from arena_gym.building import compose_environment
    from arena_gym.training.evaluation import unseen_worlds

    config = compose_environment(SMALL, primary="train")
    with pytest.raises(ConfigurationError, match=r"validation\.seed"):
        unseen_worlds(config, 1, config["environment"]["seed"], "training.validation.seed")


def test_evaluation_ends_at_the_first_collision_whatever_training_does():
    from arena_gym.building import compose_environment
    from arena_gym.training.evaluation import unseen_worlds

    config = compose_environment([*SMALL, "environment.collisions_to_end=null"], primary="train")
    assert unseen_worlds(config, 1, 7, "seed").batch.parts.settings.collisions_to_end == 1


def test_an_episode_with_a_collision_is_no_success_even_if_it_reached_the_goal_in_that_step():
    from arena_gym.training.evaluation import evaluate_policy

    ends = {
        "outcome": np.array(["goal_reached", "goal_reached", "time_out", "false_arrival"]),
        "collisions": np.array([0, 1, 0, 0]),
    }
    over = np.ones(4, bool)
    env = SimpleNamespace(
        num_envs=4,
        reset=lambda seed: (np.zeros((4, 1)), {}),
        step=lambda actions: (np.zeros((4, 1)), np.zeros(4), over, ~over, {"final_info": ends}),
    )
    score = evaluate_policy(env, lambda seen: seen, 4, 0)
    assert (score.episodes, score.success, score.collision, score.time_out) == (4, 0.25, 0.25, 0.25)
