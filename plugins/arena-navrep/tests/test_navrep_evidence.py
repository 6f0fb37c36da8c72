"""Evidence is of problems that no training met, of the policy that its card tells,
and of what memory alone is worth.
"""

from __future__ import annotations

import json
import shutil

import numpy as np
import pytest

from arena_core import testing
from arena_core.cli.main import main
from arena_core.hosting import load_registry
from arena_gym.building import compose_environment, compose_training
from arena_policies.encoding import field_columns
from arena_policies.policy import load_policy

SMALL = [
    "world=indoor",
    "world.width=12",
    "world.height=12",
    "environment.worlds=2",
    "environment.problems_per_world=3",
]


@pytest.fixture(scope="module")
def config():
    return compose_training("navrep", ["robot=jackal", *SMALL])


@pytest.fixture
def policy(made, config, tmp_path):
    """Return a copy of a policy that a test may spoil, whose card tells its training."""
    shutil.copytree(made.policy.parent, tmp_path / "copy")
    path = tmp_path / "copy" / "policy.onnx"
    change(path, training={"config": config})
    return path


def change(path, **keys):
    beside = path.with_suffix(".json")
    beside.write_text(json.dumps(json.loads(beside.read_text()) | keys))


def refused(path, capsys, *words):
    assert main(["navrep", "evidence", f"policy={path}", *words]) == 2
    lines = capsys.readouterr().err.strip().splitlines()
    assert len(lines) == 1, lines
    return lines[0]


def test_memory_seen_as_zeros_is_worth_what_it_moves(policy, made, monkeypatch, capsys):
    driven = []

    def drive(env, act, episodes, seed):
        rows = np.random.default_rng(1).normal(size=(5, env.single_observation_space.shape[0])).astype(np.float32)
        driven.append(act(rows))
        return ["goal_reached", "collision"]

    layout = load_policy(str(policy), "navrep", made.robot).card.layout
    content = made.linear_model(sum(f.size for f in layout), 2, only=field_columns(layout, "h"))
    policy.write_bytes(content)
    change(policy, sha256=made.sha256(content))
    monkeypatch.setattr("arena_navrep.evidence.episode_outcomes", drive)
    assert main(["navrep", "evidence", f"policy={policy}", "episodes=2"]) == 0
    remembering, forgetful = driven
    assert remembering.all()
    assert not forgetful.any()


def test_gain_is_that_of_pairs():
    from arena_navrep.evidence import _compare_outcomes

    outcomes = ["goal_reached", "collision"] * 50
    assert "memory gains 0.000 (95 % of pairs: 0.000 .. 0.000)" in _compare_outcomes(outcomes, outcomes)
    lost = ["collision" if k < 20 else end for k, end in enumerate(outcomes)]
    said = _compare_outcomes(outcomes, lost)
    assert "success 0.500, with h seen as zeros 0.400" in said
    assert "gains 0.100 (95 % of pairs: 0.041 .. 0.159)" in said


@pytest.mark.slow
def test_equal_drives_meet_equal_problems():
    from arena_gym.training.evaluation import episode_outcomes, unseen_worlds

    words = ["robot=jackal", *SMALL, "observation_encoder=rosnav_sectors", "task.time_limit=3.0"]
    env = unseen_worlds(compose_training("navrep", words), 3, 11, "seed")

    def drive(speed):
        met = []

        def act(seen):
            met.append([episode.problem.scenario.seed for episode in env.batch.episodes])
            return np.full((len(seen), 2), speed, np.float32)

        return episode_outcomes(env, act, 6, 1), np.array(met)

    (ended, slow), (_, fast) = drive(-1.0), drive(1.0)
    assert len(ended) == 6
    for slot in range(3):
        first, second = (list(dict.fromkeys(met[:, slot].tolist()))[:2] for met in (slow, fast))
        assert first == second


def test_evidence_of_another_world_model_is_refused(policy, made, capsys):
    for part in ("vision", "memory"):
        for suffix in (".onnx", ".json"):
            shutil.copy((made.other_world / part).with_suffix(suffix), policy.with_name(f"policy.{part}{suffix}"))
    assert "policy.vision.onnx: sha256" in refused(policy, capsys)


def test_evidence_in_problems_of_the_training_is_refused(policy, capsys):
    assert "policy.json: training.config: seed is 0; allowed: any other than environment.seed" in refused(
        policy, capsys, "seed=0"
    )


@pytest.mark.parametrize("guide", [{"name": "nowhere"}, "driving"])
def test_evidence_drives_on_the_guide_of_the_training(policy, config, guide, capsys):
    change(policy, training={"config": {**config, "guide": guide}})
    assert "guide" in refused(policy, capsys).partition("policy.json: training.config")[2]


def test_policy_without_memory_has_no_evidence_of_one(made, config, tmp_path, capsys):
    shutil.copytree(made.v_only.parent, tmp_path / "copy")
    path = tmp_path / "copy" / "policy.onnx"
    change(path, training={"config": config})
    assert "planner is navrep_v_only" in refused(path, capsys)
    change(path, planner="navrep")
    assert "sees no memory" in refused(path, capsys)


@pytest.mark.parametrize("left_out", ["config", "robot", "environment", "task", "seed"])
def test_card_that_does_not_tell_its_training_is_refused(policy, config, left_out, capsys):
    told = {key: value for key, value in config.items() if key != left_out}
    told["environment"] = {key: value for key, value in config["environment"].items() if key != left_out}
    if left_out == "environment":
        del told["environment"]
    change(policy, training={} if left_out == "config" else {"config": told})
    said = refused(policy, capsys)
    assert "policy.json: training.config" in said
    assert ("environment" if left_out == "config" else left_out) in said


def test_world_model_whose_card_tells_no_recording_is_refused(made, capsys):
    assert main(["navrep", "evidence", f"out={made.world}"]) == 2
    assert "memory.json: training.config has no recording" in capsys.readouterr().err


def test_columns_are_where_a_field_is_written():
    robot = testing.robot()
    encoder = load_registry().build(
        "observation_encoder",
        compose_environment(observation_encoder="rosnav_sectors")["observation_encoder"],
        robot=robot,
    )
    layout = encoder.layout()
    assert [field_columns(layout, f.name).stop - field_columns(layout, f.name).start for f in layout] == [
        f.size for f in layout
    ]
    assert field_columns(layout, layout[0].name).start == 0
    assert field_columns(layout, layout[-1].name).stop == sum(f.size for f in layout)
