"""Training: rewards rise, policies drive as they were trained, and a training that was cut off goes on."""

from __future__ import annotations

import json
import subprocess
import sys
import time
from importlib import util
from pathlib import Path

import numpy as np
import pytest

from arena_core import ConfigurationError, ObservationBatch, ObservationField, Pose, Twist, testing
from arena_core.cli.main import main

pytest.importorskip("torch", reason="training needs the extra arena-gym[train]")

WORDS = ("train", "planner=beginner", "robot=jackal")


NETWORK = {
    "beams_field": "closeness",
    "convolutions": [{"channels": 4, "kernel": 3, "stride": 2}, {"channels": 4, "kernel": 3, "stride": 1}],
    "features": 16,
    "heads": [32],
}
OPTIMIZATION = {"environments": 16, "steps": 128, "minibatch": 512, "epochs": 6}
# rollouts of 512 steps, for what need not learn to drive
BRIEF = (
    "training.optimization.steps=32",
    "training.validation.every=512",
    "training.validation.episodes=8",
    "training.test.episodes=8",
)


@pytest.fixture
def here(write_recipe):
    """Work in a folder with a recipe that is trained in seconds."""
    tests = {"validation": {"every": 8192, "episodes": 32}, "test": {"episodes": 32}}
    return write_recipe(
        "beginner",
        world={"width": 5.0, "height": 5.0},
        task={"pedestrians": 0, "trip": {"min_distance": 1.5, "max_distance": 4.0}, "time_limit": 20.0},
        environment={"problems_per_world": 64},
        training={"network": NETWORK, "optimization": OPTIMIZATION, **tests},
    )


def curve(folder):
    return json.loads((folder / "curve.json").read_text())


@pytest.mark.slow
def test_policy_learns_to_reach_its_goals_and_drives_as_it_was_trained(here, capsys):
    assert main([*WORDS, "total_steps=40000", "out=trained"]) == 0
    trained, scores = here / "trained", [score["success"] for score in curve(here / "trained")]
    assert scores[-1] >= 0.8, scores
    assert scores[-1] > scores[0]
    card, last = (json.loads((trained / name).read_text()) for name in ("policy.json", "last/policy.json"))
    training = card["training"]
    assert (card["planner"], card["robot"], training["seed"], training["curve"]) == (
        "beginner",
        "jackal",
        0,
        curve(trained),
    )
    assert (training["weights"], last["training"]["weights"], last["training"]["score"]) == ("best", "last", None)
    chosen = training["choice"]
    place = [row["steps"] for row in training["curve"]].index(chosen["steps"])
    assert chosen["success"] == pytest.approx(np.mean(scores[max(0, place - 2) : place + 1]))
    assert "3 validations in a row" in chosen["rule"]
    assert "of seed 7" in chosen["rule"]
    score = training["score"]
    assert (score["episodes"], score["seed"]) == (32, 8)
    assert score["success"] + score["collision"] + score["time_out"] == pytest.approx(1.0)
    low, high = score["interval"]
    assert low < score["success"] <= high
    assert f"test: success {score['success']:.3f} ({low:.3f} .. {high:.3f})" in capsys.readouterr().out

    from arena_gym.building import build_parts
    from arena_gym.training.checkpoint import load_checkpoint
    from arena_gym.training.learning import make_learner
    from arena_gym.training.sb3_vec_env import Sb3VecEnv
    from arena_gym.training.session import training_settings
    from arena_gym.vector_environment import NavigationVectorEnv
    from arena_policies.policy import load_policy

    config = card["training"]["config"]
    env = NavigationVectorEnv(4, parts=build_parts(config))
    learner = make_learner(Sb3VecEnv(env, 0), env.batch.parts.encoder.layout(), training_settings(config), None)
    _, best = load_checkpoint(here / "trained" / "checkpoint.pt", learner)
    learner.policy.load_state_dict(best)
    robot = testing.component("robot", "jackal")
    policy = load_policy(str(here / "trained" / "policy.onnx"), "beginner", robot)
    for angle in np.linspace(-3.0, 3.0, 7):
        seen = testing.observation(pose=Pose(0.3, 0.2, float(angle)), body=robot)
        numbers = env.batch.parts.encoder.encode(ObservationBatch.of(seen, Twist(0.1)))
        meant = env.batch.parts.scale.commands(learner.predict(numbers, deterministic=True)[0])[0]
        np.testing.assert_allclose(policy.command(seen, Twist(0.1)).array(), meant, atol=1e-5)


