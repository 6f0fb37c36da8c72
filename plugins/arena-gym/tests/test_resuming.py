"""A training that was cut goes on bit for bit, one begins with a policy's weights; what it
cannot go on with is one line.
"""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import numpy as np
import pytest

from arena_core import ConfigurationError
from arena_core.cli.main import main

torch = pytest.importorskip("torch", reason="training needs the extra arena-gym[train]")

RANDOM = ("task.pedestrians=2", "task.trip.min_distance=1.5", "task.trip.max_distance=4.0", "task.time_limit=15.0")
NOISE = (
    "randomization.lidar_noise.high=0.02",
    "randomization.latency.high=1",
    "randomization.people={low: 0, high: 2}",
)
STAGED = ("task=staged", "training.levels=mixture", "task.random.time_limit=15.0", "task.random.trip.min_distance=1.5")


@pytest.fixture
def here(write_recipe):
    """Work in a folder with a recipe that takes no time."""
    return write_recipe("tiny", "social_force", total_steps=1536, training={"network": {"log_std_final": -1.0}})


def composed(*overrides):
    from arena_gym.building import compose_environment

    return compose_environment(["recipe=tiny", "robot=jackal", *overrides], primary="train")


def trained(folder, *overrides):
    """Train by ``overrides`` in a folder; return its weights and what its checkpoint holds."""
    from arena_gym.building import build_parts
    from arena_gym.training.evaluation import unseen_worlds
    from arena_gym.training.levels import make_levels
    from arena_gym.training.session import training_settings
    from arena_gym.training.trainer import TrainingCourse, prepare_learner, train_policy
    from arena_gym.vector_environment import NavigationVectorEnv

    config = composed(*overrides)
    settings, parts = training_settings(config), build_parts(config)
    levels = make_levels(settings.levels, parts.pool.staging, settings.mixture)
    validation = unseen_worlds(config, settings.validation.episodes, settings.validation.seed, "seed")
    learner, worlds = prepare_learner(
        settings, NavigationVectorEnv(settings.optimization.environments, parts=parts), folder
    )
    found = train_policy(settings, learner, TrainingCourse(worlds, validation, levels), folder)
    return found, torch.load(folder / "checkpoint.pt", weights_only=True)


class Cut(Exception):
    """Ends a training where a kill might."""


def cut_after(rollouts, monkeypatch):
    """Let a training end at so many rollouts, after the last one and before its update: what
    came after the checkpoint is lost.
    """
    from arena_gym.training.trainer import TrainingCallback

    goes_on = TrainingCallback._on_rollout_end
    seen = []

    def end(trainer):
        seen.append(trainer)
        if len(seen) > rollouts:
            raise Cut
        goes_on(trainer)

    monkeypatch.setattr(TrainingCallback, "_on_rollout_end", end)


def same(one, other):
    """Return whether two states of a checkpoint are the same bits."""
    if isinstance(one, torch.Tensor):
        return torch.equal(one, other)
    if isinstance(one, dict):
        return one.keys() == other.keys() and all(same(one[key], other[key]) for key in one)
    if isinstance(one, (list, tuple)):
        return len(one) == len(other) and all(map(same, one, other))
    return one == other


MODELLED = (
    *RANDOM,
    "guide=batched",
    "tracker@guide.tracker=kalman",
    "observation_encoder.foreseen=[1.0]",
    "guide.model.real_share=0.5",
)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("overrides", "rollouts"),
    [
        pytest.param(RANDOM, 1, marks=pytest.mark.long),
        ((*RANDOM, *NOISE, "guide=driving", "training.critic=truth"), 3),
        (STAGED, 4),
        (MODELLED, 3),
        pytest.param(MODELLED, 4, marks=pytest.mark.long),
    ],
    ids=["plain", "as it drives", "levels", "model gives way", "model gave way"],
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


@pytest.mark.slow
def test_real_guides_take_over_in_the_last_share_of_a_training(here, monkeypatch):
    from arena_gym.training.trainer import TrainingCallback

    ends, seen = TrainingCallback._on_rollout_end, []

    def end(trainer):
        seen.append(trainer._worlds.env.batch.led_by_model)
        ends(trainer)

    monkeypatch.setattr(TrainingCallback, "_on_rollout_end", end)
    trained(here / "modelled", *MODELLED)
    assert seen == [True] * 3 + [False] * 3


