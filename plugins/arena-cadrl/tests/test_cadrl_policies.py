"""The policies that come with CADRL and SARL fit their robots, drive them among
people, and are what their cards say.
"""

import csv
import json
from importlib import resources

import pytest

from arena_core import ConfigurationError
from arena_core.cli.main import main
from arena_core.testing import check, component

ROBOTS = ("jackal", "robotino", "turtlebot3")
SHIPPED = [
    (planner, folder, robot)
    for planner, folder in (("cadrl", "policies"), ("sarl", "policies_sarl"))
    for robot in ROBOTS
]
PACKAGE = resources.files("arena_cadrl")


def test_every_policy_that_comes_with_the_package_is_tried_here():
    folders = {planner: folder for planner, folder, _ in SHIPPED}
    there = {
        (planner, folder, file.name[:-5])
        for planner, folder in folders.items()
        for file in (PACKAGE / folder).glob("*.onnx")
    }
    assert there == set(SHIPPED)


@pytest.mark.parametrize(("planner", "folder", "robot"), SHIPPED)
def test_planner_holds_its_contract(planner, folder, robot):
    body = component("robot", robot)
    assert check("planner", component("planner", planner, robot=body), body)


@pytest.mark.parametrize(("planner", "folder", "robot"), SHIPPED)
def test_policy_is_small_and_its_card_tells_how_it_was_trained(planner, folder, robot):
    assert len((PACKAGE / folder / f"{robot}.onnx").read_bytes()) <= 10**6
    training = json.loads((PACKAGE / folder / f"{robot}.json").read_text("utf-8"))["training"]
    assert training["steps"] >= training["config"]["total_steps"]
    assert training["chosen"] in training["curve"]
    assert training["chosen"]["average"] == max(row["average"] for row in training["curve"])
    assert training["score"]["seed"] != training["config"]["environment"]["seed"]
    assert {"torch", "arena-orca", "arena-sim2d"} <= set(training["versions"])


@pytest.mark.parametrize(("planner", "folder", "robot"), SHIPPED)
def test_card_has_what_its_recipe_composes(planner, folder, robot):
    from arena_gym.building import compose_environment

    recorded = json.loads((PACKAGE / folder / f"{robot}.json").read_text("utf-8"))["training"]["config"]
    composed = json.loads(json.dumps(compose_environment([f"recipe={planner}", f"robot={robot}"], primary="train")))
    for key in ("action", "randomization", "reward", "total_steps", "trainer"):
        assert recorded[key] == composed[key], key


@pytest.mark.slow
@pytest.mark.parametrize(
    ("planner", "robot"),
    [  # the slowest robot takes five times as long as the others
        pytest.param(planner, robot, marks=[pytest.mark.long] * (robot == "turtlebot3"))
        for planner, _, robot in SHIPPED
    ],
)
def test_robot_reaches_its_goals_among_people_in_a_hall_it_never_saw(tmp_path, planner, robot):
    words = [
        f"robot={robot}",
        "world=warehouse",
        "task.pedestrians=5",
        "localizer=ground_truth",
        "episodes=6",
        "executor=serial",
    ]
    assert main(["run", f"planner={planner}", *words, "report=false", f"hydra.run.dir={tmp_path}"]) == 0
    with (tmp_path / "episodes.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert sum(float(row["success"]) for row in rows) >= 5


def test_robot_without_a_policy_is_told_how_to_train_one():
    with pytest.raises(
        ConfigurationError,
        match=r"arena train planner=sarl robot=jackal_ackermann.*allowed: jackal, robotino, turtlebot3, "
        r"or planner.policy=FILE",
    ):
        component("planner", "sarl", robot=component("robot", "jackal_ackermann"))