@pytest.mark.slow
def test_training_that_was_cut_off_goes_on(here):
    assert main([*WORDS, *BRIEF, "total_steps=512", "out=cut"]) == 0
    assert main([*WORDS, *BRIEF, "total_steps=1024", "out=cut", "resume=true"]) == 0
    steps = [score["steps"] for score in curve(here / "cut")]
    assert steps == sorted(set(steps))
    assert json.loads((here / "cut" / "policy.json").read_text())["training"]["steps"] >= 1024


@pytest.mark.slow
def test_actions_spread_less_towards_the_end(here):
    import torch

    assert (
        main(
            [
                *WORDS,
                *BRIEF,
                "total_steps=2048",
                "out=calm",
                "training.network.log_std_final=-2.5",
                "training.validation.every=2048",
            ]
        )
        == 0
    )
    spread = torch.load(here / "calm" / "checkpoint.pt", weights_only=True)["policy"]["log_std"]
    assert float(spread.max()) < -1.7  # the last of four rollouts began at -2.0


@pytest.mark.slow
def test_reward_changes_after_its_share_of_the_steps_and_not_before(here):
    import torch

    words = [*WORDS, *BRIEF, "environment.collisions_to_end=null"]
    ends = {}
    for name, later in (("always", "later.share=1"), ("late", "later.share=0.5"), ("soon", "later.share=0")):
        assert main([*words, "total_steps=1024", f"out={name}", later, "later.reward={time: 1.0}"]) == 0
        ends[name] = torch.load(here / name / "checkpoint.pt", weights_only=True)["policy"]
    assert curve(here / "late")[0] == curve(here / "always")[0]
    for one, other in (("late", "always"), ("late", "soon")):
        assert any(not torch.equal(weights, ends[other][part]) for part, weights in ends[one].items()), (one, other)


@pytest.mark.slow
def test_spread_of_the_first_actions_may_be_told_in_si(here):
    import torch

    words = (
        "training.network.log_std_init=0.0",
        "training.network.log_std_unit=si",
        "training.optimization.learning_rate=1e-9",
    )
    assert main([*WORDS, *BRIEF, "total_steps=512", "out=si", *words]) == 0
    spread = torch.load(here / "si" / "checkpoint.pt", weights_only=True)["policy"]["log_std"].exp().numpy()
    action = json.loads((here / "si" / "policy.json").read_text())["action"]
    np.testing.assert_allclose(
        [wide * (high - low) / 2 for wide, (low, high) in zip(spread, action.values(), strict=True)], 1.0, atol=1e-5
    )


@pytest.mark.slow
def test_spread_in_si_is_half_the_range_of_a_slow_robot_at_most(here):
    import torch

    words = (
        "training.network.log_std_init=0.0",
        "training.network.log_std_unit=si",
        "training.optimization.learning_rate=1e-9",
    )
    assert main([*WORDS, "robot=turtlebot3", *BRIEF, "total_steps=512", "out=slow", *words]) == 0
    spread = torch.load(here / "slow" / "checkpoint.pt", weights_only=True)["policy"]["log_std"].exp().numpy()
    (low, high), turning = json.loads((here / "slow" / "policy.json").read_text())["action"].values()
    assert high - low < 1.0
    # 1 m/s is beyond it, 1 rad/s is not
    np.testing.assert_allclose(spread, [1.0, 2.0 / (turning[1] - turning[0])], atol=1e-5)