@pytest.mark.slow
def test_training_that_goes_on_with_fewer_steps_than_it_has_ends_with_what_it_has(here, monkeypatch):
    with monkeypatch.context() as patch:
        cut_after(4, patch)
        with pytest.raises(Cut):
            trained(here / "cut", *RANDOM, "training.checkpoint=0")
    found, kept = trained(here / "cut", *RANDOM, "total_steps=512")
    assert [row["steps"] for row in found.curve] == [768, 1024]
    assert kept["steps"] == 1024


def refused(words, capsys):
    """Return the one line that a command ends with."""
    assert main(list(words)) == 2
    lines = [line for line in capsys.readouterr().err.strip().splitlines() if "compiling kernels" not in line]
    assert len(lines) == 1, lines
    return lines[0]


def test_loss_that_is_no_number_ends_a_training_in_one_line_and_spares_its_checkpoint(here, monkeypatch):
    from arena_gym.progress_reward import ProgressReward
    from arena_gym.training.trainer import TrainingStopped

    rewards, calls = ProgressReward.reward, []

    def spoilt(reward, transition):
        calls.append(transition)
        return rewards(reward, transition) * (np.nan if len(calls) == 150 else 1.0)

    monkeypatch.setattr(ProgressReward, "reward", spoilt)
    with pytest.raises(
        TrainingStopped, match=r"768 steps the loss is no number .*holds the training up to 512 steps"
    ) as stopped:
        trained(here / "wild", *RANDOM, "training.checkpoint=0", "training.validation.every=10000")
    assert stopped.value.exit_status == 2
    kept = torch.load(here / "wild" / "checkpoint.pt", weights_only=True)
    assert all(bool(torch.isfinite(values).all()) for values in kept["policy"].values())


@pytest.mark.slow
def test_full_disk_ends_a_training_in_one_line_and_spares_what_was_kept(here, monkeypatch):
    from arena_gym.training.trainer import TrainingStopped

    with monkeypatch.context() as patch:
        cut_after(2, patch)
        with pytest.raises(Cut):
            trained(here / "full", *RANDOM, "training.checkpoint=0")
    before = (here / "full" / "checkpoint.pt").read_bytes()

    resource = pytest.importorskip("resource", reason="limits of Unix")
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    # no file may grow beyond: as on a full disk, a write fails half-way
    resource.setrlimit(resource.RLIMIT_FSIZE, (4096, limits[1]))
    try:
        with pytest.raises(
            TrainingStopped, match=r"cannot write .*checkpoint.pt: .*holds the training up to 512 steps"
        ):
            trained(here / "full", *RANDOM, "training.checkpoint=0")
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    assert (here / "full" / "checkpoint.pt").read_bytes() == before
    assert not list((here / "full").glob(".*"))
    assert trained(here / "full", *RANDOM, "training.checkpoint=0")[0].steps == 1536


def test_folder_of_other_code_is_refused_unless_forced(here, capsys):
    from arena_core.hosting import digest_code, load_registry
    from arena_gym.training.folder import open_folder
    from arena_gym.training.session import NO_PART

    config = composed(*RANDOM)
    code = digest_code(config, load_registry(), apart=NO_PART, besides=("gym",))
    assert {"arena-core", "arena-gym", "arena-sim2d"} <= set(code.parts)
    open_folder(here / "mine", config, resume=False, code=code)
    open_folder(here / "mine", config, resume=True, code=code)
    told = json.loads((here / "mine" / "code.json").read_text())
    told["digest"], told["parts"]["arena-sim2d"] = "00000000", "0.0.9 00000000"
    (here / "mine" / "code.json").write_text(json.dumps(told))
    with pytest.raises(ConfigurationError, match=r"other code: arena-sim2d; resume=force"):
        open_folder(here / "mine", config, resume=True, code=code)
    assert open_folder(here / "mine", config, resume=True, code=code, force=True) == ["00000000"]
    assert open_folder(here / "mine", config, resume=True, code=code) == ["00000000"]  # the card tells of it ever after
    (here / "mine" / "code.json").unlink()
    with pytest.raises(ConfigurationError, match="which it does not name"):
        open_folder(here / "mine", config, resume=True, code=code)


