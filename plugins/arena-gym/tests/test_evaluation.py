"""Evaluations: problems of their own, which end at the first collision."""

from __future__ import annotations

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