def test_spread_in_si_has_no_limit_in_halves_of_the_range(here, capsys):
    assert main([*WORDS, "out=both", "training.network.log_std_unit=si", "training.network.log_std_final=-2"]) == 2
    assert "training.network.log_std_final is -2; allowed: null where log_std_unit is si" in capsys.readouterr().err


@pytest.mark.slow
def test_training_ends_early_at_its_target(here):
    words = ("total_steps=10000000", "out=early", "training.validation.target=0.0")
    assert main([*WORDS, *BRIEF, *words]) == 0
    assert len(curve(here / "early")) == 1
    assert json.loads((here / "early" / "policy.json").read_text())["training"]["steps"] < 10000


@pytest.mark.slow
def test_training_that_was_killed_ends_with_the_weights_of_one_that_was_not(here):
    import torch

    words = [
        *WORDS,
        *BRIEF,
        "total_steps=2048",
        "training.checkpoint=0",
    ]
    words += ["later.share=0.3", "later.reward={collision: 40}"]
    arena = str(Path(sys.executable).with_name("arena"))
    killed = subprocess.Popen([arena, *words, "out=killed"], stdout=subprocess.DEVNULL)
    try:
        for _ in range(30_000):  # 10 minutes, on a busy machine
            if (here / "killed" / "curve.json").exists() or killed.poll() is not None:
                break
            time.sleep(0.02)
    finally:
        killed.kill()
        killed.wait()
    before = torch.load(here / "killed" / "checkpoint.pt", weights_only=True)
    assert 0 < before["steps"] < 2048
    assert main([*words, "out=killed", "resume=true"]) == 0
    assert main([*words, "out=whole"]) == 0
    ends = [torch.load(here / name / "checkpoint.pt", weights_only=True) for name in ("killed", "whole")]
    for part in ("policy", "best"):
        assert all(torch.equal(weights, ends[1][part][name]) for name, weights in ends[0][part].items()), part
    assert curve(here / "killed") == curve(here / "whole")
    assert (here / "killed" / "test.json").read_bytes() == (here / "whole" / "test.json").read_bytes()


TAUGHT = [
    *WORDS,
    "teacher.planner=pure_pursuit",
    "teacher.rounds=3",
    "teacher.decisions=128",
    "teacher.minibatch=128",
    "teacher.epochs=16",
]
SHORTLY = ("teacher.decisions=32", "teacher.epochs=2")


@pytest.mark.slow
def test_policy_imitates_its_teacher_before_it_learns_from_rewards(here, capsys):
    words = [*TAUGHT, "training.optimization.steps=32", "total_steps=512", "training.start.value_steps=1000000"]
    assert main([*words, "out=taught"]) == 0
    assert curve(here / "taught")[-1]["success"] >= 0.8, "the policy is held: all it knows is from its teacher"
    assert "lesson 3 of 3, the teacher drives 0.00 of the worlds" in capsys.readouterr().out
    assert not (here / "taught" / "lessons").exists()
    teacher = json.loads((here / "taught" / "policy.json").read_text())["training"]["teacher"]
    assert teacher["name"] == "pure_pursuit"
    assert teacher["code"]["arena-pure-pursuit"].startswith("0.1.0 ")
    assert len(teacher) > 2, "its numbers"


@pytest.mark.slow
def test_lessons_alone_make_a_policy_and_rewards_can_go_on_with_it(here):
    import torch

    words = [*TAUGHT, *BRIEF, *SHORTLY, "training.start.value_steps=0"]
    assert main([*words, "out=alone", "total_steps=0"]) == 0
    card = json.loads((here / "alone" / "policy.json").read_text())["training"]
    assert card["steps"] == card["choice"]["steps"] == 0
    assert [row["steps"] for row in card["curve"]] == [0]
    taught = torch.load(here / "alone" / "taught.pt", weights_only=True)["actor"]
    best = torch.load(here / "alone" / "checkpoint.pt", weights_only=True)["best"]
    assert all(any(torch.equal(weights, kept) for kept in best.values()) for weights in taught.values())
    assert main([*words, "out=whole", "total_steps=512"]) == 0
    assert main([*words, "out=alone", "total_steps=512", "resume=true"]) == 0
    ends = [torch.load(here / name / "checkpoint.pt", weights_only=True)["policy"] for name in ("alone", "whole")]
    assert all(torch.equal(weights, ends[1][part]) for part, weights in ends[0].items())


