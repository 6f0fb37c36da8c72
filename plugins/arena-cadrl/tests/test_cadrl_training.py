"""A training writes a policy that drives, goes on where it was cut off, and refuses in one line what cannot be."""

import json

import pytest

from arena_cadrl.policy import load_value_policy
from arena_core.cli.main import main
from arena_core.testing import tracked, view

SMALL = [
    *("robot=jackal", "environment.worlds=2", "environment.problems_per_world=2", "task.time_limit=4.0"),
    *(
        "trainer.learning.environments=4",
        "trainer.learning.decisions=8",
        "trainer.learning.updates=2",
        "trainer.learning.imitation=0.5",
    ),
    *("trainer.evaluation.episodes=2", "trainer.evaluation.every=64"),
]


@pytest.fixture
def here(tmp_path, monkeypatch):
    """Give a folder that trainings are in."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.slow
@pytest.mark.parametrize("planner", [pytest.param("cadrl", marks=pytest.mark.long), "sarl"])
def test_training_writes_a_policy_that_drives_and_goes_on_where_it_was_cut_off(here, robot, planner):
    words = ["train", f"planner={planner}", *SMALL, "out=one"]
    assert main([*words, "total_steps=64"]) == 0
    before = json.loads((here / "one" / "curve.json").read_text())
    assert [row["steps"] for row in before] == [64]
    assert main([*words, "total_steps=192", "resume=true"]) == 0
    after = json.loads((here / "one" / "curve.json").read_text())
    assert after[:1] == before
    assert [row["steps"] for row in after] == [64, 128, 192]
    policy = load_value_policy(str(here / "one" / "policy.onnx"), planner, robot("jackal"), 0.1)
    assert policy.card.training["chosen"] in after
    assert policy.command(view(tracks=tracked((1.0, 0.5, 0.0, 0.0))))
    run = [f"planner={planner}", "planner.policy=one/policy.onnx", "robot=jackal", "task.time_limit=4.0"]
    assert main(["run", *run, "episodes=1", "executor=serial", "report=false", "hydra.run.dir=run"]) == 0


@pytest.mark.slow
def test_same_seed_learns_the_same_weights(here):
    for name in ("one", "two"):
        assert main(["train", "planner=cadrl", *SMALL, "total_steps=128", f"out={name}"]) == 0
    cards = [json.loads((here / name / "policy.json").read_text()) for name in ("one", "two")]
    assert cards[0]["sha256"] == cards[1]["sha256"]
    assert cards[0]["training"]["curve"] == cards[1]["training"]["curve"]


def refused(words, capsys):
    assert main(["train", "planner=sarl", *SMALL, *words]) == 2
    lines = capsys.readouterr().err.strip().splitlines()
    assert len(lines) == 1, lines
    return lines[0]


@pytest.mark.parametrize(
    ("word", "said"),
    [
        ("total_steps=0", "total_steps"),
        ("device=abacus", "device"),
        ("trainer.evaluation.seed=0", "trainer.evaluation.seed"),
        ("trainer.network.kind=oracle", "trainer.network.kind"),
        ("trainer.worth.discount=2", "trainer.worth.discount"),
        ("trainer.teacher=nobody", "nobody"),
        ("teacher.planner=teb", "teacher.planner is teb; allowed: null for "),
        ("later.reward={collision: 40}", "later.reward"),
        ("robot=jackal_ackermann", "ackermann"),
    ],
)
def test_impossible_request_is_one_line_and_leaves_nothing_behind(here, capsys, word, said):
    assert said in refused([word, "out=none"], capsys)
    assert not (here / "none").exists()


def test_folder_of_another_training_is_refused(here, capsys):
    (here / "other").mkdir()
    (here / "other" / "config.json").write_text('{"seed": 3}')
    assert "resume=true" in refused(["out=other"], capsys)
    assert "another" in refused(["out=other", "resume=true"], capsys)
