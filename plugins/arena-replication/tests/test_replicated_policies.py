"""Policies as in the paper and as released: other distributions' planners drive them, and their cards are true."""

from __future__ import annotations

import json
from importlib import resources

import pytest

from arena_core import ConfigurationError, testing
from arena_core.hosting import NAVIGATOR_KEYS, load_registry
from arena_gym.building import compose_environment
from arena_replication import RECIPES

ROBOTS = "turtlebot3", "jackal", "robotino"
PRESETS = [name.partition("/")[2] for name in RECIPES]


def card_of(preset, robot):
    return json.loads((resources.files("arena_replication") / "policies" / preset / f"{robot}.json").read_text("utf-8"))


@pytest.mark.parametrize("preset", PRESETS)
@pytest.mark.parametrize("robot", ROBOTS)
def test_a_card_has_what_its_recipe_composes(preset, robot):
    training = card_of(preset, robot)["training"]
    composed = json.loads(json.dumps(compose_environment([f"recipe={preset}", f"robot={robot}"], primary="train")))
    # from before a metre could cost
    trained = {**training["config"], "reward": {**composed["reward"], **training["config"]["reward"]}}
    trained = training["config"] if preset != "navrep_as_released" else trained
    assert training["steps"] >= composed["total_steps"] or preset == "rosnav_as_paper"
    for key in ("observation_encoder", "randomization", "reward", "training"):
        assert trained[key] == composed[key], key
    for key in ("action", "total_steps"):
        assert trained[key] == composed[key] or preset in ("aio_as_released", "rosnav_as_paper"), key


@pytest.mark.parametrize("preset", PRESETS)
@pytest.mark.parametrize("robot", ROBOTS)
def test_another_distributions_planner_drives_them(preset, robot):
    body = testing.component("robot", robot)
    planner = testing.component("planner", preset, robot=body, robot_preset=robot)
    assert testing.check("planner", planner, body)
    assert load_registry().component("policy", f"{preset.partition('_')[0]}/{preset}").plugin == "replication"


@pytest.mark.parametrize("robot", ROBOTS)
def test_rosnav_as_in_the_paper_drives_at_the_robots_own_limits(robot):
    limits = testing.component("robot", robot).limits
    assert tuple(card_of("rosnav_as_paper", robot)["action"]["vx"]) == (limits.vx_min, limits.vx_max)


@pytest.mark.parametrize("robot", ROBOTS)
def test_navrep_as_released_has_no_world_model(robot):
    assert card_of("navrep_as_released", robot)["parts"] == {}


@pytest.mark.parametrize("robot", ROBOTS)
def test_aios_members_are_those_that_its_switch_was_trained_with(robot):
    trained = card_of("aio_as_released", robot)["training"]["config"]["switch"]["members"]
    composed = compose_environment(["recipe=aio_as_released", f"robot={robot}"], primary="train")["switch"]["members"]
    assert list(trained) == list(composed) == ["rosnav", "teb"]
    for name, member in trained.items():
        own = {key: value for key, value in member.items() if key not in NAVIGATOR_KEYS}
        assert as_known_to(own, composed[name]) == own


def as_known_to(trained, composed):
    """Return what is composed today without the parameters that members have got since the training."""
    if not isinstance(trained, dict):
        return composed
    return {key: as_known_to(value, composed[key]) for key, value in trained.items()}


def test_robot_without_a_policy_is_told_how_to_train_one():
    message = (
        r"arena train planner=rosnav_as_paper robot=jackal_ackermann.*allowed: jackal, robotino, turtlebot3, "
        r"or planner.policy=FILE"
    )
    with pytest.raises(ConfigurationError, match=message):
        testing.component("planner", "rosnav_as_paper", robot=testing.component("robot", "jackal_ackermann"))


def test_a_recipe_that_no_one_has_policies_of_is_refused_with_those_there_are():
    message = r"gring: no policies of 'mine'; allowed: gring, gring_as_released, or planner.policy=FILE"
    with pytest.raises(ConfigurationError, match=message):
        testing.component("planner", "gring", ["planner.recipe=mine"], robot=testing.component("robot", "jackal"))