@pytest.mark.slow
def test_lessons_that_were_cut_off_go_on_to_the_same_weights(here, capsys, monkeypatch):
    import torch

    from arena_gym.training import imitation

    words = [*TAUGHT, *BRIEF, *SHORTLY, "total_steps=1024"]
    with monkeypatch.context() as cut:

        def full(folder, actor, optimizer, rounds):
            raise OSError(28, "No space left on device")

        keep = imitation._save_progress
        cut.setattr(imitation, "_save_progress", lambda *of: keep(*of) if of[-1] < 2 else full(*of))
        said = refused([*words, "out=cut"], capsys)
        assert "No space left on device" in said
        assert "taught.pt holds what the lessons taught that are over" in said
    assert torch.load(here / "cut" / "taught.pt", weights_only=True)["rounds"] == 1
    lesson = here / "cut" / "lessons" / "0.npz"
    whole = lesson.read_bytes()
    for spoilt in (b"", whole[: len(whole) // 2], b"nothing"):
        lesson.write_bytes(spoilt)
        assert "0.npz: is no checkpoint of this training" in refused([*words, "out=cut", "resume=true"], capsys)
    lesson.write_bytes(whole)
    assert main([*words, "out=cut", "resume=true"]) == 0
    assert main([*words, "out=whole"]) == 0
    ends = [torch.load(here / name / "checkpoint.pt", weights_only=True)["policy"] for name in ("cut", "whole")]
    assert all(torch.equal(weights, ends[1][part]) for part, weights in ends[0].items())
    (here / "whole" / "checkpoint.pt").unlink()
    (here / "whole" / "taught.pt").write_bytes(b"nothing")
    assert "taught.pt: is no checkpoint of this training" in refused([*words, "out=whole", "resume=true"], capsys)


def refused(words, capsys):
    assert main(list(words)) == 2
    lines = [line for line in capsys.readouterr().err.strip().splitlines() if "compiling kernels" not in line]
    assert len(lines) == 1, lines
    return lines[0]


def test_folder_of_another_training_is_refused(here, capsys):
    (here / "other").mkdir()
    (here / "other" / "config.json").write_text('{"seed": 3}')
    assert "resume=true" in refused([*WORDS, "out=other"], capsys)
    assert "another" in refused([*WORDS, "out=other", "resume=true"], capsys)


def test_checkpoint_that_is_none_is_refused(here, capsys):
    (here / "cut").mkdir()
    (here / "cut" / "checkpoint.pt").write_bytes(b"no checkpoint")
    assert "checkpoint.pt" in refused([*WORDS, "total_steps=2048", "out=cut"], capsys)


@pytest.mark.parametrize(
    ("word", "said"),
    [
        ("planner=unheard_of", "unheard_of"),
        ("robot=unheard_of", "unheard_of"),
        ("total_steps=0", "total_steps is 0; allowed: 1 or more without a teacher"),
        ("total_steps=-1", "total_steps"),
        ("device=abacus", "device"),
        ("device=cuda:77", "device"),
        ("training.validation.seed=0", "validation.seed"),
        ("training.network.beams_field=nothing", "beams_field"),
        ("training.optimization.gamma=2", "gamma"),
        ("resume=perhaps", "resume"),
        ("later.share=2", "later.share"),
        ("teacher.planner=unheard_of", "unheard_of"),
        ("teacher.rounds=0", "teacher.rounds"),
        ("later.reward={unheard_of: 1}", "unheard_of"),
        ("later.reward={collision: much}", "collision"),
    ],
)
def test_impossible_request_is_one_line(here, capsys, word, said):
    words = [w for w in WORDS if w.split("=")[0] != word.split("=")[0]]
    assert said in refused([*words, word, "out=none"], capsys)


def test_policy_begins_with_a_teacher_or_with_weights(here, capsys):
    words = [*WORDS, "teacher.planner=teb_as_released", "training.start.policy=some.onnx", "out=none"]
    assert "teacher.planner is teb_as_released; allowed: null with training.start.policy" in refused(words, capsys)


def test_missing_torch_is_said_with_what_to_install(here, capsys, monkeypatch):
    found = util.find_spec
    monkeypatch.setattr("arena_core.base.optional.find_spec", lambda name: None if name == "torch" else found(name))
    assert "arena-gym[train]" in refused(WORDS, capsys)


def test_convolutions_read_scans_that_follow_one_another():
    from arena_gym.training.learning import scan_columns
    from arena_gym.training.settings import Network

    network = Network("scan", (), 8, (8,), -0.7, "range", None, None)
    layout = tuple(
        ObservationField(name, size, "-", 0.0, 1.0, "")
        for name, size in (("way", 2), ("scan", 6), ("scan_1", 6), ("goal", 2), ("scan_2", 6))
    )
    assert scan_columns(network, layout) == (slice(2, 14), 2)
    assert scan_columns(network, layout[:3]) == (slice(2, 14), 2)
    with pytest.raises(ConfigurationError, match=r"training\.network\.beams_field is scan; allowed: way"):
        scan_columns(network, layout[:1])


@pytest.mark.slow
def test_robot_and_map_of_ones_own_take_two_lines(here, capsys):
    (here / "conf" / "robot").mkdir()
    (here / "conf" / "robot" / "scout.yaml").write_text(
        "defaults:\n  - jackal\n  - _self_\n\nlimits:\n  vx_max: 0.8  # [m/s]\n"
    )
    free = np.full((60, 80), 254, np.uint8)
    free[[0, -1]], free[:, [0, -1]], free[28:32, 20:40] = 0, 0, 0
    (here / "site.pgm").write_bytes(b"P5\n80 60\n255\n" + free.tobytes())
    (here / "site.yaml").write_text(
        "image: site.pgm\nresolution: 0.1\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.2\n"
    )
    site = ["robot=scout", "world=ros_map", "world.path=site.yaml", "task.pedestrians=1"]
    small = [
        "total_steps=512",
        "teacher.rounds=1",
        "teacher.decisions=8",
        "environment.worlds=1",
        "environment.problems_per_world=4",
        "training.optimization.environments=4",
        "training.optimization.steps=64",
        "training.optimization.minibatch=128",
        "training.validation.episodes=2",
        "training.test.episodes=2",
        "task.time_limit=4.0",
    ]
    assert main(["train", "planner=rosnav", *site, *small]) == 0
    assert "note: teb: untuned for scout\n" in capsys.readouterr().out
    policy = here / "trainings" / "rosnav_scout_0" / "policy.onnx"
    card = json.loads(policy.with_suffix(".json").read_text())
    assert (card["robot"], card["action"]["vx"]) == ("scout", [0.0, 0.8])
    drive = [
        "run",
        "planner=rosnav",
        f"planner.policy={policy}",
        "episodes=1",
        "executor=serial",
        "report=false",
        "hydra.run.dir=run",
    ]
    assert main([*drive, *site, "task.time_limit=4.0"]) == 0
    capsys.readouterr()
    other = [word for word in drive if not word.startswith("hydra")]
    assert "robotino" in refused([*other, "robot=robotino", "hydra.run.dir=other"], capsys)
    (here / "conf" / "planner" / "teb_tuning").mkdir(parents=True)
    (here / "conf" / "planner" / "teb_tuning" / "scout.yaml").write_text("limits: {max_vel_x_backwards: 0.3}\n")
    taught_otherwise = refused(["train", "planner=rosnav", *site, *small, "resume=true"], capsys)
    assert "holds a training with another teacher.nodes.planner.limits.max_vel_x_backwards" in taught_otherwise
    assert "actions are" in refused([*other, "robot=jackal", "hydra.run.dir=faster"], capsys)
