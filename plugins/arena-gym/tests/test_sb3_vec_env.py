"""Worlds that a training drives in step: which episodes they meet, and what counts as a success."""

from __future__ import annotations

import numpy as np
import pytest

pytest.importorskip("torch", reason="training needs the extra arena-gym[train]")


def test_goal_after_a_collision_is_no_success():
    from arena_gym.training.sb3_vec_env import Sb3VecEnv
    from arena_gym.vector_environment import NavigationVectorEnv

    near = [
        "task.trip.min_distance=3.05",
        "task.trip.max_distance=4.0",
        "task.goal_radius=3.0",
        "task.pedestrians=0",
        "action.vx_min=null",
    ]
    small = ["world.width=8", "world.height=8", "environment.worlds=2", "environment.collisions_to_end=null"]
    env = NavigationVectorEnv(2, overrides=[*near, *small])
    worlds, ends = Sb3VecEnv(env, 0), {}
    worlds.reset()
    for step in range(200):
        env.batch.collisions[1] = max(env.batch.collisions[1], 1)  # as if it had touched something before
        infos = worlds.step(np.full((2, 2), (1.0, 0.3) if step % 40 < 20 else (-1.0, 0.3), np.float32))[3]
        for slot, info in enumerate(infos):
            if info.get("episode", {}).get("o") == "goal_reached":
                ends.setdefault((slot, info["episode"]["c"] > 0), info["is_success"])
    assert ends[0, False]
    assert not ends[1, True]
    assert all(success == (not touched) for (_, touched), success in ends.items())


@pytest.mark.slow
def test_no_two_trainings_meet_the_same_episodes():
    from arena_gym.building import compose_environment
    from arena_gym.training.learning import make_learner
    from arena_gym.training.sb3_vec_env import Sb3VecEnv
    from arena_gym.training.session import training_settings
    from arena_gym.vector_environment import NavigationVectorEnv

    env = NavigationVectorEnv(
        2, overrides=["world=empty", "environment.worlds=1", "environment.problems_per_world=2", "task.pedestrians=0"]
    )
    met = []
    for seed in (0, 1):
        config = compose_environment(
            ["recipe=rosnav", f"seed={seed}", "training.optimization.minibatch=512"], primary="train"
        )
        config["training"]["network"] |= {"beams_field": None, "features": None}
        worlds = Sb3VecEnv(env, seed)
        learner = make_learner(worlds, env.batch.parts.encoder.layout(), training_settings(config), None)
        learner.env.reset()  # after the library has seeded all that it knows
        met += [key.seed for key in env.batch.keys]
    assert len(set(met)) == 4
