"""NAVREP's shipped policies are what their recipes train."""

from __future__ import annotations

import json
from importlib import resources

import pytest

from arena_core import testing
from arena_gym.building import compose_environment

ROBOTS = "turtlebot3", "jackal", "robotino"
SHIPPED = {"navrep": "policies", "navrep_v_only": "policies_v_only"}


@pytest.mark.parametrize("planner", SHIPPED)
@pytest.mark.parametrize("robot", ROBOTS)
def test_policy_is_small_and_its_card_has_what_its_recipe_composes(planner, robot):
    folder = resources.files("arena_navrep") / SHIPPED[planner]
    networks = [path for path in folder.iterdir() if path.name.startswith(f"{robot}.") and path.name.endswith(".onnx")]
    assert sum(len(path.read_bytes()) for path in networks) <= 2 * 10**6
    card = json.loads((folder / f"{robot}.json").read_text("utf-8"))
    assert {path.name for path in networks} == {f"{robot}.onnx", *(f"{robot}.{part}.onnx" for part in card["parts"])}
    training = card["training"]
    composed = json.loads(json.dumps(compose_environment([f"recipe={planner}", f"robot={robot}"], primary="train")))
    assert training["steps"] >= composed["total_steps"]
    for key in (
        "action",
        "environment",
        "observation_encoder",
        "randomization",
        "reward",
        "task",
        "teacher",
        "total_steps",
        "training",
    ):
        assert training["config"][key] == composed[key], key


@pytest.mark.parametrize("robot", ROBOTS)
@pytest.mark.parametrize("part", ["vision", "memory"])
def test_part_has_what_a_world_model_of_its_robot_composes(robot, part):
    card = json.loads((resources.files("arena_navrep") / "policies" / f"{robot}.{part}.json").read_text("utf-8"))
    trained = card["training"]["config"]
    composed = json.loads(json.dumps(compose_environment([f"robot={robot}"], primary="world_model")))
    for key in ("action", "observation_encoder", "randomization", "recording", "task", "world", part):
        assert trained[key] == composed[key], key


@pytest.mark.parametrize("planner", SHIPPED)
@pytest.mark.parametrize("robot", ROBOTS)
def test_planner_holds_its_contract(planner, robot):
    body = testing.component("robot", robot)
    assert testing.check("planner", testing.component("planner", planner, robot=body, robot_preset=robot), body)
