"""A training that was cut goes on bit for bit; what it cannot go on with is one line."""

from __future__ import annotations

import json

import numpy as np
import pytest

from arena_core import ConfigurationError, RunFolderError
from arena_core.cli.main import main

torch = pytest.importorskip("torch", reason="training needs the extra arena-gym[train]")

RECIPE = """
# @package _global_
defaults:
  - override /observation_encoder: rosnav_sectors
  - override /reward: progress
  - override /world: empty
  - override /pedestrians: social_force

planner: tiny
total_steps: 1536
world: {width: 6.0, height: 6.0}
environment: {worlds: 1, problems_per_world: 8}
observation_encoder: {sectors: 16}
training:
  network: {beams_field: null, convolutions: [], features: null, heads: [8], log_std_init: -0.5, log_std_final: -1.0}
  optimization: {environments: 4, steps: 64, minibatch: 64, epochs: 2, learning_rate: 0.002, gamma: 0.97}
  validation: {every: 600, episodes: 4}
  test: {episodes: 4}
"""
RANDOM = ("task.pedestrians=2", "task.trip.min_distance=1.5", "task.trip.max_distance=4.0", "task.time_limit=15.0")
NOISE = ("randomization.lidar_noise.high=0.02", "randomization.latency.high=1", "randomization.people={low: 0, high: 2}")
STAGED = ("task=staged", "training.levels=mixture", "task.random.time_limit=15.0", "task.random.trip.min_distance=1.5")


@pytest.fixture
def here(tmp_path, monkeypatch):
    """Work in a folder whose conf/ holds a recipe that takes no time."""
    (tmp_path / "conf" / "recipe").mkdir(parents=True)
    (tmp_path / "conf" / "recipe" / "tiny.yaml").write_text(RECIPE.lstrip())
    monkeypatch.chdir(tmp_path)
    return tmp_path


def composed(*overrides):
    from arena_gym.building import compose_environment

    return compose_environment(["recipe=tiny", "robot=jackal", *overrides], primary="train")


def trained(folder, *overrides):
    """Train by ``overrides`` in a folder; return its weights and what its checkpoint holds."""
    from arena_gym.building import build_parts
    from arena_gym.training.evaluation import unseen_worlds
    from arena_gym.training.levels import make_levels
    from arena_gym.training.session import training_settings
    from arena_gym.training.trainer import train
    from arena_gym.vector_environment import NavigationVectorEnv

    config = composed(*overrides)
    settings, parts = training_settings(config), build_parts(config)
    levels = make_levels(settings.levels, parts.pool.staging, settings.mixture)
    validation = unseen_worlds(config, settings.validation.episodes, settings.validation.seed, "seed")
    found = train(settings, NavigationVectorEnv(settings.optimization.environments, parts=parts), validation, levels, folder)
    return found, torch.load(folder / "checkpoint.pt", weights_only=True)


class Cut(Exception):
    """Ends a training where a kill might."""


def cut_after(rollouts, monkeypatch):
    """Let a training end at so many rollouts, after the last one and before its update: what came after the checkpoint is lost."""
    from arena_gym.training.trainer import Trainer

    goes_on = Trainer._on_rollout_end
    seen = []

    def end(trainer):
        seen.append(trainer)
        if len(seen) > rollouts:
            raise Cut
        goes_on(trainer)

    monkeypatch.setattr(Trainer, "_on_rollout_end", end)


def same(one, other):
    """Tell whether two states of a checkpoint are the same bits."""
    if isinstance(one, torch.Tensor):
        return torch.equal(one, other)
    if isinstance(one, dict):
        return one.keys() == other.keys() and all(same(one[key], other[key]) for key in one)
    if isinstance(one, (list, tuple)):
        return len(one) == len(other) and all(map(same, one, other))
    return one == other


@pytest.mark.parametrize(
    ("overrides", "rollouts"),
    [(RANDOM, 1), ((*RANDOM, *NOISE, "guide=driving", "training.critic=truth"), 3), (STAGED, 4)],
    ids=["plain", "as it drives", "levels"],
)
def test_training_that_was_cut_gives_the_weights_of_one_that_was_not(here, monkeypatch, overrides, rollouts):
    whole, kept = trained(here / "whole", *overrides, "training.checkpoint=10000")
    with monkeypatch.context() as patch:
        cut_after(rollouts, patch)
        with pytest.raises(Cut):
            trained(here / "cut", *overrides, "training.checkpoint=0")
    before = torch.load(here / "cut" / "checkpoint.pt", weights_only=True)
    assert before["steps"] == rollouts * 256
    assert not same(before["policy"], kept["policy"])
    assert len(before["episodes"]["actions"]) > 0
    torch.manual_seed(99)
    np.random.seed(99)  # noqa: NPY002 - the library's own stream, disturbed as another process would have it
    resumed, now = trained(here / "cut", *overrides, "training.checkpoint=10000")
    for part in ("policy", "optimizer", "best", "progress", "random", "episodes", "updates", "steps"):
        assert same(now[part], kept[part]), part
    assert resumed.choice == whole.choice
    assert resumed.curve == whole.curve
