"""A world model that does not fit its controller, its robot or itself is refused in one line."""

from __future__ import annotations

import json
import shutil

import pytest

from arena_core import ArenaError, testing
from arena_core.cli.main import main
from arena_policies.policy import load_policy


@pytest.fixture
def policy(made, tmp_path):
    """Return a copy of a policy that a test may spoil."""
    shutil.copytree(made.policy.parent, tmp_path / "copy")
    return tmp_path / "copy" / "policy.onnx"


def refused(call):
    with pytest.raises(ArenaError) as caught:
        call()
    assert "\n" not in str(caught.value)
    return str(caught.value)


@pytest.mark.parametrize("part", ["vision", "memory"])
def test_world_model_that_the_controller_was_not_trained_on_is_refused(made, policy, part):
    for suffix in (".onnx", ".json"):
        shutil.copy((made.other_world / part).with_suffix(suffix), policy.with_name(f"policy.{part}{suffix}"))
    said = refused(lambda: load_policy(str(policy), "navrep", made.robot))
    assert f"policy.{part}.onnx: sha256" in said
    assert f"the {part} that the policy was trained on" in said


@pytest.mark.parametrize("part", ["vision", "memory"])
def test_missing_or_damaged_network_is_refused(made, policy, part):
    network = policy.with_name(f"policy.{part}.onnx")
    content = network.read_bytes()
    network.write_bytes(content[:-7])
    assert "sha256" in refused(lambda: load_policy(str(policy), "navrep", made.robot))
    network.unlink()
    assert network.name in refused(lambda: load_policy(str(policy), "navrep", made.robot))


def test_memory_of_another_vision_is_refused(made):
    words = [*made.words(made.world)[:1], *made.words(made.other_world)[1:]]
    said = refused(lambda: testing.component("observation_encoder", "navrep", words, robot=made.robot))
    assert "remembers codes of 6 by vision" in said


@pytest.mark.parametrize(
    "spoil",
    [
        *(
            {"part": "memory"},
            {"format": "other"},
            {"code": None},
            {"sha256": "0"},
            {"layout": 3},
            {"writes": 9},
            {"scan": 3},
        ),
        *({"scan": {}}, {"code": "x"}, {"hidden": "x"}, {"code": 3}, {"training": 3}, {"layout": []}, {"reads": 9}),
    ],
)
def test_card_that_is_none_of_this_network_is_refused(made, tmp_path, spoil):
    for path in made.world.iterdir():
        shutil.copy(path, tmp_path)
    card = json.loads((tmp_path / "vision.json").read_text()) | spoil
    if spoil == {"code": None}:
        del card["code"]
    (tmp_path / "vision.json").write_text(json.dumps(card))
    said = refused(lambda: testing.component("observation_encoder", "navrep", made.words(tmp_path), robot=made.robot))
    assert "vision" in said
    assert "plugin" not in said


def test_memory_of_codes_of_another_size_is_refused(made, tmp_path):
    for path in made.world.iterdir():
        shutil.copy(path, tmp_path)
    card = json.loads((tmp_path / "memory.json").read_text())
    (tmp_path / "memory.json").write_text(json.dumps(card | {"code": 5, "hidden": 9}))
    said = refused(lambda: testing.component("observation_encoder", "navrep", made.words(tmp_path), robot=made.robot))
    assert "remembers codes of 5" in said


def test_policy_whose_networks_lie_elsewhere_is_refused(made, policy):
    beside = policy.with_suffix(".json")
    card = json.loads(beside.read_text())
    elsewhere = {part: str(policy.with_name(f"policy.{part}.onnx")) for part in card["parts"]}
    for left in ({}, {"vision": card["parts"]["vision"]}):
        beside.write_text(json.dumps(card | {"parts": left, "encoder": {**card["encoder"], **elsewhere}}))
        said = refused(lambda: load_policy(str(policy), "navrep", made.robot))
        assert "policy.json: parts are" in said
        assert "allowed: what its encoder runs, vision, memory" in said


def test_robot_with_another_lidar_is_refused(made, policy):
    body = testing.component("robot", "turtlebot3")
    said = refused(lambda: testing.component("observation_encoder", "navrep", made.words(made.world), robot=body))
    assert "the observation of jackal differs" in said
    assert "jackal" in refused(lambda: load_policy(str(policy), "navrep", body))


def test_policy_without_memory_is_no_policy_of_the_planner_with_one(made):
    assert "navrep_v_only" in refused(lambda: load_policy(str(made.v_only), "navrep", made.robot))


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["dream"], "stage is dream"),
        (["vision", "out=none"], "arena navrep record"),
        (["record", "robot=unheard_of"], "unheard_of"),
        (["record", "recording.steps=0"], "recording.steps"),
        (["record", "recording.test_seed=0"], "test_seed"),
        (["record", "observation_encoder=rosnav"], "rosnav_sectors"),
        (["record", "device=abacus"], "device"),
        (["record", "resume=perhaps"], "resume"),
        (["all", "resume"], "resume"),
        (["evidence"], "policy and out are missing; allowed: arena navrep evidence"),
        (["evidence", "policy"], "arguments are policy; allowed: arena navrep evidence"),
        (["evidence", "policy="], "policy is empty; allowed: arena navrep evidence"),
        (["evidence", "out=none", "episodes=many"], "episodes is 'many'; allowed: a whole number"),
        (["evidence", "out=none", "episodes=0"], "episodes is 0; allowed: >= 2"),
        (["evidence", "out=none", "seed=-1"], "seed is -1; allowed: >= 0"),
        (["evidence", "policy=none.onnx"], "none.json: cannot be read"),
        (["evidence", "out=none"], "vision"),
    ],
)
def test_impossible_request_is_one_line(words, said, tmp_path, monkeypatch, capsys):
    pytest.importorskip("torch", reason="a world model is trained with the extra arena-navrep[train]")
    monkeypatch.chdir(tmp_path)
    assert main(["navrep", *words]) == 2
    lines = capsys.readouterr().err.strip().splitlines()
    assert len(lines) == 1, lines
    assert said in lines[0]


def test_missing_torch_is_said_with_what_to_install(monkeypatch, capsys):
    monkeypatch.setattr("arena_core.base.optional.find_spec", lambda name: None)
    assert main(["navrep", "record"]) == 2
    assert "arena-navrep[train]" in capsys.readouterr().err


def test_training_without_a_world_model_says_how_to_make_one_and_leaves_nothing(tmp_path, monkeypatch, capsys):
    pytest.importorskip("torch", reason="a controller is trained with the extra arena-navrep[train]")
    monkeypatch.chdir(tmp_path)
    assert main(["train", "planner=navrep", "robot=jackal"]) == 2
    assert (
        "trainings/world_model_jackal/vision.onnx, which is not there; `arena navrep all robot=... "
        "resume=true` makes it" in capsys.readouterr().err
    )
    assert not list(tmp_path.iterdir())