def test_folder_of_another_configuration_names_the_key(here):
    from arena_gym.training.folder import open_folder

    open_folder(here / "mine", composed(*RANDOM), resume=False)
    other = composed(*RANDOM, "training.optimization.gamma=0.9")
    with pytest.raises(ConfigurationError, match=r"another training\.optimization\.gamma"):
        open_folder(here / "mine", other, resume=True)
    open_folder(here / "mine", composed(*RANDOM, "total_steps=9999"), resume=True)


@pytest.mark.parametrize(
    ("word", "said"),
    [
        ("world.width=1", "cannot be trained on"),
        ("training.levels=mixture", "training.levels"),
        ("training.levels=random", "training.levels"),
        ("training.critic=all", "training.critic"),
        ("training.start.policy=nowhere.onnx", "nowhere.onnx"),
        (
            "training.start.policy=pkg://arena_rosnav/policies/jackal.onnx",
            "jackal.json: the observation of jackal differs",
        ),
        ("training.mixture.floor=2", "mixture.floor"),
        ("training.test.seed=7", "training.test.seed"),
        ("training.test.seed=0", "training.test.seed"),
        ("training.validation.average=0", "validation.average"),
        ("resume=perhaps", "resume"),
        ("seed=0,0", "seed"),
        ("seed=0,x", "seed"),
        ("seed=4294967296", "seed is 4294967296; allowed: 0 .. 4294967295"),
        ("training.optimization.minibatch=1", "training.optimization.minibatch is 1; allowed: 2 or more"),
        (
            "training.network={beams_field: closeness, features: 8, convolutions: "
            "[{channels: 4, kernel: 5, stride: 3}, "
            "{channels: 4, kernel: 5, stride: 1}]}",
            "training.network.convolutions leave nothing of 16 beams",
        ),
    ],
)
def test_impossible_training_is_one_line_and_leaves_nothing_behind(here, capsys, word, said):
    words = ["train", "planner=tiny", "robot=jackal", "out=none", *RANDOM]
    line = refused([*(w for w in words if not w.startswith(word.split("=")[0])), word], capsys)
    assert said in line, line
    assert not list(here.glob("none*"))


def weights(policy):
    import onnx
    from onnx import numpy_helper

    found = onnx.load(policy).graph.initializer
    return {one.name: numpy_helper.to_array(one) for one in found if one.name.endswith(("weight", "bias"))}


def command(out, *overrides):
    assert main(["train", "planner=tiny", "robot=jackal", f"out={out}", *RANDOM, *overrides]) == 0


_first: list[Path] = []  # trained once for all tests of a process


@pytest.fixture
def first(here, tmp_path_factory):
    """Work in a folder that holds a finished training, `first`."""
    if not _first:
        command("first")
        _first.append(shutil.copytree("first", tmp_path_factory.mktemp("first") / "first"))
    else:
        shutil.copytree(_first[0], "first")
    return here


@pytest.mark.slow
def test_policy_drives_as_it_is_while_only_its_value_is_learned_and_learns_then(first, capsys):
    here, from_first = first, ("training.start.policy=first/policy.onnx", "seed=3")
    command("held", *from_first, "training.start.value_steps=100000")
    command("freed", *from_first, "training.start.value_steps=512")
    before, held, freed = (weights(here / name / "last" / "policy.onnx") for name in ("first", "held", "freed"))
    chosen = weights(here / "first" / "policy.onnx")
    assert before.keys() == held.keys() == freed.keys()
    assert all(np.array_equal(chosen[name], held[name]) for name in chosen)
    assert not any(np.array_equal(chosen[name], freed[name]) for name in chosen)
    card, begun = (json.loads((here / name / "policy.json").read_text()) for name in ("freed", "first"))
    assert card["training"]["start"] == begun["sha256"]


@pytest.mark.slow
def test_network_of_another_structure_is_one_line(first, capsys):
    other = ("training.start.policy=first/policy.onnx", "training.network.heads=[9]")
    line = refused(["train", "planner=tiny", "robot=jackal", "out=second", *RANDOM, *other], capsys)
    assert "body.0.weight is (8, " in line
    assert "allowed: (9, " in line
    assert not (first / "second").exists()
