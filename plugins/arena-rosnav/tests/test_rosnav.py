"""The policies that come with ROSNAV fit their robots, drive them among people, and are what their cards say."""

import csv
import hashlib
import json
from importlib import resources

import pytest

from arena_core import ConfigurationError, testing
from arena_core.cli.main import main

ROBOTS = ("turtlebot3", "jackal", "robotino", "jackal_ackermann")
POLICIES = resources.files("arena_rosnav") / "policies"
BY_REWARDS = resources.files("arena_rosnav") / "policies_rewards"
SHIPPED = [("rosnav", POLICIES, robot) for robot in ROBOTS] + [("rosnav_rewards", BY_REWARDS, "turtlebot3")]


@pytest.mark.parametrize("robot", ROBOTS)
def test_planner_holds_its_contract(robot):
    body = testing.component("robot", robot)
    assert testing.check("planner", testing.component("planner", "rosnav", robot=body), body)


def test_check_command_tries_it_on_the_robots_that_it_has_policies_for(capsys):
    assert main(["check", "planner=rosnav"]) == 0
    said = capsys.readouterr().out
    assert all(f"on {robot} with" in said for robot in ROBOTS)


@pytest.mark.parametrize(("recipe", "folder", "robot"), SHIPPED)
def test_policy_is_small_and_its_card_tells_how_it_was_trained(recipe, folder, robot):
    assert len((folder / f"{robot}.onnx").read_bytes()) <= 2 * 10**6
    training = json.loads((folder / f"{robot}.json").read_text("utf-8"))["training"]
    assert training["steps"] >= training["config"]["total_steps"]
    assert training["score"]["episodes"] >= 100
    assert {"torch", "stable-baselines3", "arena-sim2d"} <= set(training["versions"])


@pytest.mark.parametrize(("recipe", "folder", "robot"), SHIPPED)
def test_card_has_what_its_recipe_composes(recipe, folder, robot):
    from arena_gym.building import compose_environment

    recorded = json.loads((folder / f"{robot}.json").read_text("utf-8"))["training"]["config"]
    composed = json.loads(json.dumps(compose_environment([f"recipe={recipe}", f"robot={robot}"], primary="train")))
    for key in ("action", "observation_encoder", "randomization", "reward", "teacher", "total_steps", "training"):
        assert recorded[key] == composed[key], key


@pytest.mark.slow
@pytest.mark.parametrize(
    "robot", [pytest.param(name, marks=[pytest.mark.long] * (name == "turtlebot3")) for name in ROBOTS]
)
def test_robot_reaches_its_goals_among_people_in_a_hall_it_never_saw(tmp_path, robot):
    words = [
        f"robot={robot}",
        "world=warehouse",
        "task.pedestrians=5",
        "localizer=ground_truth",
        "episodes=6",
        "executor=serial",
    ]
    assert main(["run", "planner=rosnav", *words, "report=false", f"hydra.run.dir={tmp_path}"]) == 0
    with (tmp_path / "episodes.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert sum(float(row["success"]) for row in rows) >= 5


def test_a_turtlebot_drives_by_what_it_learned_from_rewards_unless_it_is_asked_to_imitate():
    body = testing.component("robot", "turtlebot3")
    by_rewards, imitates = (
        testing.component("planner", name, robot_preset="turtlebot3", robot=body)
        for name in ("rosnav", "rosnav_imitation")
    )
    assert by_rewards.learned_by == (
        "imitation of teb, seed 0, then rewards (normalized_progress), 12000000 steps, seed 0"
    )
    assert imitates.learned_by == "imitation of teb, seed 0"
    card = json.loads((BY_REWARDS / "turtlebot3.json").read_text("utf-8"))["training"]
    assert card["start"] == hashlib.sha256((POLICIES / "turtlebot3.onnx").read_bytes()).hexdigest()
    assert card["start_learned_by"] == imitates.learned_by


def test_policy_of_another_robot_is_refused():
    chosen = [f"planner.policy={POLICIES / 'robotino.onnx'}"]
    with pytest.raises(
        ConfigurationError, match=r"robotino\.json: trained for robotino .*allowed: a policy for jackal"
    ):
        testing.component("planner", "rosnav", chosen, robot=testing.component("robot", "jackal"))


def test_recipe_by_rewards_can_begin_with_the_weights_of_the_one_by_lessons():
    from arena_gym.building import compose_training

    imitates, rewarded = (compose_training(name, ["robot=turtlebot3"]) for name in ("rosnav", "rosnav_rewards"))
    assert rewarded["planner"] == imitates["planner"] == "rosnav"
    assert rewarded["teacher"]["planner"] is None
    for key in ("observation_encoder", "action"):
        assert rewarded[key] == imitates[key], key
    assert rewarded["environment"]["every"] == imitates["environment"]["every"]
    built = ("beams_field", "convolutions", "features", "heads")
    assert [rewarded["training"]["network"][key] for key in built] == [
        imitates["training"]["network"][key] for key in built
    ]
