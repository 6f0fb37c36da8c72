"""`arena check recipe=NAME`, and trainings by rewards that pay nobody."""

import pytest

from arena_core.cli.main import main

pytest.importorskip("torch", reason="training needs the extra arena-gym[train]")

PAYS_NOBODY = "reward.time=5"


@pytest.fixture
def here(write_recipe):
    return write_recipe("tiny", total_steps=256)


def test_recipe_that_pays_is_told_for_every_robot(here, capsys):
    assert main(["check", "recipe=tiny"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert {"turtlebot3:", "jackal:", "robotino:"} <= {line.split()[3] for line in lines if line.startswith("ok ")}


def test_recipe_that_pays_nobody_is_told_in_one_line(here, capsys):
    assert main(["check", "recipe=tiny", "robot=jackal", PAYS_NOBODY, "environment.standing_to_end=1"]) == 2
    (line,) = capsys.readouterr().out.splitlines()
    assert line.startswith("BROKEN recipe=tiny on jackal: reward pays nobody: driving earns no more than standing (")


@pytest.mark.parametrize(("word", "said"), [("total_steps=0", "has lessons alone"), ("allow_unpaid=true", "allows it")])
def test_recipe_that_learns_from_no_reward_or_has_to_may_pay_nobody(here, capsys, word, said):
    words = [PAYS_NOBODY, "environment.standing_to_end=1", word, "teacher.planner=dwa"]
    assert main(["check", "recipe=tiny", "robot=jackal", *words]) == 0
    assert f"-- recipe=tiny on jackal {said}: reward pays nobody" in capsys.readouterr().out


def test_recipe_that_is_not_there_is_one_line(here, capsys):
    assert main(["check", "recipe=tinny"]) == 2
    assert "recipe is tinny; allowed: " in capsys.readouterr().err


def test_training_by_rewards_that_pay_nobody_is_refused_and_leaves_nothing(here, capsys):
    words = ["train", "planner=tiny", "robot=jackal", PAYS_NOBODY, "environment.standing_to_end=1", "out=mine"]
    assert main(words) == 2
    (line,) = capsys.readouterr().err.splitlines()[-1:]
    assert line.startswith("arena: reward pays nobody")
    assert not (here / "mine").exists()
